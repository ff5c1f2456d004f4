#include "sim/solid_neighbors.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sim {

namespace {

template <int D>
using Cell = std::array<std::int64_t, D>;

template <int D>
Cell<D> cell_of(const Vector<D>& x, double size) {
  Cell<D> cell;
  for (int k = 0; k < D; ++k) cell[k] = static_cast<std::int64_t>(std::floor(x(k) / size));
  return cell;
}

}  // namespace

template <int D>
NeighborTable points_within(std::span<const Vector<D>> queries, std::span<const Vector<D>> points, double radius) {
  std::vector<std::pair<Cell<D>, std::int32_t>> sorted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sorted[i] = {cell_of<D>(points[i], radius), static_cast<std::int32_t>(i)};
  std::sort(sorted.begin(), sorted.end());

  NeighborTable table;
  table.begin.assign(queries.size() + 1, 0);
  std::vector<std::vector<std::int32_t>> found(queries.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(queries.size()); ++i) {
    const Cell<D> center = cell_of<D>(queries[i], radius);
    int columns = 1;
    for (int k = 1; k < D; ++k) columns *= 3;
    for (int column = 0; column < 3 * columns; ++column) {
      Cell<D> cell = center;
      for (int k = 0, rest = column; k < D; ++k, rest /= 3) cell[k] += rest % 3 - 1;
      auto it = std::lower_bound(sorted.begin(), sorted.end(), std::pair<Cell<D>, std::int32_t>{cell, -1});
      for (; it != sorted.end() && it->first == cell; ++it)
        if ((points[it->second] - queries[i]).squaredNorm() < radius * radius) found[i].push_back(it->second);
    }
    std::sort(found[i].begin(), found[i].end());
  }
  for (std::size_t i = 0; i < queries.size(); ++i) {
    table.begin[i + 1] = table.begin[i] + static_cast<std::int64_t>(found[i].size());
    table.index.insert(table.index.end(), found[i].begin(), found[i].end());
  }
  return table;
}

template NeighborTable points_within<2>(std::span<const Vector<2>>, std::span<const Vector<2>>, double);
template NeighborTable points_within<3>(std::span<const Vector<3>>, std::span<const Vector<3>>, double);

}  // namespace sim
