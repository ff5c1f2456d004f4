#include "render/skin_cache.h"

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
  const DrawnMesh flat = grid(4);
  const Skin skinned = skin(flat, 0.5f, make_topology(flat.triangles).border);
  const DrawnMesh& plate = skinned.mesh;
  const double rim = 16 * 3.14159265 * 0.25 / 8;
  EXPECT_GT(volume(plate), 4 * 4 * 0.5 + 0.75 * rim);
  EXPECT_LT(volume(plate), 4 * 4 * 0.5 + 1.05 * rim);
  EXPECT_TRUE(closed(plate));
  EXPECT_FALSE(closed(grid(4)));
  float farthest = 0;
  for (const Eigen::Vector3f& p : plate.positions) farthest = std::max(farthest, p.x());
  EXPECT_NEAR(farthest, 4 + 0.25, 1e-5);  // half the thickness beyond the border
  ASSERT_EQ(skinned.source.size(), plate.positions.size());
  for (std::size_t i = 0; i < plate.positions.size(); ++i)  // no point is farther from where its value comes from than half the thickness
    EXPECT_LE((plate.positions[i] - flat.positions[skinned.source[i]]).norm(), 0.25 + 1e-5);
}

DrawnMesh subdivide(const DrawnMesh& mesh) {
  const Topology topology = make_topology(mesh.triangles);
  DrawnMesh fine;
  fine.positions = subdivided(mesh.positions, topology);
  fine.values = subdivided(mesh.values, topology);
  fine.triangles = refined(topology, mesh.positions.size());
  fine.normals = vertex_normals(fine.positions, fine.triangles);
  return fine;
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
  EXPECT_EQ(make_topology(grid(5).triangles).border.size(), 20u);
  EXPECT_TRUE(make_topology(octahedron().triangles).border.empty());
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

Surface bent_surface(float height) {
  Surface surface;
  const DrawnMesh flat = grid(4);
  surface.vertices = flat.positions;
  for (Eigen::Vector3f& p : surface.vertices) p.z() = height * p.x() * p.x();
  surface.triangles = flat.triangles;
  surface.fields = {flat.values, std::vector<float>(25, 5.0f)};
  surface.smoothing = 2;
  surface.averaging = surface.fairing = 2;
  surface.thickness = 0.1f;
  return surface;
}

TEST(SkinCache, takes_the_chosen_field) {
  SkinCache skins;
  const Surface surface = bent_surface(0);
  EXPECT_EQ(skins.drawn(surface, -1, 1000).values.size(), skins.drawn(surface, 1, 1000).positions.size());
  const DrawnMesh& drawn = skins.drawn(surface, 1, 1000);
  EXPECT_TRUE(std::all_of(drawn.values.begin(), drawn.values.end(), [](float v) { return v == 5.0f; }));
  EXPECT_TRUE(closed(drawn));
}

// The same in whatever order surfaces and fields are asked for, and however many others came between.
TEST(SkinCache, remembers_nothing_that_changes_what_is_drawn) {
  SkinCache used;
  for (const float height : {0.0f, 0.1f, 0.2f, 0.1f, 0.0f})
    for (const int field : {0, 1, -1, 0}) {
      const Surface surface = bent_surface(height);
      const DrawnMesh& drawn = used.drawn(surface, field, 1000);
      SkinCache fresh;
      const DrawnMesh& expected = fresh.drawn(surface, field, 1000);
      EXPECT_EQ(drawn.positions, expected.positions);
      EXPECT_EQ(drawn.normals, expected.normals);
      EXPECT_EQ(drawn.triangles, expected.triangles);
      if (field >= 0) {
        EXPECT_EQ(drawn.values, expected.values);
      }
      EXPECT_EQ(used.rim(surface, 1000), fresh.rim(surface, 1000));
      if (height == 0.1f)
        for (std::size_t k = 0; k < 2 * SkinCache::kept; ++k) used.drawn(bent_surface(1.0f + static_cast<float>(k)), 0, 1000);
    }
}

// Edges of 1.14 in the mean (two sides of 1, one of 1.41).
TEST(SkinCache, smooths_as_far_as_the_picture_can_show) {
  const Surface surface = bent_surface(0);
  for (const auto& [pixels, levels] : {std::pair{1.0f, 0}, {6.9f, 0}, {7.1f, 1}, {13.9f, 1}, {14.3f, 2}, {1000.0f, 2}}) {
    EXPECT_EQ(levels_needed(surface, pixels), levels) << pixels;
    SkinCache skins;
    EXPECT_EQ(skins.rim(surface, pixels).size(), 16u << levels);
  }
}

// Another field of the same shape, other values of the same field, another mesh of the same points.
TEST(SkinCache, sees_every_change) {
  SkinCache skins;
  Surface surface = bent_surface(0.1f);
  const std::vector<float> first = skins.drawn(surface, 0, 1000).values;
  surface.fields[0][12] += 1;
  EXPECT_NE(skins.drawn(surface, 0, 1000).values, first);
  surface.fields[0][12] -= 1;
  EXPECT_EQ(skins.drawn(surface, 0, 1000).values, first);
  surface.averaging = 0;
  EXPECT_NE(skins.drawn(surface, 0, 1000).values, first);
  EXPECT_EQ(skins.border(surface).size(), 16u);
  surface.triangles.pop_back();  // of the corner's square: one edge of the border gone, two new
  EXPECT_EQ(skins.border(surface).size(), 17u);
  EXPECT_EQ(skins.rim(surface, 1000).size(), 4 * 17u);  // split in two at each level
}

}  // namespace
}  // namespace render
