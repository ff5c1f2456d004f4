#include "geometry/leak_path.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace geometry;
using Eigen::Vector3d;

// A square lattice of points with one missing: the widest way through is half a diagonal of the doubled mesh.
TEST(LeakPath, FindsTheHoleInASheet) {
  std::vector<Vector3d> sheet;
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j)
      if (i != 2 || j != 3) sheet.emplace_back(i, j, 0);
  LeakSearch search;
  search.min = {-6, -6, -2};
  search.max = {6, 6, 2};
  search.step = 0.125;
  search.largest = 3;
  search.open = [](const Vector3d&) { return true; };
  search.side = [](const Vector3d& p) { return p.z() < -1.9 ? 1 : p.z() > 1.9 ? 2 : 0; };
  Vector3d where;
  EXPECT_NEAR(widest_path(sheet, search, &where), 1, 0.02);  // the missing point's four neighbours are one away
  EXPECT_NEAR((where - Vector3d(2, 3, 0)).norm(), 0, 0.15);
  sheet.emplace_back(2, 3, 0);
  EXPECT_NEAR(widest_path(sheet, search), std::sqrt(0.5), 0.02);
}

TEST(LeakPath, ClosedRoomHasNoPath) {
  LeakSearch search;
  search.min = {0, 0, 0};
  search.max = {1, 1, 1};
  search.step = 0.1;
  search.largest = 1;
  search.open = [](const Vector3d& p) { return p.z() < 0.45 || p.z() > 0.55; };
  search.side = [](const Vector3d& p) { return p.z() < 0.05 ? 1 : p.z() > 0.95 ? 2 : 0; };
  EXPECT_EQ(widest_path({{9, 9, 9}}, search), 0);
}

}  // namespace
