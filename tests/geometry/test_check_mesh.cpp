#include "geometry/check_mesh.h"

#include <gtest/gtest.h>

#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

TriangleMesh split_corners(const TriangleMesh& mesh) {
  TriangleMesh out;
  for (const auto& t : mesh.triangles) {
    const auto first = std::int32_t(out.vertices.size());
    for (std::int32_t v : t) out.vertices.push_back(mesh.vertices[std::size_t(v)]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TEST(CheckMesh, WeldingJoinsSplitCorners) {
  TriangleMesh mesh = split_corners(test::make_box({0, 0, 0}, {1, 2, 3}));
  EXPECT_EQ(measure_topology(mesh).border_edges, 36u);
  EXPECT_EQ(weld_vertices(mesh), 36u - 8u);
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_NEAR(signed_volume(mesh), 6, 1e-12);
  EXPECT_NEAR(surface_area(mesh), 22, 1e-12);
}

TEST(CheckMesh, WeldingWithinAToleranceReachesAcrossCells) {
  TriangleMesh mesh = split_corners(test::make_box({0, 0, 0}, {1, 1, 1}));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertices[v].x() += (v % 2 ? 4e-7 : -4e-7);
  TriangleMesh exact = mesh;
  weld_vertices(exact);
  EXPECT_GT(exact.vertices.size(), 8u);
  weld_vertices(mesh, 1e-6);
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_TRUE(measure_topology(mesh).closed());
}

TEST(CheckMesh, CountsBordersComponentsAndWrongSides) {
  TriangleMesh mesh = test::make_box({0, 0, 0}, {1, 1, 1});
  mesh.triangles.pop_back();
  EXPECT_EQ(measure_topology(mesh).border_edges, 3u);
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_EQ(measure_topology(mesh).mismatched_edges, 3u);
  test::append(mesh, test::make_box({0, 0, 0}, {1, 1, 1}), {5, 0, 0});
  EXPECT_EQ(measure_topology(mesh).components, 2u);
}

TEST(CheckMesh, FindsNonManifoldEdges) {
  TriangleMesh mesh = test::make_box({0, 0, 0}, {1, 1, 1});
  mesh.vertices.emplace_back(2, 2, 2);
  mesh.triangles.push_back({0, 1, 8});  // a fin on the edge 0-1
  const MeshTopology topology = measure_topology(mesh);
  EXPECT_EQ(topology.non_manifold_edges, 1u);
  EXPECT_TRUE(topology.non_manifold_at == mesh.vertices[0] || topology.non_manifold_at == mesh.vertices[1]);
}

TEST(CheckMesh, FindsCrossingTrianglesOnly) {
  TriangleMesh clean = test::make_sphere(1);
  EXPECT_TRUE(self_intersections(clean).empty());
  // A triangle through the box's top face: it crosses that face's triangles and no others.
  TriangleMesh mesh = test::make_box({0, 0, 0}, {1, 1, 1});
  TriangleMesh blade;
  blade.vertices = {{0.2, 0.3, 0.5}, {0.4, 0.35, 0.5}, {0.3, 0.3, 1.5}};
  blade.triangles = {{0, 1, 2}};
  test::append(mesh, blade);
  const auto pairs = self_intersections(mesh);
  ASSERT_FALSE(pairs.empty());
  for (const auto& pair : pairs) {
    EXPECT_EQ(pair[1], 12);
    for (std::int32_t v : mesh.triangles[std::size_t(pair[0])]) EXPECT_EQ(mesh.vertices[std::size_t(v)].z(), 1);
  }
}

TEST(CheckMesh, FindsFacesFoldedOntoEachOther) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.5, 0}, {0.5, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(self_intersections(mesh).size(), 1u);
  mesh.triangles = {{0, 1, 2}, {1, 0, 4}};
  EXPECT_TRUE(self_intersections(mesh).empty());
}

}  // namespace
