// Points sorted into cubic cells: all points near a place, in an order that depends on the points alone. Periodic directions wrap.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace geometry {

// Directions in which space repeats; lengths in m.
struct PeriodicBox {
  std::array<bool, 3> active{};
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), length = Eigen::Vector3d::Ones();
  // The shortest of the equivalent arms from one point to another.
  Eigen::Vector3d nearest_image(Eigen::Vector3d arm) const {
    for (int k = 0; k < 3; ++k)
      if (active[k]) arm[k] -= length[k] * std::round(arm[k] / length[k]);
    return arm;
  }
  Eigen::Vector3d wrap(Eigen::Vector3d point) const {
    for (int k = 0; k < 3; ++k)
      if (active[k]) point[k] -= length[k] * std::floor((point[k] - min[k]) / length[k]);
    return point;
  }
};

class PointGrid {
 public:
  // `radius` m: the largest distance asked for later. Keeps a copy of `points`, sorted.
  PointGrid(const std::vector<Eigen::Vector3d>& points, double radius, const PeriodicBox& box = {});

  // visit(index, arm = points[index] - place (nearest image), squared distance) for every point within the radius.
  template <class Visit>
  void for_each_near(const Eigen::Vector3d& place, Visit&& visit) const {
    const std::array<int, 3> home = cell_of(box_.wrap(place));
    std::array<std::array<int, 3>, 3> range;
    std::array<int, 3> ranges;
    for (int k = 0; k < 3; ++k) ranges[k] = neighbors_along(k, home[k], range[k]);
    for (int c = 0; c < ranges[2]; ++c)
      for (int b = 0; b < ranges[1]; ++b)
        for (int a = 0; a < ranges[0]; ++a) {
          const std::size_t cell = range[0][a] + count_[0] * (range[1][b] + std::size_t(count_[1]) * range[2][c]);
          for (std::int32_t s = start_[cell]; s < start_[cell + 1]; ++s) {
            Eigen::Vector3d arm = sorted_[s] - place;
            if (wraps_) arm = box_.nearest_image(arm);
            const double d2 = arm.squaredNorm();
            if (d2 <= radius_ * radius_) visit(std::size_t(order_[s]), arm, d2);
          }
        }
  }

 private:
  std::array<int, 3> cell_of(const Eigen::Vector3d& point) const {
    std::array<int, 3> cell;
    for (int k = 0; k < 3; ++k) cell[k] = std::clamp(int(std::floor((point[k] - low_[k]) / size_[k])), 0, count_[k] - 1);
    return cell;
  }
  int neighbors_along(int axis, int home, std::array<int, 3>& list) const;

  std::vector<Eigen::Vector3d> sorted_;
  bool wraps_;
  double radius_;
  PeriodicBox box_;
  Eigen::Vector3d low_, size_;
  std::array<int, 3> count_;
  std::vector<std::int32_t> start_, order_;
};

}  // namespace geometry
