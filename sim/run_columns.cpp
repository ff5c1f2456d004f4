#include "sim/run_columns.h"

#include <algorithm>
#include <cmath>

#include "sim/elastic_stress.h"
#include "sim/probe_moment.h"
#include "sim/run_layout.h"
#include "sim/stress.h"
#include "sim/valve_metrics.h"

namespace sim {
namespace {

template <int D>
bool has_valve(const Scene<D>& scene) {
  return D == 3 && scene.description.valve && scene.shells;
}

Rheology blood_of(const Scene<3>& scene) {
  for (const Body& body : scene.description.bodies)
    if (body.kind == Kind::fluid) return body.fluid.rheology;
  return Newtonian{};
}

// Mean of what comes in from the ventricle and what leaves to the aorta; the walls are rigid, so they differ by noise alone.
double valve_flow(const ValveFrame& valve, const std::vector<double>& port_flow) {
  double flow = 0;
  int ends = 0;
  for (const auto& [port, sign] : {std::pair{valve.ventricle_port, 1.0}, std::pair{valve.aorta_port, -1.0}})
    if (port >= 0 && port < static_cast<std::int32_t>(port_flow.size())) flow += sign * port_flow[static_cast<std::size_t>(port)], ++ends;
  return ends > 0 ? flow / ends : 0;
}

ValveMoment moment_of(const Scene<3>& scene, const State<3>& state, const ValveSheet& sheet, const std::vector<double>& port_pressure) {
  const ValveFrame& valve = *scene.description.valve;
  ValveMoment moment;
  const std::vector<Eigen::Matrix3d> stress = elastic_stress(scene, state);
  for (const std::int64_t signed_row : sheet.row) {
    const auto row = static_cast<std::size_t>(signed_row);
    moment.position.push_back(state.position[row]), moment.velocity.push_back(state.velocity[row]);
    moment.von_mises.push_back(von_mises(stress[row])), moment.principal.push_back(principal_stresses(stress[row])[0]);
  }
  const auto first = static_cast<std::ptrdiff_t>(scene.first_fluid);
  moment.blood_position.assign(state.position.begin() + first, state.position.end());
  moment.blood_velocity.assign(state.velocity.begin() + first, state.velocity.end());
  moment.flow = valve_flow(valve, state.port_flow);
  const auto pressure = [&](std::int32_t port) { return port >= 0 ? port_pressure[static_cast<std::size_t>(port)] : 0; };
  if (valve.ventricle_port >= 0 && valve.aorta_port >= 0)
    moment.pressure_difference = pressure(valve.ventricle_port) - pressure(valve.aorta_port);
  return moment;
}

// The figures with every value at rest: for their names and units.
std::vector<NamedValue> figures_at_rest(const Scene<3>& scene) {
  const ValveSheet sheet = make_valve_sheet(scene);
  ValveMoment moment;
  moment.position = sheet.rest;
  moment.velocity.assign(sheet.size(), Eigen::Vector3d::Zero());
  moment.von_mises.assign(sheet.size(), 0), moment.principal = moment.von_mises;
  return valve_metrics(sheet, moment, Newtonian{});
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
  if constexpr (D == 3)
    if (has_valve(scene))
      for (const NamedValue& figure : figures_at_rest(scene)) columns.push_back({figure.name, figure.units});
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
  std::vector<double> port_pressure;
  if (!scene.description.ports.empty()) {
    ProbeMoment<D> moment(scene, state, scratch);
    for (std::size_t k = 0; k < scene.description.ports.size(); ++k) {
      const Port<D>& port = scene.description.ports[k];
      values.push_back(k < state.port_flow.size() ? state.port_flow[k] : 0);
      port_pressure.push_back(moment.pressure_at(port.point - 2 * scene.description.spacing * port.normal, -1));
      values.push_back(port_pressure.back());
      values.push_back(k < state.port_volume.size() ? state.port_volume[k] : 0);
    }
  }
  if constexpr (D == 3) {
    if (has_valve(scene)) {
      const ValveSheet sheet = make_valve_sheet(scene);
      for (const NamedValue& figure : valve_metrics(sheet, moment_of(scene, state, sheet, port_pressure), blood_of(scene)))
        values.push_back(figure.value);
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
