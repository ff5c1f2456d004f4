#include "geometry/triangle_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/mesh_makers.h"
#include "geometry/signed_distance_grid.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

TEST(TriangleTree, RaysMeetTheSphereWhereTheyShould) {
  const TriangleTree tree(test::make_sphere(1, 240, 120));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 300; ++n) {
    const Vector3d from = 0.5 * Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Vector3d direction = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const double b = from.dot(direction), expected = -b + std::sqrt(b * b + 1 - from.squaredNorm());
    EXPECT_NEAR(tree.first_hit(from, direction), expected, 1e-3);
  }
  EXPECT_TRUE(std::isinf(tree.first_hit({2, 0, 0}, {1, 0, 0})));
  EXPECT_NEAR(tree.first_hit({-2, 0.01, 0.02}, {1, 0, 0}, 1.5), 3, 2e-3);  // beyond the near side
}

TEST(TriangleTree, DistanceMatchesBruteForceAndContainsTheSphere) {
  const TriangleMesh mesh = test::make_sphere(1, 30, 15);
  const TriangleTree tree(mesh);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int n = 0; n < 200; ++n) {
    const Vector3d p(uniform(random), uniform(random), uniform(random));
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : mesh.triangles)
      nearest = std::min(nearest, squared_distance_to_triangle(p, mesh.vertices[std::size_t(t[0])], mesh.vertices[std::size_t(t[1])],
                                                               mesh.vertices[std::size_t(t[2])]));
    EXPECT_NEAR(tree.distance(p), std::sqrt(nearest), 1e-12);
    if (std::abs(p.norm() - 1) > 0.03) {
      EXPECT_EQ(tree.contains(p), p.norm() < 1);
    }
  }
}

}  // namespace
