#include "sim/linear_solver.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/parallel.h"

namespace sim {
namespace {

using Index = std::ptrdiff_t;
constexpr float damping = 0.7f;
constexpr float overcorrection = 1.5f;
constexpr std::size_t coarsest = 60;

double dot(std::span<const double> a, std::span<const double> b) {
  return ordered_sum(a.size(), [&](std::size_t i) { return a[i] * b[i]; });
}

// Greedy aggregates: a row whose strong neighbours are all free starts one with them; leftovers join the strongest neighbour's.
std::vector<std::int32_t> aggregates(const MultigridLevel& fine, std::int32_t& count) {
  const std::size_t n = fine.diagonal.size();
  std::vector<float> strong(n);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    float most = 0;
    for (std::int64_t k = fine.start[i]; k < fine.start[i + 1]; ++k) most = std::max(most, -fine.value[k]);
    strong[i] = 0.5f * most;
  }
  std::vector<std::int32_t> of(n, -1);
  count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (of[i] >= 0 || strong[i] <= 0) continue;
    bool free = true;
    for (std::int64_t k = fine.start[i]; k < fine.start[i + 1] && free; ++k)
      if (-fine.value[k] >= strong[i] && of[fine.column[k]] >= 0) free = false;
    if (!free) continue;
    of[i] = count;
    for (std::int64_t k = fine.start[i]; k < fine.start[i + 1]; ++k)
      if (-fine.value[k] >= strong[i]) of[fine.column[k]] = count;
    ++count;
  }
  const std::vector<std::int32_t> first = of;
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    if (first[i] >= 0) continue;
    float most = 0;
    for (std::int64_t k = fine.start[i]; k < fine.start[i + 1]; ++k)
      if (first[fine.column[k]] >= 0 && -fine.value[k] > most) {
        most = -fine.value[k];
        of[i] = first[fine.column[k]];
      }
  }
  for (std::size_t i = 0; i < n; ++i)
    if (of[i] < 0) of[i] = count++;
  return of;
}

// Galerkin product with piecewise-constant prolongation: A_IJ = sum of a_ij over i in I, j in J.
MultigridLevel coarsen(const MultigridLevel& fine, std::vector<std::int32_t> of, std::int32_t count) {
  MultigridLevel coarse;
  const std::size_t n = fine.diagonal.size();
  std::vector<std::int32_t> start(count + 1, 0), member(n);
  for (std::int32_t a : of) ++start[a + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::int32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < n; ++i) member[next[of[i]]++] = static_cast<std::int32_t>(i);
  coarse.diagonal.assign(count, 0);
  coarse.start.assign(count + 1, 0);
  struct Piece {  // one thread's rows, later put together in order
    std::int32_t first = 0;
    std::vector<std::int32_t> column;
    std::vector<float> value;
  };
  std::vector<Piece> pieces(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel
  {
    Piece& piece = pieces[omp_get_thread_num()];
    std::vector<std::int32_t> seen(count, -1), columns;
    std::vector<float> sums(count, 0);
    piece.first = count;
#pragma omp for schedule(static)
    for (std::int32_t a = 0; a < count; ++a) {
      piece.first = std::min(piece.first, a);
      columns.clear();
      for (std::int32_t m = start[a]; m < start[a + 1]; ++m) {
        const std::int32_t i = member[m];
        coarse.diagonal[a] += fine.diagonal[i];
        for (std::int64_t k = fine.start[i]; k < fine.start[i + 1]; ++k) {
          const std::int32_t b = of[fine.column[k]];
          if (b == a) {
            coarse.diagonal[a] += fine.value[k];
          } else if (seen[b] != a) {
            seen[b] = a;
            sums[b] = fine.value[k];
            columns.push_back(b);
          } else {
            sums[b] += fine.value[k];
          }
        }
      }
      std::sort(columns.begin(), columns.end());
      for (std::int32_t b : columns) {
        piece.column.push_back(b);
        piece.value.push_back(sums[b]);
      }
      coarse.start[a + 1] = static_cast<std::int64_t>(columns.size());
    }
  }
  std::partial_sum(coarse.start.begin(), coarse.start.end(), coarse.start.begin());
  std::sort(pieces.begin(), pieces.end(), [](const Piece& p, const Piece& q) { return p.first < q.first; });
  coarse.column.reserve(coarse.start[count]);
  coarse.value.reserve(coarse.start[count]);
  for (const Piece& piece : pieces) {
    coarse.column.insert(coarse.column.end(), piece.column.begin(), piece.column.end());
    coarse.value.insert(coarse.value.end(), piece.value.begin(), piece.value.end());
  }
  coarse.aggregate = std::move(of);
  return coarse;
}

void prepare(MultigridLevel& level) {
  const std::size_t n = level.diagonal.size();
  level.inverse_diagonal.resize(n);
  for (std::size_t i = 0; i < n; ++i) level.inverse_diagonal[i] = level.diagonal[i] > 0 ? 1.0f / level.diagonal[i] : 0.0f;
  level.x.resize(n);
  level.b.resize(n);
  level.r.resize(n);
}

// Dense inverse of the coarsest matrix, its diagonal lifted by 1e-6 so that a singular (closed) system stays bounded.
std::vector<double> dense_inverse(const MultigridLevel& level) {
  const std::size_t n = level.diagonal.size();
  std::vector<double> a(n * n, 0), inverse(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    a[i * n + i] = level.diagonal[i] > 0 ? level.diagonal[i] * (1.0 + 1e-6) : 1.0;
    for (std::int64_t k = level.start[i]; k < level.start[i + 1]; ++k) a[i * n + level.column[k]] += level.value[k];
    inverse[i * n + i] = 1;
  }
  for (std::size_t c = 0; c < n; ++c) {
    double pivot = a[c * n + c];
    if (!(pivot > 1e-30)) pivot = 1e-30;
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c || a[r * n + c] == 0) continue;
      const double f = a[r * n + c] / pivot;
      for (std::size_t k = c; k < n; ++k) a[r * n + k] -= f * a[c * n + k];
      for (std::size_t k = 0; k < n; ++k) inverse[r * n + k] -= f * inverse[c * n + k];
    }
    for (std::size_t k = c + 1; k < n; ++k) a[c * n + k] /= pivot;
    for (std::size_t k = 0; k < n; ++k) inverse[c * n + k] /= pivot;
    a[c * n + c] = 1;
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) inverse[i * n + j] = inverse[j * n + i] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
  return inverse;
}

// r = b - A x
void level_residual(MultigridLevel& l) {
  const Index n = static_cast<Index>(l.diagonal.size());
#pragma omp parallel for schedule(static) if (n > 2000)
  for (Index i = 0; i < n; ++i) {
    float s = l.b[i] - l.diagonal[i] * l.x[i];
    for (std::int64_t k = l.start[i]; k < l.start[i + 1]; ++k) s -= l.value[k] * l.x[l.column[k]];
    l.r[i] = s;
  }
}

void cycle(Multigrid& mg, std::size_t depth) {
  MultigridLevel& l = mg.levels[depth];
  const Index n = static_cast<Index>(l.diagonal.size());
  if (depth + 1 == mg.levels.size()) {
    if (mg.coarse_inverse.empty()) {
      for (Index i = 0; i < n; ++i) l.x[i] = damping * l.inverse_diagonal[i] * l.b[i];
      return;
    }
    for (Index i = 0; i < n; ++i) {
      double s = 0;
      for (Index j = 0; j < n; ++j) s += mg.coarse_inverse[i * n + j] * l.b[j];
      l.x[i] = static_cast<float>(s);
    }
    return;
  }
  for (Index i = 0; i < n; ++i) l.x[i] = damping * l.inverse_diagonal[i] * l.b[i];
  level_residual(l);
  MultigridLevel& c = mg.levels[depth + 1];
  std::fill(c.b.begin(), c.b.end(), 0.0f);
  for (Index i = 0; i < n; ++i) c.b[c.aggregate[i]] += l.r[i];
  cycle(mg, depth + 1);
  for (Index i = 0; i < n; ++i) l.x[i] += overcorrection * c.x[c.aggregate[i]];
  level_residual(l);
  for (Index i = 0; i < n; ++i) l.x[i] += damping * l.inverse_diagonal[i] * l.r[i];
}

}  // namespace

void multiply(const SymmetricMatrix& m, std::span<const double> x, std::span<double> y) {
  const Index n = static_cast<Index>(m.rows());
#pragma omp parallel for schedule(static) if (n > 2000)
  for (Index i = 0; i < n; ++i) {
    double s = m.diagonal[i] * x[i];
    for (std::int64_t k = m.start[i]; k < m.start[i + 1]; ++k) s += m.value[k] * x[m.column[k]];
    y[i] = s;
  }
}

Multigrid build_multigrid(const SymmetricMatrix& matrix) {
  Multigrid mg;
  MultigridLevel finest;
  finest.start = matrix.start;
  finest.column = matrix.column;
  finest.value.assign(matrix.value.begin(), matrix.value.end());
  finest.diagonal.assign(matrix.diagonal.begin(), matrix.diagonal.end());
  prepare(finest);
  mg.levels.push_back(std::move(finest));
  while (mg.levels.back().diagonal.size() > coarsest && mg.levels.size() < 12) {
    const MultigridLevel& fine = mg.levels.back();
    std::int32_t count = 0;
    std::vector<std::int32_t> of = aggregates(fine, count);
    if (count == 0 || static_cast<double>(count) > 0.8 * static_cast<double>(fine.diagonal.size())) break;
    MultigridLevel coarse = coarsen(fine, std::move(of), count);
    prepare(coarse);
    mg.levels.push_back(std::move(coarse));
  }
  if (mg.levels.back().diagonal.size() <= 4 * coarsest) mg.coarse_inverse = dense_inverse(mg.levels.back());
  return mg;
}

void apply_multigrid(Multigrid& mg, std::span<const double> r, std::span<double> z) {
  MultigridLevel& l = mg.levels.front();
  const Index n = static_cast<Index>(l.diagonal.size());
  double scale = 0;
  for (double v : r) scale = std::max(scale, std::abs(v));
  if (!(scale > 0)) {
    std::fill(z.begin(), z.end(), 0.0);
    return;
  }
  for (Index i = 0; i < n; ++i) l.b[i] = static_cast<float>(r[i] / scale);
  cycle(mg, 0);
  for (Index i = 0; i < n; ++i) z[i] = l.x[i] * scale;
}

SolveReport conjugate_gradient(const SymmetricMatrix& matrix, std::span<const double> b, std::span<double> x, double tolerance,
                               int max_iterations, Multigrid* multigrid, ConjugateGradientScratch& s,
                               const std::function<void(std::span<const double>, std::span<double>)>& add_to_product) {
  const std::size_t n = matrix.rows();
  s.r.resize(n), s.z.resize(n), s.p.resize(n), s.q.resize(n);
  SolveReport report;
  const double norm_b = std::sqrt(dot(b, b));
  if (!(norm_b > 0)) {
    std::fill(x.begin(), x.end(), 0.0);
    report.converged = norm_b == 0;
    return report;
  }
  auto precondition = [&] {
    if (multigrid) return apply_multigrid(*multigrid, s.r, s.z);
    for (std::size_t i = 0; i < n; ++i) s.z[i] = matrix.diagonal[i] > 0 ? s.r[i] / matrix.diagonal[i] : 0;
  };
  multiply(matrix, x, s.q);
  if (add_to_product) add_to_product(x, s.q);
  for (std::size_t i = 0; i < n; ++i) s.r[i] = b[i] - s.q[i];
  double norm_r = std::sqrt(dot(s.r, s.r));
  double rho_old = 0;
  while (norm_r > tolerance * norm_b && report.iterations < max_iterations) {
    precondition();
    const double rho = dot(s.r, s.z);
    const double beta = report.iterations == 0 ? 0 : rho / rho_old;
    for (std::size_t i = 0; i < n; ++i) s.p[i] = s.z[i] + beta * s.p[i];
    multiply(matrix, s.p, s.q);
    if (add_to_product) add_to_product(s.p, s.q);
    const double curvature = dot(s.p, s.q);
    if (!(curvature > 0) || !(rho > 0)) break;
    const double alpha = rho / curvature;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] += alpha * s.p[i];
      s.r[i] -= alpha * s.q[i];
    }
    rho_old = rho;
    norm_r = std::sqrt(dot(s.r, s.r));
    ++report.iterations;
  }
  report.residual = norm_r / norm_b;
  report.converged = norm_r <= tolerance * norm_b;
  return report;
}

}  // namespace sim
