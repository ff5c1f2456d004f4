#include "geometry/signed_distance_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace {

using namespace geometry;
using Eigen::Vector3d;

TriangleMesh box_mesh(const Vector3d& a, const Vector3d& b) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i & 1 ? b.x() : a.x(), i & 2 ? b.y() : a.y(), i & 4 ? b.z() : a.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh sphere_mesh(double radius, int rings, int sectors) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, radius);
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / sectors;
      mesh.vertices.emplace_back(radius * std::sin(a) * std::cos(b), radius * std::sin(a) * std::sin(b), radius * std::cos(a));
    }
  mesh.vertices.emplace_back(0, 0, -radius);
  const auto at = [&](int i, int j) { return 1 + (i - 1) * sectors + j % sectors; };
  const int south = int(mesh.vertices.size()) - 1;
  for (int j = 0; j < sectors; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({south, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(SignedDistanceGrid, PointToTriangleMatchesDenseSampling) {
  const Vector3d a(0, 0, 0), b(2, 0, 0.5), c(0.5, 1.5, 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-2, 3);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d p(place(random), place(random), place(random));
    double nearest = 1e9;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; i + j <= 200; ++j) nearest = std::min(nearest, (p - (a + (b - a) * (i / 200.0) + (c - a) * (j / 200.0))).norm());
    Vector3d foot;
    const double distance = std::sqrt(squared_distance_to_triangle(p, a, b, c, &foot));
    EXPECT_NEAR(distance, nearest, 0.02);
    EXPECT_LE(distance, nearest + 1e-12);
    EXPECT_NEAR((p - foot).norm(), distance, 1e-12);
  }
}

TEST(SignedDistanceGrid, BoxOfTwelveTrianglesIsExactAwayFromEdges) {
  const SignedDistanceGrid grid(box_mesh({0, 0, 0}, {1, 2, 3}), 0.05, 0.4);
  EXPECT_NEAR(grid.distance({0.5, 1, 0.1}), -0.1, 1e-6);
  EXPECT_NEAR(grid.distance({1.23, 1, 1.5}), 0.23, 1e-6);
  EXPECT_LE(grid.distance({0.5, 1, 1.5}), -0.39);
  EXPECT_GE(grid.distance({5, 1, 1}), 3.9);
}

TEST(SignedDistanceGrid, SignIsRightOnLatticePointsThatLieOnEdgesAndDiagonals) {
  // Grid lines pass exactly through the box's faces, edges and face diagonals.
  const SignedDistanceGrid grid(box_mesh({0, 0, 0}, {1, 1, 1}), 0.125, 0.25);
  for (double x : {-0.25, -0.125, 0.125, 0.5, 0.875, 1.125})
    for (double y : {-0.25, 0.25, 0.5, 0.75, 1.125})
      for (double z : {-0.125, 0.125, 0.5, 0.875, 1.25}) {
        const bool inside = x > 0 && x < 1 && y > 0 && y < 1 && z > 0 && z < 1;
        EXPECT_EQ(grid.distance({x, y, z}) < 0, inside) << x << " " << y << " " << z;
      }
}

TEST(SignedDistanceGrid, SphereWithinTheSquareOfTheGridSpacing) {
  TriangleMesh mesh = sphere_mesh(1, 120, 240);
  const double h = 0.05;
  const SignedDistanceGrid grid(mesh, h, 0.3);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const SignedDistanceGrid turned(mesh, h, 0.3);  // oriented inward: the same inside
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-1.2, 1.2);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3d p(place(random), place(random), place(random));
    const double exact = p.norm() - 1;
    if (std::abs(exact) > 0.25) continue;
    EXPECT_NEAR(grid.distance(p), exact, 0.5 * h * h + 4e-4);
    EXPECT_EQ(grid.distance(p), turned.distance(p));
  }
}

TEST(SignedDistanceGrid, EnclosedVolumeOfABox) { EXPECT_NEAR(enclosed_volume(box_mesh({1, 1, 1}, {2, 3, 4})), 6, 1e-12); }

}  // namespace
