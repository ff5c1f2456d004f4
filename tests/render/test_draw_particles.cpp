#include "render/draw_particles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render {
namespace {

// n^3 particles at spacing 1, each moved by up to `disorder` in each direction.
ParticleSet lattice(int n, float disorder = 0) {
  ParticleSet set;
  set.radius = 0.6f;
  set.fields.resize(1);
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const auto jitter = [&](float phase) { return disorder * std::sin(12.9898f * static_cast<float>(set.positions.size()) + phase); };
        set.positions.emplace_back(static_cast<float>(x) + jitter(0), static_cast<float>(y) + jitter(2), static_cast<float>(z) + jitter(4));
        set.fields[0].push_back(static_cast<float>(x));
      }
  return set;
}

// No ray of a fan from far outside may meet a buried ball first. (Between the rows of a perfect lattice the eye sees right through.)
TEST(DrawParticles, what_is_buried_is_never_seen_first) {
  const ParticleSet set = lattice(15, 0.15f);
  const std::vector<std::uint8_t> hidden = buried(set.positions, std::vector<std::uint8_t>(set.positions.size(), 1), set.radius);
  int count = 0;
  for (const std::uint8_t each : hidden) count += each;
  EXPECT_GT(count, 100);  // it does save work
  for (int ray = 0; ray < 400; ++ray) {
    const float height = 2 * (static_cast<float>(ray) + 0.5f) / 400 - 1, turn = 2.39996f * static_cast<float>(ray);
    const Eigen::Vector3f from(std::sqrt(1 - height * height) * std::cos(turn), std::sqrt(1 - height * height) * std::sin(turn), height);
    const Eigen::Vector3f middle(7 + 2 * std::sin(static_cast<float>(ray)), 7 + 2 * std::cos(3.0f * static_cast<float>(ray)), 7);
    const Eigen::Vector3f origin = middle + 50 * from, sight = -from;
    float nearest = 1e9f;
    std::size_t first = 0;
    for (std::size_t i = 0; i < set.positions.size(); ++i) {
      const Eigen::Vector3f offset = set.positions[i] - origin;
      const float along = offset.dot(sight), inside = set.radius * set.radius - (offset - along * sight).squaredNorm();
      if (inside > 0 && along - std::sqrt(inside) < nearest) {
        nearest = along - std::sqrt(inside);
        first = i;
      }
    }
    ASSERT_LT(nearest, 1e9f);
    EXPECT_FALSE(hidden[first]) << "ray " << ray;
  }
}

TEST(DrawParticles, a_thin_layer_is_not_buried) {
  const ParticleSet set = lattice(3);
  for (const std::uint8_t each : buried(set.positions, std::vector<std::uint8_t>(set.positions.size(), 1), set.radius)) EXPECT_EQ(each, 0);
}

TEST(DrawParticles, the_clip_plane_takes_what_lies_wholly_beyond_it) {
  const ParticleSet set = lattice(4);
  const ClipPlane plane{{1.5f, 0, 0}, Eigen::Vector3f::UnitX()};
  for (const Sphere& sphere : visible_spheres(set, {}, nullptr, plane, ParticleShape::sphere)) EXPECT_LT(sphere.center.x(), 1.5f + 0.6f);
  EXPECT_EQ(visible_spheres(set, {}, nullptr, plane, ParticleShape::sphere).size(), 48u);  // x = 0, 1 and the cut balls at 2
  Style whole;
  whole.clipped = false;
  EXPECT_EQ(visible_spheres(set, whole, nullptr, plane, ParticleShape::sphere).size(), 64u);
}

TEST(DrawParticles, colours_come_from_the_scale_and_bad_numbers_are_marked) {
  ParticleSet set = lattice(1);
  const ColorScale scale{"x", "m", 1, 0, 10, Colormap::viridis};
  const auto color = [&](float value) {
    set.fields[0][0] = value;
    return visible_spheres(set, {0, 0}, &scale, std::nullopt, ParticleShape::sphere).at(0).color;
  };
  for (const float value : {0.0f, 5.0f, 10.0f, 25.0f})
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(color(value)[k], 255 * map_color(Colormap::viridis, value / 10)[k], 1.0);
  EXPECT_EQ(color(std::nanf("")), (std::array<std::uint8_t, 4>{128, 128, 128, 255}));
  set.positions[0].x() = std::nanf("");
  EXPECT_TRUE(visible_spheres(set, {}, nullptr, std::nullopt, ParticleShape::sphere).empty());
}

}  // namespace
}  // namespace render
