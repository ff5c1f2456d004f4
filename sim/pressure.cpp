#include "sim/pressure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/leaflet_coupling.h"
#include "sim/operators.h"
#include "sim/parallel.h"
#include "sim/solid_coupling.h"
#include "sim/stage.h"
#include "sim/time_step.h"

namespace sim {
using Index = std::ptrdiff_t;

template <int D>
void number_unknowns(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.unknown.assign(n, -1);
  work.unknown_row.clear();
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid || work.number_density[i] < 0.02) continue;
    work.unknown[i] = static_cast<std::int32_t>(work.unknown_row.size());
    work.unknown_row.push_back(static_cast<std::int32_t>(i));
  }
}

namespace {

// A drop that touches nothing falls freely: seen from its own frame nothing pushes it, and its pressure is 0 however its particles lie.
// Per row the mean acceleration of such a drop; 0 for fluid that touches a boundary, a port or a leaflet. Empty where no surface is free.
template <int D>
std::vector<Vector<D>> falling_frames(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work) {
  std::vector<Vector<D>> frame;
  if (!scene.pressure->free_surface) return frame;
  const Index n = static_cast<Index>(state.size());
  frame.assign(n, Vector<D>::Zero());
  std::vector<std::uint8_t> seen(n, 0);
  std::vector<std::int32_t> drop;
  for (Index s = scene.first_fluid; s < n; ++s) {
    if (seen[s] || work.unknown[s] < 0) continue;
    drop.assign(1, static_cast<std::int32_t>(s));
    seen[s] = 1;
    bool touches = false;
    Vector<D> sum = Vector<D>::Zero();
    for (std::size_t k = 0; k < drop.size(); ++k) {
      const std::int32_t i = drop[k];
      sum += work.acceleration[i];
      for (std::int64_t e = work.neighbors.start[i]; e < work.neighbors.start[i + 1]; ++e) {
        const std::int32_t j = work.neighbors.index[e];
        if (work.link_weight[e] == 0) continue;
        touches = touches || j < scene.first_fluid || state.kind[j] != Kind::fluid;
        if (j < scene.first_fluid || seen[j] || work.unknown[j] < 0) continue;
        seen[j] = 1;
        drop.push_back(j);
      }
    }
    if (touches) continue;
    for (std::int32_t i : drop) frame[i] = sum / static_cast<double>(drop.size());
  }
  return frame;
}

// D_i(a) without the shells' part (see pressure.h), seen from a frame with the acceleration `frame`; k already in w.
template <int D>
double acceleration_link(const Scene<D>& scene, const Workspace<D>& work, Index i, std::int32_t j, const Vector<D>& r, bool at_surface,
                         const Vector<D>& frame) {
  const Vector<D>& a_i = work.acceleration[i];
  const Vector<D>& a_j = work.acceleration[j];
  if (j >= scene.first_fluid) return 0.5 * r.dot(at_surface ? Vector<D>(a_j - a_i) : Vector<D>(a_j + a_i - 2 * frame));
  if (!at_surface) return r.dot(a_j);
  const Vector<D>& normal = work.boundary_normal[j];
  return (a_j - a_i).dot(normal) * r.dot(normal);
}

// Whether all fluid bodies have the same density.
template <int D>
bool has_one_density(const Scene<D>& scene) {
  double density = 0;
  for (std::size_t b = 0; b < scene.density.size(); ++b) {
    if (scene.description.bodies[b].kind != Kind::fluid) continue;
    if (density > 0 && scene.density[b] != density) return false;
    density = scene.density[b];
  }
  return true;
}

}  // namespace

template <int D>
double projection_time(const Scene<D>& scene, const State<D>& state, double dt) {
  const bool alone = !scene.solids && !scene.shells;  // what rings moves fluid within the step
  return scene.pressure->free_surface && alone ? std::max(dt, unrestricted_step(scene, state)) : dt;
}

template <int D>
void pressure_poisson(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const double within = projection_time(scene, state, dt);
  const Index unknowns = static_cast<Index>(work.unknown_row.size());
  const double k = scene.lattice.laplacian_factor(), n0 = scene.lattice.number_density, volume = scene.fluid_particle_volume;
  // The rate at which a density error is mended: with the step itself a step cut short would mend faster, drive blood faster, and be cut
  // shorter still.
  const double usual = state.step > 0 ? 0.5 * state.time / static_cast<double>(state.step) : 0;  // s, half the mean step so far
  const double blend = scene.description.scheme.density_blend / (within * std::max({within, scene.description.scheme.maximum_step, usual}));
  const bool closed = scene.sheet && !scene.pressure->free_surface;  // a vessel full of blood
  SymmetricMatrix& a = work.matrix;
  a.diagonal.assign(unknowns, 0);
  a.start.assign(unknowns + 1, 0);
  work.source.assign(unknowns, 0);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index u = 0; u < unknowns; ++u) {
    const Index i = work.unknown_row[u];
    std::int64_t links = 0;
    for (std::int64_t e = work.neighbors.start[i]; e < work.neighbors.start[i + 1]; ++e)
      links += work.link_weight[e] != 0 && work.unknown[work.neighbors.index[e]] >= 0;
    a.start[u + 1] = links;
  }
  std::partial_sum(a.start.begin(), a.start.end(), a.start.begin());
  a.column.resize(a.start[unknowns]);
  a.value.resize(a.start[unknowns]);
  const std::vector<Vector<D>> frames = falling_frames(scene, state, work);
  const Vector<D> at_rest = Vector<D>::Zero();
  const auto first_fluid = static_cast<std::int32_t>(scene.first_fluid);
  const bool one_density = has_one_density(scene);
#pragma omp parallel for schedule(dynamic, 256)
  for (Index u = 0; u < unknowns; ++u) {
    const Index i = work.unknown_row[u];
    const double rho = scene.density[state.body[i]], own_factor = volume * k / rho;
    const bool at_surface = work.surface[i] == 1;
    std::int64_t entry = a.start[u];
    double diagonal = 0, divergence = 0, source = 0;
    bool beside_port = false;
    double fastest = closed ? work.velocity[i].squaredNorm() : 0;  // (m/s)², around i
    const Padded<D> here = work.position[i];
    const Vector<D> frame = frames.empty() ? at_rest : frames[i];
    for (std::int64_t e = work.neighbors.start[i]; e < work.neighbors.start[i + 1]; ++e) {
      const double w = work.link_weight[e];
      if (w == 0) continue;
      const std::int32_t j = work.neighbors.index[e];
      if (closed) fastest = std::max(fastest, work.velocity[j].squaredNorm());
      if (j < first_fluid && state.kind[j] == Kind::shell) continue;  // leaflet_coupling.cpp
      const Vector<D> r = scene.space.difference(here, work.position[j]).template head<D>();
      const bool port = j >= first_fluid && state.kind[j] == Kind::port;
      beside_port = beside_port || port;
      if (port && !gives_pressure(scene.description.ports[state.port[j]])) continue;  // its speed at the new time is in grad v
      divergence += k * w * acceleration_link<D>(scene, work, i, j, r, at_surface, frame);
      if (j < first_fluid) continue;
      double c = one_density ? w * own_factor : volume * k * w * 2 / (rho + scene.density[state.body[j]]);
      if (port) c /= port_fraction<D>(scene.description.ports[state.port[j]], state.position[i], state.position[j]);
      const std::int32_t column = work.unknown[j];
      if (column >= 0) {
        diagonal += c;
        a.column[entry] = column;
        a.value[entry++] = -c;
      } else if (port) {  // else an isolated drop, which takes no part
        diagonal += c;
        source += c * state.pressure[j];
      }
    }
    const double n = work.number_density[i];
    double compression = std::clamp(n - 1, -0.2, 0.2);
    if (work.surface[i] != 0) compression = std::max(compression, 0.0);  // beside a surface neighbours are missing by right
    if (beside_port) compression = std::max(compression, 0.0);           // what the open end lacks is no deficit
    if (at_surface)  // the surface, where p = 0, lies half a spacing ahead; at least the missing neighbours count
      diagonal += volume * k / rho * std::max(work.surface_outward[i].norm() / (0.5 * scene.lattice.spacing), n0 * std::max(1 - n, 0.0));
    const double support = scene.sheet ? work.support[i] : 1.0;
    double mending = blend * compression;
    if (closed) {
      // What rests makes no density error, and must not be stirred by the unevenness that it starts with (0.8 % rms beside thin sheets):
      // what is beyond that is mended no faster than the flow passes a particle, |v|/l0. Past a leaflet's edge a jet piles its error up
      // within that time: what is beyond the noise of a full but uneven arrangement is mended as fast. (Beside a free surface neighbours
      // are missing by right: no telling there.) Mending makes volume: where all unevenness was mended, 12 % more blood left a flat valve
      // than came in, and it gained 5.5 % of energy; now 8 % and 3.9 % (stability cell rise_ramp100).
      constexpr double unevenness = 0.01, noise = 0.03;
      const auto beyond = [&](double bearable) { return std::copysign(std::max(std::abs(compression) - bearable, 0.0), compression); };
      mending = std::min(blend, std::sqrt(fastest) / (scene.lattice.spacing * dt)) * beyond(unevenness);
      mending += state.velocity[i].norm() / (scene.lattice.spacing * dt) * beyond(noise);
    }
    source += support * volume * (-work.velocity_gradient[i].trace() / within - divergence + mending);
    a.diagonal[u] = diagonal > 0 ? diagonal : 1;
    work.source[u] = diagonal > 0 ? source : 0;
  }
}

namespace {

// Labels of the connected regions of the matrix' graph.
std::vector<std::int32_t> connected_regions(const SymmetricMatrix& a, std::int32_t& count) {
  std::vector<std::int32_t> label(a.rows(), -1), stack;
  count = 0;
  for (std::size_t s = 0; s < a.rows(); ++s) {
    if (label[s] >= 0) continue;
    label[s] = count;
    stack.push_back(static_cast<std::int32_t>(s));
    while (!stack.empty()) {
      const std::int32_t u = stack.back();
      stack.pop_back();
      for (std::int64_t e = a.start[u]; e < a.start[u + 1]; ++e)
        if (label[a.column[e]] < 0) {
          label[a.column[e]] = count;
          stack.push_back(a.column[e]);
        }
    }
    ++count;
  }
  return label;
}

void remove_means(std::vector<double>& x, const std::vector<std::int32_t>& label, std::int32_t count) {
  std::vector<double> sum(count, 0), size(count, 0);
  for (std::size_t u = 0; u < x.size(); ++u) sum[label[u]] += x[u], size[label[u]] += 1;
  for (std::size_t u = 0; u < x.size(); ++u) x[u] -= sum[label[u]] / size[label[u]];
}

}  // namespace

template <int D>
SolveReport solve_pressure(const Scene<D>& scene, State<D>& state, Workspace<D>& work) {
  const Index unknowns = static_cast<Index>(work.unknown_row.size());
  work.solution.resize(unknowns);
  for (Index u = 0; u < unknowns; ++u) work.solution[u] = state.pressure[work.unknown_row[u]];
  std::vector<std::int32_t> label;
  std::int32_t regions = 0;
  if (!scene.pressure->anchored) {
    label = connected_regions(work.matrix, regions);
    remove_means(work.source, label, regions);
  }
  Multigrid* multigrid = nullptr;
  if (unknowns > 400) {
    const StageClock clock(work.stage_times, Stage::multigrid_setup);
    if (!work.coupling.empty()) link_sides(work, work.side_links);
    build_multigrid(work.multigrid, work.matrix, work.coupling.empty() ? nullptr : &work.side_links);
    multigrid = &work.multigrid;
  }
  const SchemeSettings& scheme = scene.description.scheme;
  const StageClock clock(work.stage_times, Stage::pressure_solve);
  const SolveReport report = conjugate_gradient(
      work.matrix, work.source, work.solution, scheme.pressure_tolerance, scheme.pressure_iterations, multigrid, work.scratch,
      work.coupling.empty() && !scene.solids ? std::function<void(std::span<const double>, std::span<double>)>{}
                                             : [&](std::span<const double> x, std::span<double> y) {
                                                 apply_coupling(work, x, y);
                                                 if (scene.solids) apply_solid_coupling(scene, state, work, x, y);
                                               });
  if (!scene.pressure->anchored) remove_means(work.solution, label, regions);
  for (Index i = scene.first_fluid; i < static_cast<Index>(state.size()); ++i)
    if (state.kind[i] == Kind::fluid) {
      const double p = work.unknown[i] >= 0 ? work.solution[work.unknown[i]] : 0.0;
      state.pressure[i] = scene.pressure->free_surface ? std::max(p, 0.0) : p;
    }
  return report;
}

namespace {

// Whether particle i at the surface belongs to spray: a film or jet with less fluid in sight than a row of particles shows, or a drop of
// fewer than ten. There the corrected difference form would rest on one or two neighbours and push them along with itself; the pair form
// keeps momentum.
template <int D>
bool in_spray(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, std::int32_t i) {
  constexpr double row = 0.28;  // of n0, in 2-D with a radius of 3.1 l0; the corner of a pool at a wall shows 0.39
  constexpr std::size_t small = 10;
  double visible = 0;
  for (std::int64_t e = work.neighbors.start[i]; e < work.neighbors.start[i + 1]; ++e)
    if (work.neighbors.index[e] >= scene.first_fluid) visible += work.link_weight[e];
  if (visible < row * scene.lattice.number_density) return true;
  std::vector<std::int32_t> drop{i};
  for (std::size_t k = 0; k < drop.size(); ++k)
    for (std::int64_t e = work.neighbors.start[drop[k]]; e < work.neighbors.start[drop[k] + 1]; ++e) {
      const std::int32_t j = work.neighbors.index[e];
      if (j < scene.first_fluid || work.link_weight[e] == 0) continue;
      if (state.kind[j] == Kind::port) return false;
      if (std::find(drop.begin(), drop.end(), j) != drop.end()) continue;
      drop.push_back(j);
      if (drop.size() >= small) return false;
    }
  return true;
}

}  // namespace

template <int D>
void pressure_gradients(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.pressure_gradient.resize(n);
  const double factor = scene.lattice.gradient_factor();
  const double least = scene.lattice.closest() * scene.lattice.closest();
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = scene.first_fluid; i < n; ++i) {
    work.pressure_gradient[i].setZero();
    if (state.kind[i] != Kind::fluid) continue;
    const bool inside =
        work.surface[i] != 1 || (work.number_density[i] >= 0.6 && !in_spray(scene, state, work, static_cast<std::int32_t>(i)));
    const double p_i = state.pressure[i], rho = scene.density[state.body[i]];
    Padded<D> total = Padded<D>::Zero();
    for (std::int64_t e = work.neighbors.start[i]; e < work.neighbors.start[i + 1]; ++e) {
      const double w = work.link_weight[e];
      if (w == 0) continue;
      const std::int32_t j = work.neighbors.index[e];
      const Padded<D> r = scene.space.difference(work.position[i], work.position[j]);
      const double c = factor * w / std::max(r.squaredNorm(), least);
      if (j >= scene.first_fluid) {
        double t = 1;
        if (state.kind[j] == Kind::port) {
          const Port<D>& port = scene.description.ports[state.port[j]];
          if (inside && !gives_pressure(port)) continue;
          if (inside) t = port_fraction<D>(port, state.position[i], state.position[j]);
        }
        total += c / t * (inside ? state.pressure[j] - p_i : state.pressure[j] + p_i) * r;
      } else if (!inside) {
        const Vector<D>& normal = work.boundary_normal[j];
        const double height = r.template head<D>().dot(normal);
        total += c * (2 * p_i + rho * (work.acceleration[i] - work.acceleration[j]).dot(normal) * height) * r;
      }
    }
    Vector<D> sum = total.template head<D>();
    if (inside && work.surface_sample[i] > 0)  // the surface itself: p = 0 half a spacing ahead
      sum -= work.surface_sample[i] * p_i * work.surface_outward[i].normalized();
    work.pressure_gradient[i] = inside ? Vector<D>(work.pressure_inverse[i] * sum) : sum;
  }
}

template <int D>
void boundary_pressures(const Scene<D>& scene, State<D>& state, const Workspace<D>& work) {
#pragma omp parallel for schedule(dynamic, 256)
  for (Index b = 0; b < static_cast<Index>(scene.first_fluid); ++b) {
    if (state.kind[b] == Kind::shell) continue;
    double sum = 0, weights = 0;
    for (std::int64_t e = work.neighbors.start[b]; e < work.neighbors.start[b + 1]; ++e) {
      const std::int32_t i = work.neighbors.index[e];
      const double w = work.link_weight[e];
      if (w == 0 || state.kind[i] != Kind::fluid) continue;
      const Vector<D> r = scene.space.difference(state.position[i], state.position[b]);
      sum += w * (state.pressure[i] + scene.density[state.body[i]] * r.dot(work.acceleration[i]));
      weights += w;
    }
    state.pressure[b] = weights > 0 ? sum / weights : 0;
  }
}

#define INSTANTIATE(D)                                                                     \
  template double projection_time(const Scene<D>&, const State<D>&, double);               \
  template void number_unknowns(const Scene<D>&, const State<D>&, Workspace<D>&);          \
  template void pressure_poisson(const Scene<D>&, const State<D>&, Workspace<D>&, double); \
  template SolveReport solve_pressure(const Scene<D>&, State<D>&, Workspace<D>&);          \
  template void pressure_gradients(const Scene<D>&, const State<D>&, Workspace<D>&);       \
  template void boundary_pressures(const Scene<D>&, State<D>&, const Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
