#include "geometry/point_grid.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace {

using namespace geometry;
using Eigen::Vector3d;

void expect_same_as_brute_force(const PeriodicBox& box, double radius) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<Vector3d> points;
  for (int i = 0; i < 400; ++i) points.emplace_back(place(random), place(random), 0.3 * place(random));
  const PointGrid grid(points, radius, box);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d at(1.4 * place(random) - 0.2, place(random), 0.3 * place(random));
    std::set<std::size_t> found, expected;
    grid.for_each_near(at, [&](std::size_t i, const Vector3d& arm, double d2) {
      EXPECT_TRUE(found.insert(i).second);
      EXPECT_NEAR(arm.squaredNorm(), d2, 1e-15);
    });
    for (std::size_t i = 0; i < points.size(); ++i)
      if (box.nearest_image(points[i] - at).norm() <= radius) expected.insert(i);
    EXPECT_EQ(found, expected);
  }
}

TEST(PointGrid, FindsAllNeighbours) { expect_same_as_brute_force({}, 0.17); }

TEST(PointGrid, WrapsPeriodicDirections) {
  PeriodicBox box;
  box.active = {true, false, false};
  expect_same_as_brute_force(box, 0.23);
  expect_same_as_brute_force(box, 0.45);  // only two cells along the period
}

}  // namespace
