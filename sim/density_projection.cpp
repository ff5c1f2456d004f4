#include "sim/density_projection.h"

#include <algorithm>
#include <cmath>

#include "sim/parallel.h"

namespace sim {
namespace {
using Index = std::ptrdiff_t;

// What is to be mended of C_i = n_i/n0 - 1 where fluid particle i lies now, -. Beside a surface neighbours are missing by right, and what
// is below 1 % is unevenness: were every excess of it pushed out and no lack pulled in, the surface would shiver.
double error_to_mend(double error, bool beside_surface) {
  constexpr double largest = 0.05, unevenness = 0.01;  // more than the largest is no error of a step
  return beside_surface ? std::clamp(error - unevenness, 0.0, largest) : std::clamp(error, -largest, largest);
}

// The errors of the fluid rows, and their mean size over those that are asked, -.
template <int D>
double density_errors(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, DensityProblem<D>& problem) {
  const Index first = static_cast<Index>(scene.first_fluid), n = static_cast<Index>(state.size());
  const double radius = scene.lattice.radius, closest = scene.lattice.closest();
  problem.position.resize(n), problem.error.resize(n - first), problem.active.resize(n - first);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < n; ++i) problem.position[i] = pad<D>(state.position[i]);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = first; i < n; ++i) {
    double sum = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const double w = weight(scene.space.difference(problem.position[i], problem.position[j]).norm(), radius, closest);
      sum += j < first ? w * scene.measure[j] : w;
    }
    const bool beside_surface = work.surface[i] != 0;
    const double error = error_to_mend(sum / scene.lattice.number_density - 1, beside_surface);
    problem.active[i - first] = state.kind[i] == Kind::fluid && (error > 0 || !beside_surface);
    problem.error[i - first] = problem.active[i - first] ? static_cast<float>(error) : 0.0F;
  }
  const auto rows = static_cast<std::size_t>(n - first);
  const double count = ordered_sum(rows, [&](std::size_t u) { return problem.active[u] ? 1.0 : 0.0; });
  return ordered_sum(rows, [&](std::size_t u) { return std::abs(static_cast<double>(problem.error[u])); }) / std::max(count, 1.0);
}

// The way from fluid row a to fluid row b, m.
template <int D>
ShortVector<D> way(const Scene<D>& scene, const DensityProblem<D>& problem, std::size_t a, std::size_t b) {
  const ShortVector<D> r = problem.place[b] - problem.place[a];
  if (!scene.space.any) return r;
  const Vector<D> whole = r.template head<D>().template cast<double>();
  return pad<D>(scene.space.difference(Vector<D>::Zero(), whole)).template cast<float>();
}

// J = dC/dx: dC_i/dx_i = sum_j steepness_ij (x_j - x_i) over all neighbours, and the opposite of its part by a fluid neighbour j is
// dC_i/dx_j; walls and ports keep their place.
template <int D>
void density_slopes(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, DensityProblem<D>& problem) {
  const Index first = static_cast<Index>(scene.first_fluid), rows = static_cast<Index>(problem.error.size());
  const double radius = scene.lattice.radius, closest = scene.lattice.closest(), factor = radius / scene.lattice.number_density;
  problem.own.resize(rows), problem.inverse_diagonal.resize(rows), problem.last.resize(rows), problem.place.resize(rows);
  problem.column.resize(work.neighbors.index.size()), problem.steepness.resize(work.neighbors.index.size());
  const Padded<D> origin = problem.position[first];  // single precision is for what lies near
#pragma omp parallel for schedule(dynamic, 512)
  for (Index u = 0; u < rows; ++u) {
    const Index i = u + first;
    problem.place[u] = (problem.position[i] - origin).template cast<float>();
    std::int64_t last = work.neighbors.start[i];
    Padded<D> own = Padded<D>::Zero();
    double squares = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const Padded<D> r = scene.space.difference(problem.position[i], problem.position[j]);
      const double distance = r.norm();
      if (!(distance < radius) || !(distance > closest)) continue;  // there the weight is 0, or does not grow any more
      const double steepness = factor * (j < first ? scene.measure[j] : 1.0) / (distance * distance * distance);
      own += steepness * r;
      if (j < first || state.kind[j] != Kind::fluid) continue;
      problem.column[last] = static_cast<std::int32_t>(j - first);
      problem.steepness[last++] = static_cast<float>(steepness);
      squares += steepness * steepness * distance * distance;
    }
    if (state.kind[i] != Kind::fluid) own.setZero(), last = work.neighbors.start[i];
    problem.last[u] = last;
    problem.own[u] = own.template cast<float>();
    squares += own.squaredNorm();
    problem.inverse_diagonal[u] = problem.active[u] && squares > 0 ? static_cast<float>(1 / squares) : 0.0F;
  }
}

// J^T l
template <int D>
void displacements(const Scene<D>& scene, const Workspace<D>& work, DensityProblem<D>& problem, const std::vector<float>& l) {
  const Index rows = static_cast<Index>(problem.error.size()), first = static_cast<Index>(scene.first_fluid);
  problem.displacement.resize(rows);
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    ShortVector<D> sum = l[u] * problem.own[u];
    for (std::int64_t k = work.neighbors.start[u + first]; k < problem.last[u]; ++k) {
      const std::int32_t j = problem.column[k];
      sum += l[j] * problem.steepness[k] * way(scene, problem, u, j);
    }
    problem.displacement[u] = sum;
  }
}

// q = J d where something is to be mended, else 0
template <int D>
void density_changes(const Scene<D>& scene, const Workspace<D>& work, const DensityProblem<D>& problem, std::vector<float>& q) {
  const Index rows = static_cast<Index>(problem.error.size()), first = static_cast<Index>(scene.first_fluid);
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    ShortVector<D> sum = problem.own[u].cwiseProduct(problem.displacement[u]);
    if (problem.active[u])
      for (std::int64_t k = work.neighbors.start[u + first]; k < problem.last[u]; ++k) {
        const std::int32_t j = problem.column[k];
        sum -= problem.steepness[k] * way(scene, problem, u, j).cwiseProduct(problem.displacement[j]);
      }
    q[u] = problem.active[u] ? sum.sum() : 0.0F;
  }
}

// Conjugate gradients for J J^T l = C to a mean residual of scheme.density_tolerance.
template <int D>
void solve_multipliers(const Scene<D>& scene, const Workspace<D>& work, DensityProblem<D>& problem, DensityReport& report) {
  constexpr int most = 20;
  const double tolerance = scene.description.scheme.density_tolerance;
  const std::size_t rows = problem.error.size();
  std::vector<float>&l = problem.multiplier, &r = problem.error, &p = problem.direction, &q = problem.product;
  l.assign(rows, 0), p.assign(rows, 0), q.resize(rows);
  const double active = ordered_sum(rows, [&](std::size_t u) { return problem.active[u] ? 1.0 : 0.0; });
  const auto scaled = [&](std::size_t u) { return problem.inverse_diagonal[u] * r[u]; };
  double before = 0;
  while (report.after > tolerance && report.iterations < most) {
    const double now = ordered_sum(rows, [&](std::size_t u) { return static_cast<double>(r[u] * scaled(u)); });
    const auto beta = static_cast<float>(report.iterations > 0 ? now / before : 0.0);
#pragma omp parallel for schedule(static)
    for (Index u = 0; u < static_cast<Index>(rows); ++u) p[u] = scaled(u) + beta * p[u];
    displacements(scene, work, problem, p);
    density_changes(scene, work, problem, q);
    const double curvature = ordered_sum(rows, [&](std::size_t u) { return static_cast<double>(p[u] * q[u]); });
    if (!(curvature > 0)) break;
    const auto alpha = static_cast<float>(now / curvature);
    report.after = ordered_sum(rows,
                               [&](std::size_t u) {
                                 l[u] += alpha * p[u];
                                 r[u] -= alpha * q[u];
                                 return std::abs(static_cast<double>(r[u]));
                               }) /
                   active;
    before = now;
    ++report.iterations;
  }
}

}  // namespace

template <int D>
DensityReport project_density(const Scene<D>& scene, State<D>& state, Workspace<D>& work) {
  DensityReport report;
  const double tolerance = scene.description.scheme.density_tolerance, farthest = 0.05 * scene.lattice.spacing;
  const bool alone = !scene.solids && !scene.shells;
  if (tolerance == 0 || !scene.pressure->free_surface || !alone) return report;
  DensityProblem<D>& problem = work.density;
  report.before = report.after = density_errors(scene, state, work, problem);
  if (report.before <= tolerance) return report;
  density_slopes(scene, state, work, problem);
  solve_multipliers(scene, work, problem, report);
  displacements(scene, work, problem, problem.multiplier);
  const Index rows = static_cast<Index>(problem.error.size());
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    const Vector<D> push = problem.displacement[u].template head<D>().template cast<double>();
    state.position[u + scene.first_fluid] -= std::min(1.0, farthest / std::max(push.norm(), 1e-300)) * push;
  }
  return report;
}

template DensityReport project_density(const Scene<2>&, State<2>&, Workspace<2>&);
template DensityReport project_density(const Scene<3>&, State<3>&, Workspace<3>&);

}  // namespace sim
