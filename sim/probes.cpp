#include "sim/probes.h"

#include <algorithm>
#include <cmath>

#include "sim/point_fit.h"
#include "sim/probe_moment.h"
#include "sim/stress.h"

namespace sim {
namespace {

bool is_elastic(Kind kind) { return kind == Kind::elastic || kind == Kind::shell; }

template <int D>
bool has_fluid(const Scene<D>& scene) {
  return std::any_of(scene.description.bodies.begin(), scene.description.bodies.end(),
                     [](const Body& body) { return body.kind == Kind::fluid; });
}

// Whether the probe belongs to material points of elastic bodies rather than to places in space.
template <int D>
bool is_material(const Scene<D>& scene, const Probe<D>& probe) {
  if (probe.body >= 0) return is_elastic(scene.description.bodies[probe.body].kind);
  if (probe.quantity == Quantity::stress) return true;
  const bool elastic = scene.elastic_count + scene.shell_count > 0;
  if (probe.quantity == Quantity::displacement || probe.quantity == Quantity::position) return elastic;
  return elastic && !has_fluid(scene);
}

// Rows of the elastic body nearest to the place (or of the given one) around it.
template <int D>
ProbePoint<D> material_point(const Scene<D>& scene, const Probe<D>& probe, const Vector<D>& place) {
  const InitialParticles<D>& rest = scene.description.particles;
  const double l0 = scene.description.spacing;
  ProbePoint<D> point;
  point.place = place, point.material = true;
  std::int32_t body = -1;
  double nearest = 1e300;
  for (std::int64_t row = 0; row < scene.elastic_count + scene.shell_count; ++row) {
    const double distance = (rest.position[row] - place).norm();
    if ((probe.body < 0 || rest.body[row] == probe.body) && distance < nearest) nearest = distance, body = rest.body[row];
  }
  point.body = body;
  point.solid = scene.description.bodies[body].kind == Kind::elastic;
  if (point.solid) {
    point.in_solid = locate_in_solid(*scene.solids, body, place);
    return point;
  }
  const double radius = std::max(2.6 * l0, nearest + 1.6 * l0);
  std::vector<Vector<D>> offset;
  const Body& chosen = scene.description.bodies[body];
  std::int32_t closest = static_cast<std::int32_t>(chosen.first);
  for (std::int64_t row = chosen.first; row < chosen.first + chosen.count; ++row) {
    const Vector<D> from = rest.position[row] - place;
    if (from.norm() > radius) continue;
    if (from.norm() < (rest.position[closest] - place).norm()) closest = static_cast<std::int32_t>(row);
    point.row.push_back(static_cast<std::int32_t>(row));
    offset.push_back(from);
  }
  point.weight = fit_weights<D>(offset, radius, offset.size() >= (D == 2 ? 9 : 16));
  point.linear_weight = fit_weights<D>(offset, radius, false);
  if (chosen.kind == Kind::shell && chosen.elastic.thickness > 0)
    point.face = std::clamp(2 * (place - rest.position[closest]).dot(rest.normal[closest]) / chosen.elastic.thickness, -1.0, 1.0);
  return point;
}

template <int D>
ProbePoint<D> space_point(const Scene<D>& scene, const State<D>& initial, const Probe<D>& probe, const Vector<D>& place) {
  ProbePoint<D> point;
  point.place = place;
  if (probe.quantity != Quantity::position && probe.quantity != Quantity::displacement) return point;
  double nearest = 1e300;
  for (std::size_t row = 0; row < initial.size(); ++row) {
    const double distance = (initial.position[row] - place).norm();
    if ((probe.body < 0 || initial.body[row] == probe.body) && distance < nearest) nearest = distance, point.followed = initial.id[row];
  }
  (void)scene;
  return point;
}

template <int D, class Value>
auto combined(const ProbePoint<D>& point, const std::vector<double>& weight, Value&& value) {
  auto sum = (weight[0] * value(point.row[0])).eval();
  for (std::size_t k = 1; k < point.row.size(); ++k) sum += weight[k] * value(point.row[k]);
  return sum;
}

template <int D>
std::vector<double> entries(const Vector<D>& v) {
  return {v.data(), v.data() + D};
}

template <int D>
std::vector<double> stress_entries(const Eigen::Matrix3d& s) {
  std::vector<double> result{s(0, 0), s(1, 1), s(2, 2), s(0, 1)};
  if (D == 3) result.insert(result.end(), {s(1, 2), s(0, 2)});
  result.push_back(von_mises(s));
  const Eigen::Vector3d principal = principal_stresses(s);
  result.insert(result.end(), {principal[0], principal[1], principal[2]});
  return result;
}

// Of a shell: between its faces as the point lies between them.
template <int D>
Eigen::Matrix3d sheet_stress_at(const Scene<D>& scene, const ProbePoint<D>& point, ProbeMoment<D>& moment) {
  const ShellStress& faces = moment.faces();
  return combined(point, point.linear_weight, [&](std::int32_t row) {
    const std::size_t k = static_cast<std::size_t>(row - scene.elastic_count);
    const Eigen::Matrix3d value = faces.middle[k] + 0.5 * point.face * (faces.plus[k] - faces.minus[k]);
    return value;
  });
}

template <int D>
Eigen::Matrix3d material_stress(const Scene<D>& scene, const ProbePoint<D>& point, ProbeMoment<D>& moment) {
  if (!point.solid) return sheet_stress_at(scene, point, moment);
  return stress_at(*scene.solids, point.in_solid, std::span<const Eigen::Matrix3d>(moment.stress()).first(scene.solids->size()));
}

template <int D>
Vector<D> material_displacement(const Scene<D>& scene, const State<D>& state, const ProbePoint<D>& point, ProbeMoment<D>& moment) {
  if (point.solid)
    return displacement_at(*scene.solids, point.in_solid, std::span<const Vector<D>>(state.position).first(scene.solids->size()),
                           moment.solid_work());
  return combined(point, point.weight,
                  [&](std::int32_t row) { return Vector<D>(state.position[row] - scene.description.particles.position[row]); });
}

template <int D>
Vector<D> material_velocity(const Scene<D>& scene, const State<D>& state, const ProbePoint<D>& point) {
  if (point.solid)
    return interpolate_at(*scene.solids, point.in_solid, std::span<const Vector<D>>(state.velocity).first(scene.solids->size()));
  return combined(point, point.weight, [&](std::int32_t row) -> const Vector<D>& { return state.velocity[row]; });
}

template <int D>
std::vector<double> material_value(const Scene<D>& scene, const State<D>& state, const Probe<D>& probe, const ProbePoint<D>& point,
                                   ProbeMoment<D>& moment) {
  switch (probe.quantity) {
    case Quantity::velocity:
      return entries<D>(material_velocity(scene, state, point));
    case Quantity::stress:
      return stress_entries<D>(material_stress(scene, point, moment));
    case Quantity::pressure:
      return {-material_stress(scene, point, moment).trace() / 3};
    case Quantity::density: {
      const double density = scene.description.bodies[point.body].elastic.density;
      if (!point.solid || point.in_solid.row < 0) return {density};
      return {density / moment.volume()[static_cast<std::size_t>(point.in_solid.row)]};
    }
    default:
      break;
  }
  const Vector<D> moved = material_displacement(scene, state, point, moment);
  return entries<D>(probe.quantity == Quantity::position ? Vector<D>(point.place + moved) : moved);
}

template <int D>
std::vector<double> followed_value(const State<D>& state, const Probe<D>& probe, const ProbePoint<D>& point) {
  const auto found = std::find(state.id.begin(), state.id.end(), point.followed);
  if (found == state.id.end()) return std::vector<double>(D, 0.0);  // left through an open face: nothing to show
  const Vector<D>& now = state.position[static_cast<std::size_t>(found - state.id.begin())];
  return entries<D>(probe.quantity == Quantity::position ? now : Vector<D>(now - point.place));
}

// Kinetic and stored energy of a body, or of all (fluid, solids, shells), J (2-D: J/m).
template <int D>
std::pair<double, double> energy(const Scene<D>& scene, const State<D>& state, std::int32_t body) {
  const InitialParticles<D>& rest = scene.description.particles;
  double kinetic = 0;
  std::vector<Vector<D>> position(state.position.begin(), state.position.begin() + scene.elastic_count + scene.shell_count);
  for (std::size_t row = 0; row < state.size(); ++row) {
    const bool asked = body < 0 || state.body[row] == body;
    const bool solid = row < position.size();
    if (solid && !asked) position[row] = rest.position[row];  // stores nothing
    if (!asked || state.kind[row] == Kind::wall) continue;
    const Body& about = scene.description.bodies[state.body[row]];
    const double volume =
        !solid ? scene.fluid_particle_volume : rest.volume[row] * (about.kind == Kind::shell ? about.elastic.thickness : 1);
    kinetic += 0.5 * scene.density[state.body[row]] * volume * state.velocity[row].squaredNorm();
  }
  double stored = 0;
  SolidWork<D> work;
  if (scene.solids)
    stored += solid_energy(*scene.solids, std::span<const Vector<D>>(position).first(static_cast<std::size_t>(scene.elastic_count)), work);
  if (scene.shells)
    stored += shell_energy(*scene.shells, std::span<const Vector<D>>(position).subspan(static_cast<std::size_t>(scene.elastic_count)));
  return {kinetic, stored};
}

template <int D>
double body_volume(const Scene<D>& scene, const State<D>& state, std::int32_t body, ProbeMoment<D>& moment) {
  double volume = 0;
  for (std::size_t row = 0; row < state.size(); ++row) {
    if ((body >= 0 && state.body[row] != body) || (body < 0 && state.kind[row] == Kind::wall) || state.kind[row] == Kind::port) continue;
    const Body& about = scene.description.bodies[state.body[row]];
    if (row >= static_cast<std::size_t>(scene.first_fluid))
      volume += scene.fluid_particle_volume;
    else if (about.kind == Kind::elastic)
      volume += scene.description.particles.volume[row] * moment.volume()[row];
    else
      volume += scene.description.particles.volume[row] * (about.kind == Kind::shell ? about.elastic.thickness : 1);
  }
  return volume;
}

// Farthest edge of the fluid along an axis, stray drops (nothing of the fluid within 1.6 l0) left out.
template <int D>
double front(const Scene<D>& scene, const State<D>& state, const Probe<D>& probe) {
  const double l0 = scene.description.spacing;
  std::vector<std::pair<double, std::size_t>> order;
  std::vector<Vector<D>> fluid;
  for (std::size_t row = static_cast<std::size_t>(scene.first_fluid); row < state.size(); ++row) {
    if (probe.body >= 0 && state.body[row] != probe.body) continue;
    order.emplace_back(-state.position[row][probe.axis], fluid.size());
    fluid.push_back(state.position[row]);
  }
  if (fluid.empty()) return 0;
  std::sort(order.begin(), order.end());
  const PointGrid<D> grid(std::span<const Vector<D>>(fluid), 1.6 * l0);
  for (const auto& [negative, k] : order) {
    int company = -1;  // not itself
    grid.for_each_near(fluid[k], 1.6 * l0, [&](std::int32_t, double) { ++company; });
    if (company >= 2) return -negative + 0.5 * l0;
  }
  return -order.front().first + 0.5 * l0;
}

}  // namespace

template <int D>
std::vector<std::string> probe_components(Quantity quantity) {
  switch (quantity) {
    case Quantity::displacement:
    case Quantity::position:
    case Quantity::velocity:
      return D == 2 ? std::vector<std::string>{".x", ".y"} : std::vector<std::string>{".x", ".y", ".z"};
    case Quantity::stress:
      if (D == 2) return {".xx", ".yy", ".zz", ".xy", ".von_mises", ".principal1", ".principal2", ".principal3"};
      return {".xx", ".yy", ".zz", ".xy", ".yz", ".xz", ".von_mises", ".principal1", ".principal2", ".principal3"};
    case Quantity::energy:
      return {"", ".kinetic", ".elastic"};
    default:
      return {""};
  }
}

std::string quantity_units(Quantity quantity, int dimension) {
  switch (quantity) {
    case Quantity::displacement:
    case Quantity::position:
    case Quantity::front:
      return "m";
    case Quantity::velocity:
      return "m/s";
    case Quantity::pressure:
    case Quantity::stress:
      return "Pa";
    case Quantity::density:
      return "kg/m3";
    case Quantity::flow_rate:
      return dimension == 3 ? "m3/s" : "m2/s";
    case Quantity::energy:
      return dimension == 3 ? "J" : "J/m";
    case Quantity::volume:
      return dimension == 3 ? "m3" : "m2";
  }
  return "";
}

template <int D>
Probes<D>::Probes(const Scene<D>& scene, const State<D>& initial) {
  for (const Probe<D>& probe : scene.description.probes) {
    std::vector<ProbePoint<D>> points;
    for (const Vector<D>& place : probe.points)
      points.push_back(is_material(scene, probe) ? material_point(scene, probe, place) : space_point(scene, initial, probe, place));
    points_.push_back(std::move(points));
  }
}

template <int D>
std::vector<std::vector<double>> Probes<D>::evaluate(const Scene<D>& scene, const State<D>& state) {
  ProbeMoment<D> moment(scene, state, work_);
  std::vector<std::vector<double>> result;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Probe<D>& probe = scene.description.probes[k];
    std::vector<double> values;
    switch (probe.quantity) {
      case Quantity::flow_rate:
        values = {moment.flow_through(probe)};
        break;
      case Quantity::volume:
        values = {body_volume(scene, state, probe.body, moment)};
        break;
      case Quantity::front:
        values = {front(scene, state, probe)};
        break;
      case Quantity::energy: {
        const auto [kinetic, stored] = energy(scene, state, probe.body);
        values = {kinetic + stored, kinetic, stored};
        break;
      }
      default:
        for (const ProbePoint<D>& point : points_[k]) {
          std::vector<double> value;
          if (point.material)
            value = material_value(scene, state, probe, point, moment);
          else if (probe.quantity == Quantity::velocity)
            value = entries<D>(moment.velocity_at(point.place, probe.body));
          else if (probe.quantity == Quantity::pressure)
            value = {moment.pressure_at(point.place, probe.body)};
          else if (probe.quantity == Quantity::density)
            value = {moment.density_at(point.place, probe.body)};
          else
            value = followed_value(state, probe, point);
          values.insert(values.end(), value.begin(), value.end());
        }
    }
    for (double& value : values)
      if (!std::isfinite(value)) value = 0;
    result.push_back(std::move(values));
  }
  return result;
}

template std::vector<std::string> probe_components<2>(Quantity);
template std::vector<std::string> probe_components<3>(Quantity);
template class Probes<2>;
template class Probes<3>;

}  // namespace sim
