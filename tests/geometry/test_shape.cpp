#include "geometry/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

namespace {

using namespace geometry;
using Eigen::Vector2d;
using Eigen::Vector3d;

TEST(Shape, BoxDistanceIsThatToFaceEdgeAndCorner) {
  const Shape box = box_shape({0, 0, 0}, {2, 4, 6});
  EXPECT_DOUBLE_EQ(signed_distance(box, {0.5, 2, 3}, 3), -0.5);
  EXPECT_DOUBLE_EQ(signed_distance(box, {-1, 2, 3}, 3), 1);
  EXPECT_DOUBLE_EQ(signed_distance(box, {-3, -4, 3}, 3), 5);
  EXPECT_DOUBLE_EQ(signed_distance(box, {-1, -2, -2}, 3), 3);
  EXPECT_DOUBLE_EQ(signed_distance(box, {0.5, 2, 99}, 2), -0.5);  // z does not count in 2-D
}

TEST(Shape, SphereIsADiscInTwoDimensions) {
  const Shape ball = sphere_shape({1, 0, 5}, 2);
  EXPECT_DOUBLE_EQ(signed_distance(ball, {1, 0, 8}, 3), 1);
  EXPECT_DOUBLE_EQ(signed_distance(ball, {4, 4, 0}, 2), 3);
}

TEST(Shape, TubeMeasuresToWallsAndEnds) {
  const Shape tube = cylinder_shape({0, 0, 0}, {10, 0, 0}, 3, 2);
  EXPECT_NEAR(signed_distance(tube, {5, 2.6, 0}, 3), -0.4, 1e-12);
  EXPECT_NEAR(signed_distance(tube, {5, 0, 0}, 3), 2, 1e-12);
  EXPECT_NEAR(signed_distance(tube, {0.1, 0, 2.5}, 3), -0.1, 1e-12);
  EXPECT_NEAR(signed_distance(tube, {-3, 0, 7}, 3), 5, 1e-12);
  const Shape ring = cylinder_shape({0, 0, 0}, {0, 0, 1}, 3, 2);
  EXPECT_NEAR(signed_distance(ring, {2.4, 0, 0}, 2), -0.4, 1e-12);  // along z: a ring without ends
}

// Oracle: the distance to a polygon's boundary by many points on it, the sign by summed turning angle.
TEST(Shape, PolygonMatchesBruteForce) {
  const std::vector<Vector2d> corners{{0, 0}, {3, 0}, {3, 2}, {1, 1}, {0, 3}};
  const Shape polygon = polygon_shape(corners);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 4);
  for (int trial = 0; trial < 300; ++trial) {
    const Vector2d point(place(random), place(random));
    double nearest = 1e9, turn = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d a = corners[i], b = corners[(i + 1) % corners.size()];
      for (int s = 0; s <= 2000; ++s) nearest = std::min(nearest, (a + (b - a) * s / 2000.0 - point).norm());
      const Vector2d p = a - point, q = b - point;
      turn += std::atan2(p.x() * q.y() - p.y() * q.x(), p.dot(q));
    }
    if (nearest < 2e-3) continue;
    const double sign = std::abs(turn) > std::numbers::pi ? -1 : 1;
    EXPECT_NEAR(signed_distance(polygon, {point.x(), point.y(), 0}, 2), sign * nearest, 2e-3);
  }
}

TEST(Shape, ExtrudedPolygonIsAPrism) {
  const Shape prism = polygon_shape({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, 1, 4);
  const Shape box = box_shape({0, 0, 1}, {2, 2, 4});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-2, 6);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d point(place(random), place(random), place(random));
    EXPECT_NEAR(signed_distance(prism, point, 3), signed_distance(box, point, 3), 1e-12);
  }
}

TEST(Shape, SubtractAndIntersectCombineInsides) {
  Shape shape = box_shape({0, 0, 0}, {2, 2, 2});
  shape.subtract = {sphere_shape({0, 0, 0}, 1)};
  shape.intersect = {sphere_shape({1, 1, 1}, 1.2)};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.5, 2.5);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d p(place(random), place(random), place(random));
    const bool expected = (p.array() > 0).all() && (p.array() < 2).all() && p.norm() > 1 && (p - Vector3d::Ones()).norm() < 1.2;
    EXPECT_EQ(contains(shape, p, 3), expected);
  }
  EXPECT_NEAR(signed_distance(shape, {0.8, 0.8, 0.2}, 3), -std::min(std::sqrt(0.64 + 0.64 + 0.04) - 1, 0.2), 1e-12);
}

TEST(Shape, GradientPointsOutward) {
  const Vector3d way = distance_gradient(sphere_shape({0, 0, 0}, 1), {0.6, 0.8, 0}, 3, 1e-4);
  EXPECT_NEAR((way - Vector3d(0.6, 0.8, 0)).norm(), 0, 1e-6);
}

TEST(Shape, BoundingBoxEncloses) {
  const BoundingBox box = bounding_box(cylinder_shape({0, 0, 0}, {3, 4, 0}, 1), 3);
  EXPECT_NEAR((box.min - Vector3d(-0.8, -0.6, -1)).norm(), 0, 1e-12);
  EXPECT_NEAR((box.max - Vector3d(3.8, 4.6, 1)).norm(), 0, 1e-12);
}

TEST(Shape, ImpossibleShapesAreRefusedWithTheirName) {
  const auto message = [](const Shape& shape, int dimension) {
    try {
      check_shape(shape, dimension, "body \"a\"");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(message(box_shape({0, 1, 0}, {1, 1, 1}), 3).find("body \"a\": box has min >= max along y"), std::string::npos);
  EXPECT_NE(message(sphere_shape({0, 0, 0}, -1), 3).find("radius -1"), std::string::npos);
  EXPECT_NE(message(cylinder_shape({0, 0, 0}, {1, 0, 0}, 1, 2), 3).find("inner_radius"), std::string::npos);
  EXPECT_NE(message(polygon_shape({{0, 0}, {1, 0}}), 2).find("three points"), std::string::npos);
  EXPECT_EQ(message(box_shape({0, 0, 0}, {1, 1, 0}), 2), "accepted");
  Shape nested = box_shape({0, 0, 0}, {1, 1, 1});
  nested.subtract = {sphere_shape({0, 0, 0}, 0)};
  EXPECT_NE(message(nested, 3).find("subtract"), std::string::npos);
}

TEST(Shape, OpenMeshHasNoInside) {
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh->triangles = {{0, 1, 2}};
  EXPECT_THROW(mesh_shape(mesh, 0.1), std::runtime_error);
}

}  // namespace
