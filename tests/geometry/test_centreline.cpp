#include "geometry/centreline.h"

#include <gtest/gtest.h>

#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

// A quarter of a torus, capped: the centreline is known.
TriangleMesh bent_tube(double bend, double radius) {
  TriangleMesh mesh = test::make_cylinder(radius, 1, 48, 60, true);
  for (Vector3d& v : mesh.vertices) {
    const double angle = v.z() * std::numbers::pi / 2, r = bend + v.x();
    v = {r * std::cos(angle), v.y(), r * std::sin(angle)};
  }
  return mesh;
}

TEST(Centreline, KeepsToTheMiddleOfABend) {
  const double bend = 0.04, radius = 0.01;
  const LumenField field = make_lumen_field(bent_tube(bend, radius));
  EXPECT_NEAR(field.largest_bore(), 2 * radius, 1.5 * field.grid.spacing);
  const Centreline line = trace_centreline(field, {bend, 0, 0}, {0, 0, bend});
  ASSERT_GT(line.size(), 20u);
  EXPECT_NEAR(line.arc.back(), bend * std::numbers::pi / 2, 0.05 * line.arc.back());
  for (std::size_t i = 0; i < line.size(); ++i) {
    EXPECT_NEAR(std::hypot(line.points[i].x(), line.points[i].z()), bend, 0.12 * radius);
    EXPECT_NEAR(line.points[i].y(), 0, 0.1 * radius);
    if (i > 5 && i + 6 < line.size()) {
      EXPECT_GT(line.tangents[i].dot(Vector3d(-line.points[i].z(), 0, line.points[i].x()).normalized()), 0.98);
    }
  }
}

TEST(Centreline, FindsTheEndsOfABranchedVessel) {
  // A cross of two boxes: four ends.
  TriangleMesh mesh = test::make_box({-0.04, -0.005, -0.005}, {0.04, 0.005, 0.005});
  const LumenField straight = make_lumen_field(mesh, 2e4);
  EXPECT_EQ(find_far_ends(straight).size(), 2u);
  LumenField field = straight;
  field.grid.origin = {-0.045, -0.045, -0.01};
  field.grid.spacing = 0.001;
  field.grid.size = {91, 91, 21};
  field.grid.inside.assign(91 * 91 * 21, 0);
  for (int k = 0; k < 21; ++k)
    for (int j = 0; j < 91; ++j)
      for (int i = 0; i < 91; ++i) {
        const Vector3d p = field.grid.center(i, j, k);
        const bool across = std::abs(p.x()) < 0.04 && std::abs(p.y()) < 0.005, along = std::abs(p.y()) < 0.035 && std::abs(p.x()) < 0.005;
        field.grid.inside[field.grid.index(i, j, k)] = std::abs(p.z()) < 0.005 && (across || along);
      }
  field.distance = distance_transform(field.grid);
  EXPECT_EQ(find_far_ends(field).size(), 4u);
  EXPECT_NEAR(geodesic_distance(field, {0.038, 0, 0}, {0, 0.033, 0}), 0.066, 0.012);
  EXPECT_TRUE(std::isinf(geodesic_distance(field, {0.2, 0.2, 0.2}, {0, 0, 0})));
}

TEST(Centreline, ResamplesInEvenSteps) {
  const Centreline line = resample_centreline({{0, 0, 0}, {1, 0, 0}, {1, 3, 0}}, 0.5);
  ASSERT_EQ(line.size(), 9u);
  EXPECT_NEAR((line.points[3] - Vector3d(1, 0.5, 0)).norm(), 0, 1e-12);
  EXPECT_DOUBLE_EQ(line.arc.back(), 4);
}

}  // namespace
