#include "sim/multigrid.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/parallel.h"

namespace sim {
namespace {

using Index = std::ptrdiff_t;
constexpr float overcorrection = 1.5f;
constexpr std::size_t coarsest = 60;
constexpr Index block = 2048;   // rows of one Gauss-Seidel sweep
constexpr Index serial = 2000;  // rows below which a second thread costs more than it gives

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
  // Block by block, so that blocks can be dealt with at once; numbered in order of the blocks.
  std::vector<std::int32_t> of(n, -1);
  const Index blocks = (static_cast<Index>(n) + block - 1) / block;
  std::vector<std::int32_t> begin(blocks + 1, 0);
#pragma omp parallel for schedule(static) if (blocks > 1)
  for (Index q = 0; q < blocks; ++q) {
    std::int32_t made = 0;
    for (Index i = q * block; i < std::min(static_cast<Index>(n), (q + 1) * block); ++i) {
      if (of[i] >= 0 || strong[i] <= 0) continue;
      bool free = true;
      for (std::int64_t k = fine.start[i]; k < fine.upper[i] && free; ++k)
        if (-fine.value[k] >= strong[i] && of[fine.column[k]] >= 0) free = false;
      if (!free) continue;
      of[i] = made;
      for (std::int64_t k = fine.start[i]; k < fine.upper[i]; ++k)
        if (-fine.value[k] >= strong[i]) of[fine.column[k]] = made;
      ++made;
    }
    begin[q + 1] = made;
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  count = begin[blocks];
#pragma omp parallel for schedule(static) if (blocks > 1)
  for (Index i = 0; i < static_cast<Index>(n); ++i)
    if (of[i] >= 0) of[i] += begin[i / block];
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
MultigridLevel coarsen(MultigridLevel& fine, std::vector<std::int32_t> of, std::int32_t count) {
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
      for (std::int32_t b : columns) {
        piece.column.push_back(b);
        piece.value.push_back(sums[b]);
      }
      coarse.start[a + 1] = static_cast<std::int64_t>(columns.size());
    }
  }
  std::partial_sum(coarse.start.begin(), coarse.start.end(), coarse.start.begin());
  coarse.column.resize(coarse.start[count]);
  coarse.value.resize(coarse.start[count]);
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (pieces[p].column.empty()) continue;
    std::copy(pieces[p].column.begin(), pieces[p].column.end(), coarse.column.begin() + coarse.start[pieces[p].first]);
    std::copy(pieces[p].value.begin(), pieces[p].value.end(), coarse.value.begin() + coarse.start[pieces[p].first]);
  }
  fine.aggregate = std::move(of), fine.member_start = std::move(start), fine.member = std::move(member);
  return coarse;
}

// Dense generalised inverse of the coarsest matrix. Its diagonals are put together from the rows' sums, so that a closed region's rows sum
// to 0 to double precision whatever the scale; the last unknown of such a region, whose pivot vanishes, is then held at 0.
std::vector<double> dense_inverse(const MultigridLevel& level, const std::vector<double>& row_sum) {
  const std::size_t n = level.diagonal.size();
  constexpr double vanishing = 1e-10;  // of the diagonal: far above the rounding of a sum, far below a region's hold on a given pressure
  std::vector<double> a(n * n, 0), inverse(n * n, 0), diagonal(row_sum);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::int64_t k = level.start[i]; k < level.start[i + 1]; ++k) {
      a[i * n + level.column[k]] = level.value[k];
      diagonal[i] -= level.value[k];
    }
    a[i * n + i] = diagonal[i];
    inverse[i * n + i] = 1;
  }
  std::vector<bool> held(n, false);
  for (std::size_t c = 0; c < n; ++c) {
    const double pivot = a[c * n + c];
    held[c] = !(pivot > vanishing * diagonal[c]);
    if (held[c]) continue;
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
  for (std::size_t c = 0; c < n; ++c)
    if (held[c])
      for (std::size_t k = 0; k < n; ++k) inverse[c * n + k] = inverse[k * n + c] = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) inverse[i * n + j] = inverse[j * n + i] = 0.5 * (inverse[i * n + j] + inverse[j * n + i]);
  return inverse;
}

// Sorts each row's entries by where their columns lie (see MultigridLevel) and makes room for the scratch.
struct RowParts {
  std::vector<std::pair<std::int32_t, float>> before, after, other;
  void clear() { before.clear(), after.clear(), other.clear(); }
  void add(Index i, std::int32_t j, float value) {
    const Index first = i / block * block;
    (j < first || j >= first + block ? other : j < i ? before : after).emplace_back(j, value);
  }
  void write(MultigridLevel& level, Index i) const {
    std::int64_t k = level.start[i];
    for (const auto* part : {&before, &after, &other}) {
      for (const auto& [j, v] : *part) level.column[k] = j, level.value[k++] = v;
      if (part == &before) level.lower[i] = k;
      if (part == &after) level.upper[i] = k;
    }
  }
};
void make_room(MultigridLevel& level, Index n) {
  level.inverse_diagonal.resize(n), level.lower.resize(n), level.upper.resize(n);
  level.x.resize(n), level.b.resize(n), level.r.resize(n);
}
float inverse_or_zero(float diagonal) { return diagonal > 0 ? 1.0f / diagonal : 0.0f; }

void prepare(MultigridLevel& level) {
  const Index n = static_cast<Index>(level.diagonal.size());
  make_room(level, n);
#pragma omp parallel if (n > serial)
  {
    RowParts parts;
#pragma omp for schedule(static)
    for (Index i = 0; i < n; ++i) {
      level.inverse_diagonal[i] = inverse_or_zero(level.diagonal[i]);
      parts.clear();
      for (std::int64_t k = level.start[i]; k < level.start[i + 1]; ++k) parts.add(i, level.column[k], level.value[k]);
      parts.write(level, i);
    }
  }
}

// The finest level, and the sums of the matrix' rows: 0 where no pressure is given nearby. In double: sums of floats would lose them, and
// with them the one mode that a closed region leaves open.
std::vector<double> make_finest(MultigridLevel& level, const SymmetricMatrix& matrix, const SymmetricMatrix* further) {
  const Index n = static_cast<Index>(matrix.rows());
  std::vector<double> sums(static_cast<std::size_t>(n));
  make_room(level, n);
  level.start = matrix.start;
  level.diagonal.resize(n);
  if (further)
    for (Index i = 0; i <= n; ++i) level.start[i] += further->start[i];
  level.column.resize(level.start[n]), level.value.resize(level.start[n]);
#pragma omp parallel
  {
    RowParts parts;
#pragma omp for schedule(static)
    for (Index i = 0; i < n; ++i) {
      double sum = matrix.diagonal[i];
      parts.clear();
      for (std::int64_t k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
        sum += matrix.value[k];
        parts.add(i, matrix.column[k], static_cast<float>(matrix.value[k]));
      }
      sums[i] = std::abs(sum) > 1e-13 * matrix.diagonal[i] ? sum : 0;
      if (further)
        for (std::int64_t k = further->start[i]; k < further->start[i + 1]; ++k)
          parts.add(i, further->column[k], static_cast<float>(further->value[k]));
      parts.write(level, i);
      level.diagonal[i] = static_cast<float>(matrix.diagonal[i] + (further ? further->diagonal[i] : 0.0));
      level.inverse_diagonal[i] = inverse_or_zero(level.diagonal[i]);
    }
  }
  return sums;
}

float row_sum(const MultigridLevel& l, std::int64_t first, std::int64_t last) {
  float s = 0;
  for (std::int64_t k = first; k < last; ++k) s += l.value[k] * l.x[l.column[k]];
  return s;
}

// One forward sweep from x = 0, and r = b - A x after it: what lies before a row in its block is balanced already.
void smooth_forward(MultigridLevel& l) {
  const Index n = static_cast<Index>(l.diagonal.size()), blocks = (n + block - 1) / block;
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index q = 0; q < blocks; ++q)
    for (Index i = q * block; i < std::min(n, (q + 1) * block); ++i)
      l.x[i] = l.inverse_diagonal[i] * (l.b[i] - row_sum(l, l.start[i], l.lower[i]));
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index i = 0; i < n; ++i) l.r[i] = l.inverse_diagonal[i] > 0 ? -row_sum(l, l.lower[i], l.start[i + 1]) : l.b[i];
}

// One backward sweep from the present x; the adjoint of the forward one. `r` is scratch.
void smooth_backward(MultigridLevel& l) {
  const Index n = static_cast<Index>(l.diagonal.size()), blocks = (n + block - 1) / block;
  std::swap(l.r, l.x);  // old values in r
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index q = 0; q < blocks; ++q) {
    const Index first = q * block, last = std::min(n, first + block);
    for (Index i = last - 1; i >= first; --i) {
      float s = l.b[i];
      for (std::int64_t k = l.start[i]; k < l.lower[i]; ++k) s -= l.value[k] * l.r[l.column[k]];
      for (std::int64_t k = l.lower[i]; k < l.upper[i]; ++k) s -= l.value[k] * l.x[l.column[k]];
      for (std::int64_t k = l.upper[i]; k < l.start[i + 1]; ++k) s -= l.value[k] * l.r[l.column[k]];
      l.x[i] = l.inverse_diagonal[i] * s;
    }
  }
}

void coarsest_solution(Multigrid& mg) {
  MultigridLevel& l = mg.levels.back();
  const Index n = static_cast<Index>(l.diagonal.size());
  if (mg.coarse_inverse.empty()) {  // a symmetric smoother alone
    smooth_forward(l);
    smooth_backward(l);
    return;
  }
  for (Index i = 0; i < n; ++i) {
    double s = 0;
    for (Index j = 0; j < n; ++j) s += mg.coarse_inverse[i * n + j] * l.b[j];
    l.x[i] = static_cast<float>(s);
  }
}

void cycle(Multigrid& mg, std::size_t depth) {
  if (depth + 1 == mg.levels.size()) return coarsest_solution(mg);
  MultigridLevel& l = mg.levels[depth];
  MultigridLevel& c = mg.levels[depth + 1];
  const Index n = static_cast<Index>(l.diagonal.size()), coarse = static_cast<Index>(c.diagonal.size());
  smooth_forward(l);
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index a = 0; a < coarse; ++a) {
    float sum = 0;
    for (std::int32_t m = l.member_start[a]; m < l.member_start[a + 1]; ++m) sum += l.r[l.member[m]];
    c.b[a] = sum;
  }
  cycle(mg, depth + 1);
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index i = 0; i < n; ++i) l.x[i] += overcorrection * c.x[l.aggregate[i]];
  smooth_backward(l);
}

}  // namespace

void build_multigrid(Multigrid& mg, const SymmetricMatrix& matrix, const SymmetricMatrix* further) {
  MultigridLevel finest;
  if (!mg.levels.empty()) finest = std::move(mg.levels.front());  // its room
  mg.levels.clear();
  mg.coarse_inverse.clear();
  std::vector<double> sums = make_finest(finest, matrix, further);
  mg.levels.push_back(std::move(finest));
  for (;;) {
    MultigridLevel& fine = mg.levels.back();
    if (mg.levels.size() > 1) prepare(fine);
    if (fine.diagonal.size() <= coarsest || mg.levels.size() >= 12) break;
    std::int32_t count = 0;
    std::vector<std::int32_t> of = aggregates(fine, count);
    if (count == 0 || static_cast<double>(count) > 0.8 * static_cast<double>(fine.diagonal.size())) break;
    std::vector<double> coarse_sums(count, 0);
    for (std::size_t i = 0; i < of.size(); ++i) coarse_sums[of[i]] += sums[i];
    sums = std::move(coarse_sums);
    MultigridLevel coarse = coarsen(fine, std::move(of), count);
    mg.levels.push_back(std::move(coarse));
  }
  if (mg.levels.back().diagonal.size() <= 4 * coarsest) mg.coarse_inverse = dense_inverse(mg.levels.back(), sums);
}

void apply_multigrid(Multigrid& mg, std::span<const double> r, std::span<double> z) {
  MultigridLevel& l = mg.levels.front();
  const Index n = static_cast<Index>(l.diagonal.size());
  const double scale = largest(r.size(), 0.0, [&](std::size_t i) { return std::abs(r[i]); });
  if (!(scale > 0)) {
    std::fill(z.begin(), z.end(), 0.0);
    return;
  }
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index i = 0; i < n; ++i) l.b[i] = static_cast<float>(r[i] / scale);
  cycle(mg, 0);
#pragma omp parallel for schedule(static) if (n > serial)
  for (Index i = 0; i < n; ++i) z[i] = l.x[i] * scale;
}

}  // namespace sim
