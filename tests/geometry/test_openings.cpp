#include "geometry/openings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/check_mesh.h"
#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;
using std::numbers::pi;

std::vector<Vector3d> points_of(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop) {
  std::vector<Vector3d> points;
  for (std::int32_t v : loop) points.push_back(mesh.vertices[std::size_t(v)]);
  return points;
}

TEST(Openings, MeasuresACylindersEnds) {
  const TriangleMesh tube = test::make_cylinder(0.012, 0.05, 96);
  const auto loops = border_loops(tube);
  ASSERT_EQ(loops.size(), 2u);
  for (const auto& loop : loops) {
    EXPECT_EQ(loop.size(), 96u);
    const OpenEnd end = measure_loop(points_of(tube, loop));
    const bool top = end.center.z() > 0.025;
    EXPECT_NEAR((end.center - Vector3d(0, 0, top ? 0.05 : 0)).norm(), 0, 1e-12);
    EXPECT_NEAR(end.normal.z(), top ? 1 : -1, 1e-12);
    EXPECT_NEAR(end.area, 48 * std::sin(2 * pi / 96) * 0.012 * 0.012, 1e-12);
    EXPECT_NEAR(end.radius_max, 0.012, 1e-12);
    EXPECT_TRUE(is_vessel_end(tube, loop, 0.002));
    EXPECT_FALSE(is_vessel_end(tube, loop, 0.03));
  }
}

TEST(Openings, AHoleInTheWallIsNoEnd) {
  TriangleMesh tube = test::make_cylinder(0.012, 0.05, 48, 48);
  // A window of 6 x 6 quads in the wall's side.
  std::vector<std::array<std::int32_t, 3>> kept;
  for (std::size_t t = 0; t < tube.triangles.size(); ++t) {
    const int quad = int(t / 2), k = quad / 48, i = quad % 48;
    if (!(k >= 20 && k < 26 && i >= 10 && i < 16)) kept.push_back(tube.triangles[t]);
  }
  tube.triangles = kept;
  int holes = 0;
  for (const auto& loop : border_loops(tube)) holes += !is_vessel_end(tube, loop, 0.002);
  EXPECT_EQ(holes, 1);
}

TEST(Openings, LoopsThatTouchComeApart) {
  TriangleMesh mesh;  // a 3 x 3 grid of squares without the two that touch at one corner
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) mesh.vertices.emplace_back(i, j, 0);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      if ((i == 1 && j == 1) || (i == 2 && j == 2)) continue;
      const std::int32_t a = 5 * j + i;
      mesh.triangles.push_back({a, a + 1, a + 6});
      mesh.triangles.push_back({a, a + 6, a + 5});
    }
  std::vector<std::size_t> sizes;
  for (const auto& loop : border_loops(mesh)) sizes.push_back(loop.size());
  std::sort(sizes.begin(), sizes.end());
  EXPECT_EQ(sizes, (std::vector<std::size_t>{4, 4, 16}));
}

TEST(Openings, CapsAreFlatClosedAndOutward) {
  // A bean-shaped end: ear clipping must stay inside it.
  auto radius = [](double theta, double) { return 0.01 * (1 + 0.45 * std::cos(2 * theta)); };
  TriangleMesh tube = test::make_tube(radius, 0, 0.04, 120, 10, false);
  const double wall = surface_area(tube);
  double ends = 0;
  for (const auto& loop : border_loops(tube)) {
    ends += measure_loop(points_of(tube, loop)).area;
    EXPECT_EQ(cap_loop(tube, loop), loop.size() - 2);
  }
  EXPECT_TRUE(measure_topology(tube).closed());
  EXPECT_EQ(measure_topology(tube).mismatched_edges, 0u);
  EXPECT_NEAR(surface_area(tube) - wall, ends, 1e-9 * ends);  // no ear outside the rim, none twice
  EXPECT_NEAR(signed_volume(tube), ends / 2 * 0.04, 1e-12);
}

TEST(Openings, FindsFlatCapsButNotADome) {
  const TriangleMesh tube = test::make_cylinder(0.012, 0.05, 60, 30, true);
  const auto caps = find_flat_caps(tube, 0.005);
  ASSERT_EQ(caps.size(), 2u);
  for (const OpenEnd& cap : caps) {
    EXPECT_FALSE(cap.open_in_file);
    EXPECT_NEAR(2 * cap.radius, 0.024, 2e-4);
    EXPECT_NEAR(std::abs(cap.normal.z()), 1, 1e-9);
    EXPECT_GT(cap.normal.z() * (cap.center.z() - 0.025), 0);
  }
  EXPECT_TRUE(find_flat_caps(test::make_sphere(0.012), 0.002).empty());
}

}  // namespace
