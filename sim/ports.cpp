#include "sim/ports.h"

#include <algorithm>
#include <cmath>

#include "sim/parallel.h"
#include "sim/rheology.h"

namespace sim {
namespace {

constexpr double impedance_memory = 0.03;  // s: flow that lasts longer is part of the given pressure, what is faster meets the impedance
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
  prescribe_ports<D>(scene, state, nullptr, 0);
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

// Speed of each particle of a port whose pressure is given: the blood's own beside it, layer by layer outward, along the port's normal and
// never against the mean flow; `local` in [0, 1] is how much of the local difference from the mean speed is kept. `sheet` holds the port's
// rows by increasing height.
template <int D>
void extrapolate_speed(State<D>& state, const Workspace<D>& work, const Port<D>& port, double mean, double local,
                       const std::vector<std::pair<double, std::size_t>>& sheet) {
  for (const auto& [height, i] : sheet) {
    double sum = 0, weights = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(work.neighbors.index[k]);
      if (state.kind[j] != Kind::fluid && (state.kind[j] != Kind::port || state.port[j] != state.port[i])) continue;
      if ((state.position[j] - port.point).dot(port.normal) >= height) continue;
      sum -= work.link_weight[k] * state.velocity[j].dot(port.normal);
      weights += work.link_weight[k];
    }
    double speed = weights > 0 ? sum / weights : mean;
    if (speed * mean < 0) speed = 0;
    speed = mean + local * (speed - mean);
    state.velocity[i] = -speed * port.normal;
  }
}

}  // namespace

template <int D>
void prescribe_ports(const Scene<D>& scene, State<D>& state, const Workspace<D>* work, double time) {
  for (std::size_t p = 0; p < scene.description.ports.size(); ++p) {
    const Port<D>& port = scene.description.ports[p];
    std::vector<std::pair<double, std::size_t>> sheet;
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
      if (state.port[i] == static_cast<std::int32_t>(p)) sheet.emplace_back((state.position[i] - port.point).dot(port.normal), i);
    std::sort(sheet.begin(), sheet.end());
    double speed = 0, pressure = 0;
    bool local = false;
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
        speed = speed_inside(scene, state, port);
        pressure = port.table.at(time) - port.impedance * (speed - state.port_memory[p]);
        local = work != nullptr;
        break;
      case PortCondition::windkessel:
        speed = speed_inside(scene, state, port);
        pressure = state.port_memory[p] - port.windkessel.proximal_resistance * state.port_flow[p];
        local = work != nullptr;
        break;
    }
    for (const auto& [height, i] : sheet) {
      state.velocity[i] = -speed * port.normal;
      state.pressure[i] = pressure;
    }
    if (local) extrapolate_speed(state, *work, port, speed, resolved_profile(scene, speed), sheet);
  }
}

template <int D>
void wall_grip(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  work.grip.clear();
  if (scene.description.ports.empty()) return;
  work.grip.assign(state.size(), 1.0f);
  for (const auto& port : scene.description.ports) {
    const double share = resolved_profile(scene, speed_inside(scene, state, port));
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(scene.first_fluid); i < static_cast<std::ptrdiff_t>(state.size()); ++i) {
      if (state.kind[i] != Kind::fluid) continue;
      const double depth = -height_outside(scene, port, state.position[i]) / (layers * scene.description.spacing);
      if (depth < 0 || depth > 1) continue;
      work.grip[i] = std::min(work.grip[i], static_cast<float>(share + depth * (1 - share)));
    }
  }
}

template <int D>
void exchange_through_ports(const Scene<D>& scene, State<D>& state, double dt) {
  const auto& ports = scene.description.ports;
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid), before = state.size();
  const double l0 = scene.description.spacing;
  std::vector<std::uint8_t> keep(before - first, 1);
  const auto carried = [&](std::size_t i) {  // kinetic energy of a particle, J
    return 0.5 * scene.density[state.body[i]] * scene.fluid_particle_volume * state.velocity[i].squaredNorm();
  };
  for (std::size_t p = 0; p < ports.size(); ++p) {
    const Port<D>& port = ports[p];
    const double area = opening_area(scene, state, static_cast<std::int32_t>(p));
    double speed = 0, sheet_pressure = 0;
    bool any = false;
    std::vector<std::size_t> sheet;
    for (std::size_t i = first; i < before; ++i)
      if (state.port[i] == static_cast<std::int32_t>(p)) sheet.push_back(i);
    for (std::size_t i : sheet) {
      speed -= state.velocity[i].dot(port.normal) / static_cast<double>(sheet.size());
      sheet_pressure = state.pressure[i];
      any = true;
    }
    if (any) {
      const double flow = speed * area;
      state.port_flow[p] = flow;
      state.port_volume[p] += flow * dt;
      // Power with the flow of the step's middle: the sheet moves as the blood did at its start.
      const bool follows = port.condition == PortCondition::pressure || port.condition == PortCondition::windkessel;
      state.ledger.port_work += sheet_pressure * (follows ? 0.5 * (flow + area * speed_inside(scene, state, port)) : flow) * dt;
      if (port.condition == PortCondition::pressure) state.port_memory[p] += dt / (dt + impedance_memory) * (speed - state.port_memory[p]);
      if (port.condition == PortCondition::windkessel) {
        const Windkessel& w = port.windkessel;  // C dP/dt = -q - P/R_d with q the flow into the blood
        state.port_memory[p] += dt * (-flow - state.port_memory[p] / w.distal_resistance) / w.compliance;
      }
    }
    for (std::size_t i : sheet) {
      const double height = (state.position[i] - port.point).dot(port.normal);
      if (height > layers * l0) {
        keep[i - first] = 0;
      } else if (height < 0) {
        state.kind[i] = Kind::fluid;
        state.port[i] = -1;
        ++state.ledger.particles_in;
        state.ledger.port_work += carried(i);
        const Vector<D> spot = state.position[i] + layers * l0 * port.normal;
        bool free = true;
        for (std::size_t j : sheet) free = free && (keep[j - first] == 0 || (state.position[j] - spot).squaredNorm() > 0.36 * l0 * l0);
        if (free) append_port_particle<D>(state, static_cast<std::int32_t>(p), state.body[i], spot, state.velocity[i], state.pressure[i]);
      }
    }
    for (std::size_t i = first; i < before; ++i) {
      if (state.kind[i] != Kind::fluid) continue;
      const double height = height_outside(scene, port, state.position[i]);
      if (height <= 0 || height > layers * l0) continue;
      state.kind[i] = Kind::port;
      state.port[i] = static_cast<std::int32_t>(p);
      ++state.ledger.particles_out;
      state.ledger.port_work -= carried(i);
    }
  }
  keep.resize(state.size() - first, 1);
  keep_rows(state, first, keep);
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

#define INSTANTIATE(D)                                                                    \
  template void open_ports(const Scene<D>&, State<D>&);                                   \
  template void prescribe_ports(const Scene<D>&, State<D>&, const Workspace<D>*, double); \
  template void exchange_through_ports(const Scene<D>&, State<D>&, double);               \
  template void wall_grip(const Scene<D>&, const State<D>&, Workspace<D>&);               \
  template void remove_escaped(const Scene<D>&, State<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
