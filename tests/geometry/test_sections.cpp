#include "geometry/sections.h"

#include <gtest/gtest.h>

#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;
using std::numbers::pi;

TEST(Sections, ObliqueCutOfACylinderIsAnEllipse) {
  const TriangleMesh tube = test::make_cylinder(1, 10, 200, 200);
  const double tilt = 0.6;
  const Vector3d normal(std::sin(tilt), 0, std::cos(tilt));
  const Section section = section_around(tube, {0.3, 0.2, 5}, normal);
  ASSERT_FALSE(section.contour.empty());
  EXPECT_NEAR(section.area, pi / std::cos(tilt), 2e-3);
  EXPECT_NEAR(section.largest_width, 2 / std::cos(tilt), 2e-3);
  EXPECT_NEAR(section.perpendicular_width, 2, 2e-3);
  EXPECT_NEAR((section.center - Vector3d(0, 0, 5 + 0.3 * std::tan(tilt))).norm(), 0, 1e-3);
  EXPECT_NEAR(section.diameter(), 2 / std::sqrt(std::cos(tilt)), 2e-3);
}

TEST(Sections, PicksTheContourRoundThePoint) {
  TriangleMesh mesh = test::make_cylinder(1, 10);
  test::append(mesh, test::make_cylinder(3, 10));               // round the first
  test::append(mesh, test::make_cylinder(1.5, 10), {9, 0, 0});  // beside it
  EXPECT_EQ(cut_sections(mesh, {0, 0, 5.1}, {0, 0, 1}).size(), 3u);
  EXPECT_NEAR(section_around(mesh, {0, 0, 5.1}, {0, 0, 1}).diameter(), 2, 0.02);
  EXPECT_NEAR(section_around(mesh, {2, 0, 5.1}, {0, 0, 1}).diameter(), 6, 0.05);
  EXPECT_NEAR(section_around(mesh, {9, 1, 5.1}, {0, 0, 1}).diameter(), 3, 0.02);
  EXPECT_TRUE(section_around(mesh, {5, 5, 5.1}, {0, 0, 1}).contour.empty());
}

TEST(Sections, CutsThroughVerticesAndLeavesOutOpenContours) {
  TriangleMesh tube = test::make_cylinder(1, 10, 40, 10);
  EXPECT_NEAR(section_around(tube, {0, 0, 5}, {0, 0, 1}).area, 20 * std::sin(2 * pi / 40), 1e-9);  // exactly on a ring of vertices
  tube.triangles.erase(tube.triangles.begin() + 400);                                              // ring 5, first face
  EXPECT_TRUE(section_around(tube, {0, 0, 5.5}, {0, 0, 1}).contour.empty());
}

TEST(Sections, RadiiFollowTheShape) {
  auto radius = [](double theta, double) { return 1 + 0.1 * std::cos(3 * theta); };
  const Section section = section_around(test::make_tube(radius, 0, 4, 360, 8, false), {0, 0, 2.2}, {0, 0, 1});
  const std::vector<double> r = section_radii(section, {0, 0, 2.2}, {1, 0, 0}, {0, 1, 0}, 90);
  ASSERT_EQ(r.size(), 90u);
  for (int i = 0; i < 90; ++i) EXPECT_NEAR(r[std::size_t(i)], radius(2 * pi * i / 90, 0), 3e-4);
}

}  // namespace
