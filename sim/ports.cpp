#include "sim/ports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/operators.h"
#include "sim/parallel.h"
#include "sim/rheology.h"

namespace sim {
namespace {

constexpr double impedance_memory = 0.03;  // s: flow that lasts longer is part of the given pressure, what is faster meets the impedance
constexpr double fullest = 2.5;            // a profile's largest speed over its mean: 2 in a pipe's parabola
constexpr double layers = 3;               // port particles reach this many l0 out of the plane

// Height outside the port's plane (m, positive outside), or a large number where x lies beside the opening.
template <int D>
double height_outside(const Scene<D>& scene, const Port<D>& port, const Vector<D>& x) {
  const Vector<D> r = x - port.point;
  const double height = r.dot(port.normal);
  const double aside = (r - height * port.normal).squaredNorm(), reach = port.radius + 0.5 * scene.description.spacing;
  return aside <= reach * reach ? height : 1e300;
}

// Cross-section of the opening, m² (2-D: m): port particles a layer times l0^(D-1).
template <int D>
double opening_area(const Scene<D>& scene, const State<D>& state, std::int32_t port) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  const double count = ordered_sum(state.size() - first, [&](std::size_t k) { return state.port[first + k] == port ? 1.0 : 0.0; });
  return count / layers * std::pow(scene.description.spacing, D - 1);
}

// Mean inward speed of the blood within two spacings of the plane, m/s.
template <int D>
double speed_inside(const Scene<D>& scene, const State<D>& state, const Port<D>& port) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  using SumAndCount = Eigen::Array2d;
  const SumAndCount total = ordered_total(state.size() - first, SumAndCount(SumAndCount::Zero()), [&](std::size_t k) -> SumAndCount {
    const std::size_t i = first + k;
    if (state.kind[i] != Kind::fluid) return {0, 0};
    const double height = height_outside(scene, port, state.position[i]);
    if (height > 0 || height < -2 * scene.description.spacing) return {0, 0};
    return {-state.velocity[i].dot(port.normal), 1};
  });
  return total[1] > 0 ? total[0] / total[1] : 0;
}

template <int D>
void append_port_particle(State<D>& state, std::int32_t port, std::int32_t body, const Vector<D>& position, const Vector<D>& velocity,
                          double pressure) {
  state.id.push_back(state.next_id++);
  state.kind.push_back(Kind::port);
  state.body.push_back(body);
  state.port.push_back(port);
  state.position.push_back(position);
  state.velocity.push_back(velocity);
  state.pressure.push_back(pressure);
}

// Keeps the rows for which keep[row - first] is set, in order.
template <int D>
void keep_rows(State<D>& state, std::size_t first, const std::vector<std::uint8_t>& keep) {
  std::size_t to = first;
  for (std::size_t i = first; i < state.size(); ++i) {
    if (!keep[i - first]) continue;
    if (to != i) {
      state.id[to] = state.id[i];
      state.kind[to] = state.kind[i];
      state.body[to] = state.body[i];
      state.port[to] = state.port[i];
      state.position[to] = state.position[i];
      state.velocity[to] = state.velocity[i];
      state.pressure[to] = state.pressure[i];
    }
    ++to;
  }
  state.id.resize(to), state.kind.resize(to), state.body.resize(to), state.port.resize(to);
  state.position.resize(to), state.velocity.resize(to), state.pressure.resize(to);
}

}  // namespace

template <int D>
void open_ports(const Scene<D>& scene, State<D>& state) {
  const auto& ports = scene.description.ports;
  state.port_memory.assign(ports.size(), 0);
  state.port_flow.assign(ports.size(), 0);
  state.port_volume.assign(ports.size(), 0);
  const std::size_t fluid_end = state.size();
  for (std::size_t p = 0; p < ports.size(); ++p) {
    const Port<D>& port = ports[p];
    state.port_memory[p] = port.windkessel.initial_pressure;
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < fluid_end; ++i) {
      const double height = height_outside(scene, port, state.position[i]);
      if (height > 0 || height < -layers * scene.description.spacing) continue;
      append_port_particle<D>(state, static_cast<std::int32_t>(p), state.body[i], state.position[i] - 2 * height * port.normal,
                              -port.start_speed * port.normal, 0);
    }
  }
  prescribe_ports<D>(scene, state, 0);
}

namespace {

// How far the particles resolve the profile at a port: 1 at a small cell Reynolds number u l0/nu, 0 at a large one, where the boundary
// layer is thinner than a particle and the port's layers move as one sheet.
template <int D>
double resolved_profile(const Scene<D>& scene, double speed) {
  double kinematic = 0;
  for (const auto& body : scene.description.bodies)
    if (body.kind == Kind::fluid) kinematic = std::max(kinematic, viscosity(body.fluid.rheology, 100.0, 1.0) / body.fluid.density);
  const double reynolds = std::abs(speed) * scene.description.spacing / std::max(kinematic, 1e-300);
  return 1 / (1 + reynolds * reynolds / 100);
}

// Rows of a port's particles.
template <int D>
std::vector<std::size_t> rows_of_port(const Scene<D>& scene, const State<D>& state, std::size_t port) {
  std::vector<std::size_t> rows;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
    if (state.port[i] == static_cast<std::int32_t>(port)) rows.push_back(i);
  return rows;
}

// What the pressure of fluid at rest under gravity beside row i is more than that at the port's point, Pa: along the opening, for across it
// the pressure holds in its plane.
template <int D>
double resting_pressure(const Scene<D>& scene, const State<D>& state, const Port<D>& port, std::size_t i) {
  if (!scene.gravity) return 0;
  const Vector<D> r = state.position[i] - port.point;
  return scene.density[state.body[i]] * scene.gravity->acceleration.dot(r - r.dot(port.normal) * port.normal);
}

// Largest speed of some rows, m/s.
template <int D>
double fastest_of(const State<D>& state, const std::vector<std::size_t>& rows) {
  double fastest = 0;
  for (std::size_t i : rows) fastest = std::max(fastest, state.velocity[i].norm());
  return fastest;
}

// Makes a port's particles carry the mean speed (m/s, inward) together and keep `share` of their differences from it, but never run
// against it or faster than a developed profile does: what came in and went out side by side would be the blood's noise. All layers
// together: a profile's rows are not abreast, and the mean of one layer would be that of the rows which happen to be in it.
template <int D>
void carry_mean_flow(State<D>& state, const Port<D>& port, const std::vector<std::size_t>& rows, double mean, double share) {
  const double part = 1 / static_cast<double>(rows.size());
  double before = 0, cut = 0;
  for (std::size_t i : rows) before -= part * state.velocity[i].dot(port.normal);
  const auto speed = [&](std::size_t i) {
    const double own = mean + share * (-state.velocity[i].dot(port.normal) - before);
    return own * mean > 0 ? std::copysign(std::min(std::abs(own), fullest * std::abs(mean)), mean) : 0;
  };
  for (std::size_t i : rows) cut += part * speed(i);
  for (std::size_t i : rows) state.velocity[i] = -(cut != 0 ? mean / cut * speed(i) : mean) * port.normal;
}

}  // namespace

template <int D>
void prescribe_ports(const Scene<D>& scene, State<D>& state, double dt) {
  const double time = state.time + dt;
  for (std::size_t p = 0; p < scene.description.ports.size(); ++p) {
    const Port<D>& port = scene.description.ports[p];
    const std::vector<std::size_t> rows = rows_of_port(scene, state, p);
    double speed = 0, pressure = 0, share = 0;
    if (gives_pressure(port)) {
      speed = speed_inside(scene, state, port);
      // A profile that the particles do not resolve flattens, the less they resolve it the sooner: at once where a layer moves as a sheet.
      const double fastest = fastest_of(state, rows), resolved = resolved_profile(scene, fastest);
      share = std::exp(-(1 - resolved) / resolved * fastest * dt / scene.description.spacing);
    }
    switch (port.condition) {
      case PortCondition::velocity:
        speed = port.table.at(time);
        break;
      case PortCondition::flow_rate: {
        const double area = opening_area(scene, state, static_cast<std::int32_t>(p));
        speed = area > 0 ? port.table.at(time) / area : 0;
        break;
      }
      case PortCondition::pressure:
        pressure = port.table.at(time) - port.impedance * (speed - state.port_memory[p]);
        break;
      case PortCondition::windkessel:
        pressure = state.port_memory[p] - port.windkessel.proximal_resistance * state.port_flow[p];
        break;
    }
    for (std::size_t i : rows) state.pressure[i] = pressure + resting_pressure(scene, state, port, i);
    carry_mean_flow(state, port, rows, speed, share);
  }
}

template <int D>
void develop_port_profiles(const Scene<D>& scene, State<D>& state, const Workspace<D>& work) {
  for (std::size_t p = 0; p < scene.description.ports.size(); ++p) {
    const Port<D>& port = scene.description.ports[p];
    if (!gives_pressure(port)) continue;
    const std::vector<std::size_t> rows = rows_of_port(scene, state, p);
    double mean = 0;
    for (std::size_t i : rows) mean -= state.velocity[i].dot(port.normal) / static_cast<double>(rows.size());
    for (std::size_t i : rows) state.velocity[i] = work.viscous_solution[i - static_cast<std::size_t>(scene.first_fluid)];
    carry_mean_flow(state, port, rows, mean, 1.0);
  }
}

template <int D>
void wall_grip(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  work.grip.clear();
  if (scene.description.ports.empty()) return;
  work.grip.assign(state.size(), 1.0f);
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(scene.description.ports.size()); ++p) {
    const Port<D>& port = scene.description.ports[static_cast<std::size_t>(p)];
    const double share = resolved_profile(scene, speed_inside(scene, state, port));
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(scene.first_fluid); i < static_cast<std::ptrdiff_t>(state.size()); ++i) {
      if (state.kind[i] != Kind::fluid && state.port[i] != p) continue;
      const double depth =
          state.kind[i] == Kind::fluid ? -height_outside(scene, port, state.position[i]) / (layers * scene.description.spacing) : 0;
      if (depth < 0 || depth > 1) continue;
      work.grip[i] = std::min(work.grip[i], static_cast<float>(share + depth * (1 - share)));
    }
  }
}

namespace {

// Gives every particle that comes in through a port the next one behind it, up to three layers out, where none is.
template <int D>
void fill_port(const Scene<D>& scene, State<D>& state, std::size_t p) {
  const Port<D>& port = scene.description.ports[p];
  const double l0 = scene.description.spacing, free = 0.7 * l0;
  const Vector<D> along = port.normal.unitOrthogonal();
  std::vector<std::pair<double, std::size_t>> rows;  // by their place along the opening
  for (std::size_t i : rows_of_port(scene, state, p)) rows.emplace_back(state.position[i].dot(along), i);
  std::sort(rows.begin(), rows.end());
  const std::vector<std::pair<double, std::size_t>> present = rows;
  for (const auto& [place, i] : present) {
    const double height = (state.position[i] - port.point).dot(port.normal);
    if (height < 0 || height > (layers - 1) * l0 || state.velocity[i].dot(port.normal) > 0) continue;
    const Vector<D> spot = state.position[i] + l0 * port.normal;
    const auto near = std::lower_bound(rows.begin(), rows.end(), std::pair<double, std::size_t>(place - free, 0));
    const auto taken = [&](const auto& row) { return (state.position[row.second] - spot).squaredNorm() < free * free; };
    const double far = place + free;
    const auto end = std::find_if(near, rows.end(), [far](const auto& row) { return row.first > far; });
    if (std::any_of(near, end, taken)) continue;
    rows.insert(std::upper_bound(near, end, std::pair(place, state.size())), {place, state.size()});
    append_port_particle<D>(state, static_cast<std::int32_t>(p), state.body[i], spot, state.velocity[i], state.pressure[i]);
  }
}

// The flow of a step of dt seconds through a port: port_flow, port_volume, its memory and the work at it.
template <int D>
void account_flow(const Scene<D>& scene, State<D>& state, std::size_t p, const std::vector<std::size_t>& rows, double dt) {
  if (rows.empty()) return;
  const Port<D>& port = scene.description.ports[p];
  const double area = opening_area(scene, state, static_cast<std::int32_t>(p));
  double speed = 0, pressure = 0;
  for (std::size_t i : rows) {
    speed -= state.velocity[i].dot(port.normal) / static_cast<double>(rows.size());
    pressure += state.pressure[i] / static_cast<double>(rows.size());
  }
  const double flow = speed * area;
  state.port_flow[p] = flow;
  state.port_volume[p] += flow * dt;
  // Power with the flow of the step's middle: the layers move as the blood did at its start.
  state.ledger.port_work += pressure * (gives_pressure(port) ? 0.5 * (flow + area * speed_inside(scene, state, port)) : flow) * dt;
  if (port.condition == PortCondition::pressure) state.port_memory[p] += dt / (dt + impedance_memory) * (speed - state.port_memory[p]);
  if (port.condition == PortCondition::windkessel) {
    const Windkessel& w = port.windkessel;  // C dP/dt = -q - P/R_d with q the flow into the blood
    state.port_memory[p] += dt * (-flow - state.port_memory[p] / w.distal_resistance) / w.compliance;
  }
}

}  // namespace

template <int D>
void exchange_through_ports(const Scene<D>& scene, State<D>& state, double dt) {
  const auto& ports = scene.description.ports;
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid), before = state.size();
  const double reach = layers * scene.description.spacing;
  std::vector<std::uint8_t> keep(before - first, 1);
  const auto carried = [&](std::size_t i) {  // kinetic energy of a particle, J
    return 0.5 * scene.density[state.body[i]] * scene.fluid_particle_volume * state.velocity[i].squaredNorm();
  };
  for (std::size_t p = 0; p < ports.size(); ++p) {
    const std::vector<std::size_t> rows = rows_of_port(scene, state, p);
    account_flow(scene, state, p, rows, dt);
    for (std::size_t i : rows) {
      const double height = (state.position[i] - ports[p].point).dot(ports[p].normal);
      if (height > reach) {
        keep[i - first] = 0;
      } else if (height < 0) {
        state.kind[i] = Kind::fluid;
        state.port[i] = -1;
        ++state.ledger.particles_in;
        state.ledger.port_work += carried(i);
      }
    }
    for (std::size_t i = first; i < before; ++i) {
      if (state.kind[i] != Kind::fluid) continue;
      const double height = height_outside(scene, ports[p], state.position[i]);
      if (height <= 0 || height > reach) continue;
      state.kind[i] = Kind::port;
      state.port[i] = static_cast<std::int32_t>(p);
      ++state.ledger.particles_out;
      state.ledger.port_work -= carried(i);
    }
  }
  keep_rows(state, first, keep);
  for (std::size_t p = 0; p < ports.size(); ++p) fill_port(scene, state, p);
}

template <int D>
void remove_escaped(const Scene<D>& scene, State<D>& state) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  std::vector<std::uint8_t> keep(state.size() - first, 1);
  const Domain<D>& domain = scene.description.domain;
  bool any = false;
  for (std::size_t i = first; i < state.size(); ++i) {
    bool inside = true;
    for (int k = 0; k < D; ++k) {
      const double x = state.position[i][k];
      if (domain.present && !domain.periodic[k]) inside = inside && x >= domain.min[k] && x <= domain.max[k];
      inside = inside && x >= scene.lower[k] && x <= scene.upper[k];
    }
    if (inside || state.kind[i] == Kind::port) continue;
    keep[i - first] = 0;
    any = true;
    ++state.ledger.particles_out;
  }
  if (any) keep_rows(state, first, keep);
}

#define INSTANTIATE(D)                                                                  \
  template void open_ports(const Scene<D>&, State<D>&);                                 \
  template void prescribe_ports(const Scene<D>&, State<D>&, double);                    \
  template void develop_port_profiles(const Scene<D>&, State<D>&, const Workspace<D>&); \
  template void exchange_through_ports(const Scene<D>&, State<D>&, double);             \
  template void wall_grip(const Scene<D>&, const State<D>&, Workspace<D>&);             \
  template void remove_escaped(const Scene<D>&, State<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
