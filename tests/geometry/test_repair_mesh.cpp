#include "geometry/repair_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/double_wall.h"
#include "geometry/mesh_makers.h"
#include "geometry/openings.h"
#include "geometry/triangle_tree.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

const Defect* find_defect(const RepairReport& report, const std::string& kind) {
  const auto found = std::find_if(report.defects.begin(), report.defects.end(), [&](const Defect& d) { return d.kind == kind; });
  return found == report.defects.end() ? nullptr : &*found;
}

TriangleMesh open_vessel() { return test::make_cylinder(0.012, 0.06, 48, 48); }

TEST(RepairMesh, LeavesACleanVesselAlone) {
  TriangleMesh mesh = open_vessel();
  const RepairReport report = repair_mesh(mesh);
  EXPECT_TRUE(report.defects.empty());
  EXPECT_EQ(report.moved, 0);
  EXPECT_EQ(mesh.vertices, open_vessel().vertices);
  EXPECT_EQ(mesh.triangles, open_vessel().triangles);
}

TEST(RepairMesh, ClosesAHoleInTheWallAndSaysWhere) {
  TriangleMesh mesh = open_vessel();
  std::vector<std::array<std::int32_t, 3>> kept;
  Vector3d hole = Vector3d::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int k = int(t / 2) / 48, i = int(t / 2) % 48;
    if (k >= 20 && k < 24 && i >= 10 && i < 14)
      hole += mesh.vertices[std::size_t(mesh.triangles[t][0])] / 32;
    else
      kept.push_back(mesh.triangles[t]);
  }
  mesh.triangles = kept;
  const RepairReport report = repair_mesh(mesh);
  const Defect* defect = find_defect(report, "holes");
  ASSERT_NE(defect, nullptr);
  EXPECT_EQ(defect->count, 1u);
  EXPECT_TRUE(defect->repaired);
  EXPECT_LT((defect->at - hole).norm(), 0.0015);
  EXPECT_EQ(border_loops(mesh).size(), 2u);  // the ends stay open
  EXPECT_EQ(measure_topology(mesh).mismatched_edges, 0u);
  const TriangleTree tree(open_vessel());  // the patch follows the wall's curve
  for (const Vector3d& v : mesh.vertices) EXPECT_LT(tree.distance(v), 0.0006);
}

TEST(RepairMesh, TurnsFlippedFaces) {
  TriangleMesh mesh = open_vessel();
  for (std::size_t t : {100u, 101u, 102u, 700u}) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "flipped_faces"), nullptr);
  EXPECT_EQ(find_defect(report, "flipped_faces")->count, 4u);
  EXPECT_EQ(find_defect(report, "inward_normals"), nullptr);
  EXPECT_EQ(measure_topology(mesh).mismatched_edges, 0u);
}

TEST(RepairMesh, TurnsAnInwardSurfaceOut) {
  TriangleMesh mesh = open_vessel();
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "inward_normals"), nullptr);
  EXPECT_EQ(find_defect(report, "inward_normals")->count, mesh.triangles.size());
  for (const auto& loop : border_loops(mesh)) cap_loop(mesh, loop);
  EXPECT_GT(signed_volume(mesh), 0);
}

TEST(RepairMesh, DropsDuplicatesAndDegenerates) {
  TriangleMesh mesh = open_vessel();
  const std::size_t clean = mesh.triangles.size();
  mesh.triangles.push_back(mesh.triangles[5]);
  mesh.triangles.push_back({mesh.triangles[9][1], mesh.triangles[9][0], mesh.triangles[9][2]});  // turned round: still a duplicate
  mesh.triangles.push_back({3, 3, 4});
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "duplicate_faces"), nullptr);
  EXPECT_EQ(find_defect(report, "duplicate_faces")->count, 2u);
  ASSERT_NE(find_defect(report, "degenerate_faces"), nullptr);
  EXPECT_EQ(find_defect(report, "degenerate_faces")->count, 1u);
  EXPECT_EQ(mesh.triangles.size(), clean);
}

TEST(RepairMesh, RemovesFacesWithoutArea) {
  TriangleMesh mesh = open_vessel();
  // Split one edge's two faces so that a needle of no area lies along the edge.
  const auto [a, b, c] = mesh.triangles[1000];
  const auto middle = std::int32_t(mesh.vertices.size());
  mesh.vertices.push_back((mesh.vertices[std::size_t(a)] + mesh.vertices[std::size_t(b)]) / 2);
  mesh.triangles[1000] = {a, middle, c};
  mesh.triangles.push_back({middle, b, c});
  mesh.triangles.push_back({b, middle, a});
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "degenerate_faces"), nullptr);
  EXPECT_TRUE(find_defect(report, "degenerate_faces")->repaired);
  EXPECT_EQ(border_loops(mesh).size(), 2u);
}

TEST(RepairMesh, WeldsBordersThatLieSideBySide) {
  TriangleMesh lower = test::make_cylinder(0.012, 0.03), upper = lower;
  for (Vector3d& v : upper.vertices) v += Vector3d(2e-8, 0, 0.03);
  test::append(lower, upper);
  EXPECT_EQ(border_loops(lower).size(), 4u);
  const RepairReport report = repair_mesh(lower);
  EXPECT_NE(find_defect(report, "split_vertices"), nullptr);
  EXPECT_EQ(border_loops(lower).size(), 2u);
}

TEST(RepairMesh, DropsSpecksAndSaysSo) {
  TriangleMesh mesh = open_vessel();
  test::append(mesh, test::make_sphere(0.0004, 8, 6), {0.03, 0, 0});
  test::append(mesh, test::make_sphere(0.0003, 8, 6), {0.03, 0.01, 0});
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "specks"), nullptr);
  EXPECT_EQ(find_defect(report, "specks")->count, 2u);
  EXPECT_EQ(measure_topology(mesh).components, 1u);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings[0].find("loose part"), std::string::npos);
}

TEST(RepairMesh, RemovesSelfIntersectionsWithinItsBound) {
  TriangleMesh mesh = open_vessel();
  // One vertex pushed through the neighbouring faces: a small fold.
  const TriangleMesh before = mesh;
  Vector3d& fold = mesh.vertices[48 * 24 + 7];
  fold += 1.35 * (mesh.vertices[48 * 25 + 7] - fold) + Vector3d(0, 0, 1e-4);
  ASSERT_FALSE(self_intersections(mesh).empty());
  const RepairReport report = repair_mesh(mesh);
  const Defect* defect = find_defect(report, "self_intersections");
  ASSERT_NE(defect, nullptr);
  EXPECT_EQ(defect->repaired, self_intersections(mesh).empty());
  EXPECT_TRUE(defect->repaired);
  Vector3d low, high;
  bounding_box(before, low, high);
  EXPECT_LE(report.moved, 0.01 * (high - low).norm());
  EXPECT_LT((defect->at - Vector3d(before.vertices[48 * 24 + 7])).norm(), 0.005);
}

TEST(RepairMesh, CutsAwayAFin) {
  TriangleMesh mesh = open_vessel();
  const auto [a, b, c] = mesh.triangles[1000];
  mesh.vertices.push_back(mesh.vertices[std::size_t(a)] * 1.05);
  mesh.triangles.push_back({a, b, std::int32_t(mesh.vertices.size()) - 1});
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "non_manifold_edges"), nullptr);
  EXPECT_EQ(measure_topology(mesh).non_manifold_edges, 0u);
  (void)c;
}

TriangleMesh wall_with_thickness(bool joined) {
  TriangleMesh mesh = test::make_cylinder(0.014, 0.06);
  TriangleMesh inner = test::make_cylinder(0.012, 0.06);
  for (auto& t : inner.triangles) std::swap(t[0], t[1]);
  const auto first = std::int32_t(mesh.vertices.size());
  test::append(mesh, inner);
  if (joined)  // a ring of faces between both walls' lower rims
    for (std::int32_t i = 0; i < 48; ++i) {
      const std::int32_t j = (i + 1) % 48;
      mesh.triangles.push_back({j, i, first + i});
      mesh.triangles.push_back({j, first + i, first + j});
    }
  return mesh;
}

TEST(DoubleWall, KeepsTheInnerSurface) {
  TriangleMesh mesh = wall_with_thickness(false);
  const RepairReport report = repair_mesh(mesh);
  ASSERT_NE(find_defect(report, "double_wall"), nullptr);
  EXPECT_TRUE(find_defect(report, "double_wall")->repaired);
  for (const auto& loop : border_loops(mesh)) cap_loop(mesh, loop);
  EXPECT_TRUE(measure_topology(mesh).closed());
  EXPECT_NEAR(signed_volume(mesh), 24 * std::sin(2 * std::numbers::pi / 48) * 0.012 * 0.012 * 0.06, 1e-12);
}

TEST(DoubleWall, RefusesWallsThatAreJoined) {
  TriangleMesh mesh = wall_with_thickness(true);
  const std::string error = test::error_of([&] { repair_mesh(mesh); });
  EXPECT_NE(error.find("double wall"), std::string::npos) << error;
  EXPECT_NE(error.find("mm"), std::string::npos) << error;
}

TEST(DoubleWall, TwoVesselsSideBySideAreNone) {
  TriangleMesh mesh = open_vessel();
  test::append(mesh, open_vessel(), {0.05, 0, 0});
  EXPECT_FALSE(reduce_double_wall(mesh).found);
}

}  // namespace
