#include "render/skin.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

namespace render {
namespace {

// A flat n x n grid of unit squares in z = 0; values = x.
DrawnMesh grid(int n) {
  DrawnMesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), 0.0f);
      mesh.values.push_back(static_cast<float>(x));
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  mesh.normals = vertex_normals(mesh.positions, mesh.triangles);
  return mesh;
}

DrawnMesh octahedron() {
  DrawnMesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  mesh.values.assign(6, 2.0f);
  mesh.normals = vertex_normals(mesh.positions, mesh.triangles);
  return mesh;
}

// Volume by the divergence theorem; of a closed, outward mesh.
double volume(const DrawnMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.positions[a].cast<double>().dot(mesh.positions[b].cast<double>().cross(mesh.positions[c].cast<double>())) / 6;
  return sum;
}

// How often each directed edge is used once vertices at the same place are one: a closed surface uses each as often as its reverse.
bool closed(const DrawnMesh& mesh) {
  std::map<std::array<long, 3>, int> place;
  const auto vertex = [&](int i) {
    const std::array<long, 3> key = {std::lround(1e5 * mesh.positions[i].x()), std::lround(1e5 * mesh.positions[i].y()),
                                     std::lround(1e5 * mesh.positions[i].z())};
    return place.emplace(key, static_cast<int>(place.size())).first->second;
  };
  std::map<std::pair<int, int>, int> balance;
  for (const auto& triangle : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = vertex(triangle[k]), b = vertex(triangle[(k + 1) % 3]);
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  return std::all_of(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
}

TEST(Skin, normals_point_by_the_right_hand_rule) {
  for (const Eigen::Vector3f& normal : grid(3).normals) EXPECT_NEAR((normal - Eigen::Vector3f::UnitZ()).norm(), 0, 1e-6);
  const DrawnMesh solid = octahedron();
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((solid.normals[i] - solid.positions[i]).norm(), 0, 1e-6);
}

// The plate and, round it, half a tube: pi t^2/8 of cross-section (a polygon of four sides has 0.9 of it), mitred at the corners.
TEST(Skin, of_a_flat_square_has_the_volume_of_a_plate_with_a_round_rim_and_is_closed) {
  const DrawnMesh plate = skin(grid(4), 0.5f);
  const double rim = 16 * 3.14159265 * 0.25 / 8;
  EXPECT_GT(volume(plate), 4 * 4 * 0.5 + 0.75 * rim);
  EXPECT_LT(volume(plate), 4 * 4 * 0.5 + 1.05 * rim);
  EXPECT_TRUE(closed(plate));
  EXPECT_FALSE(closed(grid(4)));
  float farthest = 0;
  for (const Eigen::Vector3f& p : plate.positions) farthest = std::max(farthest, p.x());
  EXPECT_NEAR(farthest, 4 + 0.25, 1e-5);  // half the thickness beyond the border
  for (std::size_t i = 0; i < 2 * 25; ++i) EXPECT_EQ(plate.values[i], plate.positions[i].x());
}

TEST(Skin, subdivision_keeps_a_plane_and_its_values_within_their_range) {
  const DrawnMesh fine = subdivide(grid(4));
  EXPECT_EQ(fine.triangles.size(), 4u * 32u);
  for (std::size_t i = 0; i < fine.positions.size(); ++i) {
    EXPECT_NEAR(fine.positions[i].z(), 0, 1e-6);
    EXPECT_GE(fine.values[i], 0);
    EXPECT_LE(fine.values[i], 4);
  }
  for (const Eigen::Vector3f& normal : fine.normals) EXPECT_NEAR(normal.z(), 1, 1e-5);
}

// Loop's rules on the regular octahedron (all degrees 4): an old vertex moves to (1 - 4 * 3/32) of its place, as its neighbours' sum is 0;
// a new one lies at 3/8 (a + b) + 1/8 (c - c) of its edge.
TEST(Skin, subdivision_follows_loops_weights) {
  const DrawnMesh fine = subdivide(octahedron());
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(fine.positions[i].norm(), 1 - 4 * 3.0 / 32, 1e-6);
  for (std::size_t i = 6; i < fine.positions.size(); ++i) EXPECT_NEAR(fine.positions[i].norm(), 0.375 * std::sqrt(2.0), 1e-6);
  EXPECT_TRUE(closed(fine));
  EXPECT_GT(volume(fine), 0);
}

TEST(Skin, borders_are_the_edges_of_one_triangle) {
  EXPECT_EQ(border_edges(grid(5).triangles).size(), 20u);
  EXPECT_TRUE(border_edges(octahedron().triangles).empty());
}

TEST(Skin, section_of_an_octahedron_is_the_square_it_should_be) {
  const DrawnMesh solid = octahedron();
  double length = 0;
  for (const auto& [from, to] : section(solid.positions, solid.triangles, {{0, 0, 0.5f}, Eigen::Vector3f::UnitZ()})) {
    EXPECT_NEAR(from.z(), 0.5, 1e-6);
    EXPECT_NEAR(std::abs(from.x()) + std::abs(from.y()), 0.5, 1e-6);
    length += (to - from).norm();
  }
  EXPECT_NEAR(length, 4 * 0.5 * std::sqrt(2.0), 1e-5);
}

// Half of an octahedron, cut at z = 0.25: its surface below the plane, and the values of a linear field on the cut.
TEST(Skin, cut_away_follows_the_plane_and_keeps_values) {
  const DrawnMesh solid = octahedron();
  Surface whole;
  whole.vertices = solid.positions;
  whole.triangles = solid.triangles;
  whole.fields = {{1, -1, 0, 0, 0, 0}};  // = x
  const Surface kept = cut_away(whole, {{0, 0, 0.25f}, Eigen::Vector3f::UnitZ()});
  double area = 0;
  for (const auto& [a, b, c] : kept.triangles) {
    area += 0.5 * (kept.vertices[b] - kept.vertices[a]).cross(kept.vertices[c] - kept.vertices[a]).norm();
    for (const std::int32_t i : {a, b, c}) {
      EXPECT_LE(kept.vertices[i].z(), 0.25f + 1e-6f);
      EXPECT_NEAR(kept.fields[0][i], kept.vertices[i].x(), 1e-6);
    }
  }
  const double half = 4 * std::sqrt(3.0) / 2;  // four equilateral triangles of side sqrt 2
  EXPECT_NEAR(area, half + half * (1 - 0.75 * 0.75), 1e-5);
  EXPECT_EQ(cut_away(whole, {{0, 0, 2}, Eigen::Vector3f::UnitZ()}).triangles.size(), 8u);
  EXPECT_TRUE(cut_away(whole, {{0, 0, -2}, Eigen::Vector3f::UnitZ()}).triangles.empty());
}

TEST(Skin, drawn_mesh_takes_the_chosen_field) {
  Surface surface;
  const DrawnMesh flat = grid(2);
  surface.vertices = flat.positions;
  surface.triangles = flat.triangles;
  surface.fields = {std::vector<float>(9, 1.0f), std::vector<float>(9, 5.0f)};
  surface.smoothing = 2;
  surface.thickness = 0.1f;
  const DrawnMesh drawn = drawn_mesh(surface, 1);
  EXPECT_TRUE(std::all_of(drawn.values.begin(), drawn.values.end(), [](float v) { return v == 5.0f; }));
  EXPECT_TRUE(closed(drawn));
}

}  // namespace
}  // namespace render
