#include "geometry/voxel_grid.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

TEST(VoxelGrid, InsideMatchesTheSphere) {
  const double radius = 0.01;
  const TriangleMesh sphere = test::make_sphere(radius, 200, 100);
  const VoxelGrid grid = voxelize(sphere, 0.0007);
  std::size_t count = 0;
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int i = 0; i < grid.size[0]; ++i) {
        const double distance = grid.center(i, j, k).norm();
        count += grid.inside[grid.index(i, j, k)];
        if (std::abs(distance - radius) < 2e-5) continue;  // within the chord's sag
        EXPECT_EQ(bool(grid.inside[grid.index(i, j, k)]), distance < radius);
      }
  EXPECT_NEAR(double(count) * std::pow(grid.spacing, 3), 4.18879 * std::pow(radius, 3), 0.02 * 4.18879 * std::pow(radius, 3));
}

// Lattice points exactly on faces, edges and corners: no ray may leak, whichever way they are decided.
TEST(VoxelGrid, PointsOnEdgesNeverLeak) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {4, 4, 4});
  const VoxelGrid grid = voxelize(box, 1.0);
  for (int k = 0; k < grid.size[2]; ++k)
    for (int j = 0; j < grid.size[1]; ++j)
      for (int i = 0; i < grid.size[0]; ++i) {
        const Vector3d p = grid.center(i, j, k);
        const bool strictly_in = p.minCoeff() > 0 && p.maxCoeff() < 4, strictly_out = p.minCoeff() < 0 || p.maxCoeff() > 4;
        if (strictly_in || strictly_out) {
          EXPECT_EQ(bool(grid.inside[grid.index(i, j, k)]), strictly_in);
        }
      }
}

TEST(VoxelGrid, EitherOrientationGivesTheSame) {
  TriangleMesh sphere = test::make_sphere(1, 20, 10);
  const VoxelGrid outward = voxelize(sphere, 0.11);
  for (auto& t : sphere.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(outward.inside, voxelize(sphere, 0.11).inside);
}

TEST(VoxelGrid, DistanceTransformMatchesBruteForce) {
  VoxelGrid grid;
  grid.spacing = 0.5;
  grid.size = {13, 11, 9};
  grid.inside.resize(13 * 11 * 9);
  std::mt19937 random(7);
  for (auto& voxel : grid.inside) voxel = random() % 10 != 0;
  const std::vector<double> distance = distance_transform(grid);
  for (std::size_t a = 0; a < grid.inside.size(); ++a) {
    double nearest = std::numeric_limits<double>::infinity();
    const auto p = grid.coordinates(a);
    for (std::size_t b = 0; b < grid.inside.size(); ++b) {
      if (grid.inside[b]) continue;
      const auto q = grid.coordinates(b);
      nearest = std::min(nearest, (grid.center(p[0], p[1], p[2]) - grid.center(q[0], q[1], q[2])).norm());
    }
    EXPECT_NEAR(distance[a], nearest, 1e-12);
  }
}

TEST(VoxelGrid, KeepsTheLargestPart) {
  TriangleMesh mesh = test::make_box({0, 0, 0}, {6, 6, 6});
  test::append(mesh, test::make_box({0, 0, 0}, {2, 2, 2}), {9, 0, 0});
  VoxelGrid grid = voxelize(mesh, 0.45);
  const auto before = std::count(grid.inside.begin(), grid.inside.end(), 1);
  const std::size_t gone = keep_largest_part(grid);
  EXPECT_GT(gone, 30u);
  EXPECT_EQ(std::size_t(before - std::count(grid.inside.begin(), grid.inside.end(), 1)), gone);
  const auto small = grid.nearest({10, 1, 1});
  EXPECT_FALSE(grid.inside[grid.index(small[0], small[1], small[2])]);
}

}  // namespace
