// Points in uniform cells (hashed, counting sort): all points within a radius of a place, in increasing row order within a cell.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/particles.h"

namespace sim {

template <int D>
class PointGrid {
 public:
  // cell: m, > 0; a search visits the cells that its ball touches.
  PointGrid(std::span<const Vector<D>> points, double cell) : points_(points.begin(), points.end()), cell_(cell) {
    std::size_t buckets = 16;
    while (buckets < 2 * points_.size()) buckets *= 2;
    start_.assign(buckets + 1, 0);
    std::vector<std::uint32_t> key(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) ++start_[(key[i] = bucket(cell_of(points_[i]))) + 1];
    for (std::size_t b = 0; b < buckets; ++b) start_[b + 1] += start_[b];
    order_.resize(points_.size());
    auto next = start_;
    for (std::size_t i = 0; i < points_.size(); ++i) order_[next[key[i]]++] = static_cast<std::int32_t>(i);
  }

  // visit(row, squared distance) for every point within `radius` of x.
  template <class Visit>
  void for_each_near(const Vector<D>& x, double radius, Visit&& visit) const {
    const Cell low = cell_of(x - Vector<D>::Constant(radius)), high = cell_of(x + Vector<D>::Constant(radius));
    Cell c = low;
    for (;;) {
      const std::uint32_t b = bucket(c);
      for (std::uint32_t k = start_[b]; k < start_[b + 1]; ++k) {
        const std::int32_t row = order_[k];
        const double squared = (points_[row] - x).squaredNorm();
        if (squared <= radius * radius && cell_of(points_[row]) == c) visit(row, squared);  // a bucket may hold several cells
      }
      int axis = 0;
      while (axis < D && ++c[axis] > high[axis]) c[axis] = low[axis], ++axis;
      if (axis == D) return;
    }
  }

 private:
  using Cell = Eigen::Matrix<std::int64_t, D, 1>;
  Cell cell_of(const Vector<D>& x) const {
    Cell c;
    for (int k = 0; k < D; ++k) c[k] = static_cast<std::int64_t>(std::floor(x[k] / cell_));
    return c;
  }
  std::uint32_t bucket(const Cell& c) const {
    std::uint64_t h = 0;
    for (int k = 0; k < D; ++k) h = (h ^ static_cast<std::uint64_t>(c[k])) * 0x9E3779B97F4A7C15ull;
    return static_cast<std::uint32_t>((h >> 32) & (start_.size() - 2));
  }

  std::vector<Vector<D>> points_;
  double cell_;
  std::vector<std::uint32_t> start_;
  std::vector<std::int32_t> order_;
};

}  // namespace sim
