#include "sim/run_columns.h"

#include <algorithm>
#include <cmath>

#include "sim/orifice.h"
#include "sim/probe_moment.h"
#include "sim/run_layout.h"
#include "sim/stress.h"

namespace sim {
namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// 99.5th percentile of the blood's speed from the annulus to 15 mm beyond the commissures.
double jet_speed(const Scene<3>& scene, const State<3>& state) {
  const ValveFrame& valve = *scene.description.valve;
  std::vector<double> speed;
  for (std::size_t row = static_cast<std::size_t>(scene.first_fluid); row < state.size(); ++row) {
    const double height = (state.position[row] - valve.annulus_center).dot(valve.axis);
    if (height > 0 && height < valve.commissure_height + 0.015) speed.push_back(state.velocity[row].norm());
  }
  return quantile(std::move(speed), 0.995);
}

// 99th percentile of von Mises stress over the leaflets, rows nearer than 2 l0 to where they are held left out (a clamp is singular).
double leaflet_stress(const Scene<3>& scene, const State<3>& state) {
  const double l0 = scene.description.spacing;
  const InitialParticles<3>& rest = scene.description.particles;
  const std::vector<Eigen::Matrix3d> stress = elastic_stress(scene, state);
  std::vector<Eigen::Vector3d> held;
  for (std::size_t row = static_cast<std::size_t>(scene.elastic_count); row < stress.size(); ++row)
    if (rest.fixed[row]) held.push_back(rest.position[row]);
  const PointGrid<3> grid(std::span<const Eigen::Vector3d>(held), 2 * l0);
  std::vector<double> values;
  for (std::size_t row = static_cast<std::size_t>(scene.elastic_count); row < stress.size(); ++row) {
    bool near_clamp = false;
    grid.for_each_near(rest.position[row], 2 * l0, [&](std::int32_t, double) { near_clamp = true; });
    if (!near_clamp) values.push_back(von_mises(stress[row]));
  }
  return quantile(std::move(values), 0.99);
}

template <int D>
bool has_valve(const Scene<D>& scene) {
  return D == 3 && scene.description.valve && scene.shells;
}

}  // namespace

template <int D>
std::vector<Column> probe_columns(const Scene<D>& scene) {
  std::vector<Column> columns;
  for (const Probe<D>& probe : scene.description.probes)
    if (!probe.line)
      for (const std::string& ending : probe_components<D>(probe.quantity))
        columns.push_back({probe.name + ending, quantity_units(probe.quantity, D)});
  return columns;
}

template <int D>
std::vector<Column> metric_columns(const Scene<D>& scene) {
  std::vector<Column> columns{{"maximum_speed", "m/s"}};
  for (const Port<D>& port : scene.description.ports) {
    columns.push_back({"port." + port.name + ".flow", D == 3 ? "m3/s" : "m2/s"});
    columns.push_back({"port." + port.name + ".pressure", "Pa"});
    columns.push_back({"port." + port.name + ".volume", D == 3 ? "m3" : "m2"});
  }
  if (has_valve(scene))
    for (const Column& column : std::vector<Column>{{"orifice_area", "m2"},
                                                    {"largest_opening", "m2"},
                                                    {"coaptation_area", "m2"},
                                                    {"coaptation_height", "m"},
                                                    {"jet_speed", "m/s"},
                                                    {"leaflet_stress_p99", "Pa"}})
      columns.push_back(column);
  columns.push_back({"particles", "1"});
  columns.push_back({"step_size", "s"});
  State<D> any;
  for_each_scalar(any, [&](const std::string& name, const auto&) {
    if (name == "time" || name == "last_step" || name == "next_id") return;
    const bool energy =
        name.find("energy") != std::string::npos || name.find("work") != std::string::npos || name.find("loss") != std::string::npos;
    columns.push_back({name, energy ? (D == 3 ? "J" : "J/m") : name == "deepest_penetration" ? "m" : "1"});
  });
  return columns;
}

template <int D>
std::vector<double> metric_values(const Scene<D>& scene, const State<D>& state, Workspace<D>& scratch) {
  std::vector<double> values;
  double fastest = 0;
  for (const Vector<D>& velocity : state.velocity) fastest = std::max(fastest, velocity.squaredNorm());
  values.push_back(std::sqrt(fastest));
  if (!scene.description.ports.empty()) {
    ProbeMoment<D> moment(scene, state, scratch);
    for (std::size_t k = 0; k < scene.description.ports.size(); ++k) {
      const Port<D>& port = scene.description.ports[k];
      values.push_back(k < state.port_flow.size() ? state.port_flow[k] : 0);
      values.push_back(moment.pressure_at(port.point - 2 * scene.description.spacing * port.normal, -1));
      values.push_back(k < state.port_volume.size() ? state.port_volume[k] : 0);
    }
  }
  if constexpr (D == 3) {
    if (has_valve(scene)) {
      const std::span<const Eigen::Vector3d> position(state.position.data() + scene.elastic_count,
                                                      static_cast<std::size_t>(scene.shell_count));
      const double contact = 0.8 * scene.description.spacing;
      const OrificeArea orifice = geometric_orifice_area(*scene.shells, position, *scene.description.valve, 0.5 * contact);
      const Coaptation closed = coaptation(*scene.shells, position, 1.5 * contact);
      for (double value : {orifice.area, orifice.largest_opening, closed.area, closed.height}) values.push_back(value);
      values.push_back(jet_speed(scene, state));
      values.push_back(leaflet_stress(scene, state));
    }
  }
  values.push_back(static_cast<double>(state.size()));
  values.push_back(state.last_step);
  for_each_scalar(state, [&](const std::string& name, const auto& value) {
    if (name != "time" && name != "last_step" && name != "next_id") values.push_back(static_cast<double>(value));
  });
  for (double& value : values)
    if (!std::isfinite(value)) value = 0;
  return values;
}

template std::vector<Column> probe_columns(const Scene<2>&);
template std::vector<Column> probe_columns(const Scene<3>&);
template std::vector<Column> metric_columns(const Scene<2>&);
template std::vector<Column> metric_columns(const Scene<3>&);
template std::vector<double> metric_values(const Scene<2>&, const State<2>&, Workspace<2>&);
template std::vector<double> metric_values(const Scene<3>&, const State<3>&, Workspace<3>&);

}  // namespace sim
