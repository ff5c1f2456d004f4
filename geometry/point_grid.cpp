#include "geometry/point_grid.h"

namespace geometry {

using Eigen::Vector3d;

PointGrid::PointGrid(const std::vector<Vector3d>& points, double radius, const PeriodicBox& box)
    : wraps_(box.active[0] || box.active[1] || box.active[2]),
      radius_(radius),
      box_(box),
      low_(Vector3d::Zero()),
      size_(Vector3d::Constant(radius)),
      count_{1, 1, 1} {
  Vector3d high = Vector3d::Zero();
  if (!points.empty()) low_ = high = box.wrap(points[0]);
  for (const Vector3d& p : points) {
    low_ = low_.cwiseMin(box.wrap(p));
    high = high.cwiseMax(box.wrap(p));
  }
  double cells = 1;
  for (int k = 0; k < 3; ++k) {
    if (box.active[k]) low_[k] = box.min[k], high[k] = box.min[k] + box.length[k];
    const double extent = high[k] - low_[k];
    // A periodic length is divided evenly so that the cells on either side of the seam are neighbours.
    count_[k] = box.active[k] ? std::max(1, int(extent / radius)) : int(std::min(1e6, extent / radius)) + 1;
    cells *= count_[k];
  }
  // A few far-off points must not cost memory: coarsen until there are not many more cells than points.
  while (cells > 4.0 * double(points.size()) + 1000) {
    cells = 1;
    for (int k = 0; k < 3; ++k) cells *= count_[k] = std::max(1, (count_[k] + 1) / 2);
  }
  for (int k = 0; k < 3; ++k) size_[k] = std::max(radius, (high[k] - low_[k]) / count_[k] * (1 + 1e-12));

  std::vector<std::int32_t> cell(points.size());
  start_.assign(std::size_t(count_[0]) * count_[1] * count_[2] + 1, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto home = cell_of(box.wrap(points[i]));
    cell[i] = std::int32_t(home[0] + count_[0] * (home[1] + std::size_t(count_[1]) * home[2]));
    ++start_[cell[i] + 1];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  order_.resize(points.size());
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) order_[next[cell[i]]++] = std::int32_t(i);
  sorted_.resize(points.size());
  for (std::size_t s = 0; s < order_.size(); ++s) sorted_[s] = points[order_[s]];
}

int PointGrid::neighbors_along(int axis, int home, std::array<int, 3>& list) const {
  int size = 0;
  for (int step = -1; step <= 1; ++step) {
    int cell = home + step;
    if (box_.active[axis]) cell = (cell + count_[axis]) % count_[axis];
    if (cell < 0 || cell >= count_[axis]) continue;
    if (std::find(list.begin(), list.begin() + size, cell) == list.begin() + size) list[size++] = cell;
  }
  return size;
}

}  // namespace geometry
