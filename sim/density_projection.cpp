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

// How many fluid rows are asked for their error, and its mean size over them, -.
struct ErrorSize {
  double count = 0, mean = 0;
};

template <int D>
ErrorSize density_errors(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, DensityProblem<D>& problem) {
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
  const double sum = ordered_sum(rows, [&](std::size_t u) { return std::abs(static_cast<double>(problem.error[u])); });
  return {count, sum / std::max(count, 1.0)};
}

// The sum of term(k, way to its neighbour, m) over the links k of fluid row u: two sums at a time, which do not wait for each other.
template <int D, bool periodic, class Term>
ShortVector<D> sum_links(const Scene<D>& scene, const Workspace<D>& work, const DensityProblem<D>& problem, Index u, Term&& term) {
  const ShortVector<D> here = problem.place[u];
  const auto one = [&](std::int64_t k) -> ShortVector<D> {
    const ShortVector<D> r = problem.place[problem.column[k]] - here;
    if constexpr (!periodic) return term(k, r);
    const Vector<D> whole = r.template head<D>().template cast<double>();
    return term(k, pad<D>(scene.space.difference(Vector<D>::Zero(), whole)).template cast<float>());
  };
  std::int64_t k = work.neighbors.start[u + static_cast<Index>(scene.first_fluid)];
  ShortVector<D> even = ShortVector<D>::Zero(), odd = even;
  for (; k + 1 < problem.last[u]; k += 2) even += one(k), odd += one(k + 1);
  if (k < problem.last[u]) even += one(k);
  return even + odd;
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

// d = J^T l
template <int D, bool periodic>
void displacements(const Scene<D>& scene, const Workspace<D>& work, DensityProblem<D>& problem, const std::vector<float>& l) {
  const Index rows = static_cast<Index>(problem.error.size());
  problem.displacement.resize(rows);
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u)
    problem.displacement[u] =
        l[u] * problem.own[u] + sum_links<D, periodic>(scene, work, problem, u, [&](std::int64_t k, const ShortVector<D>& r) {
          return ShortVector<D>(l[problem.column[k]] * problem.steepness[k] * r);
        });
}

// q = J d where something is to be mended, else 0
template <int D, bool periodic>
void density_changes(const Scene<D>& scene, const Workspace<D>& work, const DensityProblem<D>& problem, std::vector<float>& q) {
  const Index rows = static_cast<Index>(problem.error.size());
#pragma omp parallel for schedule(static)
  for (Index u = 0; u < rows; ++u) {
    q[u] = 0;
    if (!problem.active[u]) continue;
    const ShortVector<D> others = sum_links<D, periodic>(scene, work, problem, u, [&](std::int64_t k, const ShortVector<D>& r) {
      return ShortVector<D>(problem.steepness[k] * r.cwiseProduct(problem.displacement[problem.column[k]]));
    });
    q[u] = (problem.own[u].cwiseProduct(problem.displacement[u]) - others).sum();
  }
}

// Conjugate gradients for J J^T l = C to a mean residual of scheme.density_tolerance; then d = J^T l.
template <int D, bool periodic>
void solve_multipliers(const Scene<D>& scene, const Workspace<D>& work, DensityProblem<D>& problem, double asked, DensityReport& report) {
  constexpr int most = 20;
  const double tolerance = scene.description.scheme.density_tolerance;
  const std::size_t rows = problem.error.size();
  std::vector<float>&l = problem.multiplier, &r = problem.error, &p = problem.direction, &q = problem.product;
  l.assign(rows, 0), p.assign(rows, 0), q.resize(rows);
  const auto scaled = [&](std::size_t u) { return problem.inverse_diagonal[u] * r[u]; };
  double before = 0;
  while (report.after > tolerance && report.iterations < most) {
    const double now = ordered_sum(rows, [&](std::size_t u) { return static_cast<double>(r[u] * scaled(u)); });
    const auto beta = static_cast<float>(report.iterations > 0 ? now / before : 0.0);
#pragma omp parallel for schedule(static)
    for (Index u = 0; u < static_cast<Index>(rows); ++u) p[u] = scaled(u) + beta * p[u];
    displacements<D, periodic>(scene, work, problem, p);
    density_changes<D, periodic>(scene, work, problem, q);
    const double curvature = ordered_sum(rows, [&](std::size_t u) { return static_cast<double>(p[u] * q[u]); });
    if (!(curvature > 0)) break;
    const auto alpha = static_cast<float>(now / curvature);
    report.after = ordered_sum(rows,
                               [&](std::size_t u) {
                                 l[u] += alpha * p[u];
                                 r[u] -= alpha * q[u];
                                 return std::abs(static_cast<double>(r[u]));
                               }) /
                   asked;
    before = now;
    ++report.iterations;
  }
  displacements<D, periodic>(scene, work, problem, l);
}

}  // namespace

template <int D>
DensityReport project_density(const Scene<D>& scene, State<D>& state, Workspace<D>& work) {
  DensityReport report;
  const double tolerance = scene.description.scheme.density_tolerance, farthest = 0.05 * scene.lattice.spacing;
  const bool alone = !scene.solids && !scene.shells;
  if (tolerance == 0 || !scene.pressure->free_surface || !alone) return report;
  DensityProblem<D>& problem = work.density;
  const ErrorSize error = density_errors(scene, state, work, problem);
  report.before = report.after = error.mean;
  if (report.before <= tolerance) return report;
  density_slopes(scene, state, work, problem);
  if (scene.space.any)
    solve_multipliers<D, true>(scene, work, problem, error.count, report);
  else
    solve_multipliers<D, false>(scene, work, problem, error.count, report);
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
