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

// J = dC/dx: row i has slope_ij = dC_i/dx_i by neighbour j for itself, -slope_ij for a fluid neighbour j; walls and ports keep their place.
template <int D>
void density_slopes(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, DensityProblem<D>& problem) {
  const Index first = static_cast<Index>(scene.first_fluid), rows = static_cast<Index>(problem.error.size());
  const double radius = scene.lattice.radius, closest = scene.lattice.closest(), factor = radius / scene.lattice.number_density;
  problem.own.resize(rows), problem.inverse_diagonal.resize(rows), problem.last.resize(rows);
  problem.column.resize(work.neighbors.index.size()), problem.slope.resize(work.neighbors.index.size());
#pragma omp parallel for schedule(dynamic, 512)
  for (Index u = 0; u < rows; ++u) {
    const Index i = u + first;
    std::int64_t last = work.neighbors.start[i];
    Padded<D> own = Padded<D>::Zero();
    double squares = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const Padded<D> r = scene.space.difference(problem.position[i], problem.position[j]);
      const double distance = r.norm();
      if (!(distance < radius) || !(distance > closest)) continue;  // there the weight is 0, or does not grow any more
      const Padded<D> slope = factor * (j < first ? scene.measure[j] : 1.0) / (distance * distance * distance) * r;
      own += slope;
      if (j < first || state.kind[j] != Kind::fluid) continue;
      problem.column[last] = static_cast<std::int32_t>(j - first);
      problem.slope[last++] = slope.template cast<float>();
      squares += slope.squaredNorm();
    }
    problem.last[u] = last;
    if (state.kind[i] != Kind::fluid) own.setZero();
    problem.own[u] = own.template cast<float>();
    squares += own.squaredNorm();
    problem.inverse_diagonal[u] = problem.active[u] && squares > 0 ? static_cast<float>(1 / squares) : 0.0F;
  }
}

// J^T l
template <int D>
void displacements(const Workspace<D>& work, DensityProblem<D>& problem, std::int64_t first, const std::vector<float>& l) {
  const Index rows = static_cast<Index>(problem.error.size());
  problem.displacement.resize(rows);
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    ShortVector<D> sum = l[u] * problem.own[u];
    for (std::int64_t k = work.neighbors.start[u + first]; k < problem.last[u]; ++k) sum += l[problem.column[k]] * problem.slope[k];
    problem.displacement[u] = sum;
  }
}

// q = J d where something is to be mended, else 0
template <int D>
void density_changes(const Workspace<D>& work, const DensityProblem<D>& problem, std::int64_t first, std::vector<float>& q) {
  const Index rows = static_cast<Index>(problem.error.size());
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    ShortVector<D> sum = problem.own[u].cwiseProduct(problem.displacement[u]);
    if (problem.active[u])
      for (std::int64_t k = work.neighbors.start[u + first]; k < problem.last[u]; ++k)
        sum -= problem.slope[k].cwiseProduct(problem.displacement[problem.column[k]]);
    q[u] = problem.active[u] ? sum.sum() : 0.0F;
  }
}

// Conjugate gradients for J J^T l = C to a mean residual of `tolerance`.
template <int D>
void solve_multipliers(const Workspace<D>& work, DensityProblem<D>& problem, std::int64_t first, double tolerance, DensityReport& report) {
  constexpr int most = 20;
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
    displacements(work, problem, first, p);
    density_changes(work, problem, first, q);
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
  const double tolerance = scene.description.scheme.density_tolerance, farthest = 0.1 * scene.lattice.spacing;
  const bool alone = !scene.solids && !scene.shells;
  if (tolerance == 0 || !scene.pressure->free_surface || !alone) return report;
  DensityProblem<D>& problem = work.density;
  report.before = report.after = density_errors(scene, state, work, problem);
  if (report.before <= tolerance) return report;
  density_slopes(scene, state, work, problem);
  solve_multipliers(work, problem, scene.first_fluid, tolerance, report);
  displacements(work, problem, scene.first_fluid, problem.multiplier);
  const Index rows = static_cast<Index>(problem.error.size());
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    const Vector<D> way = -problem.displacement[u].template head<D>().template cast<double>();
    state.position[u + scene.first_fluid] += std::min(1.0, farthest / std::max(way.norm(), 1e-300)) * way;
  }
  return report;
}

template DensityReport project_density(const Scene<2>&, State<2>&, Workspace<2>&);
template DensityReport project_density(const Scene<3>&, State<3>&, Workspace<3>&);

}  // namespace sim
