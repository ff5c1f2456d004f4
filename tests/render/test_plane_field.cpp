#include "render/plane_field.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace render {
namespace {

constexpr float spacing = 1e-3f;

// A block of particles in simple cubic order, 12 mm wide, each with the value of `function`.
template <class Function>
ParticleSet block(Function function) {
  ParticleSet set;
  set.radius = 0.62f * spacing;  // as pictures draw them
  set.fields.resize(1);
  for (int z = -6; z <= 6; ++z)
    for (int y = -6; y <= 6; ++y)
      for (int x = -6; x <= 6; ++x) {
        set.positions.push_back(spacing * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
        set.fields[0].push_back(function(set.positions.back()));
      }
  return set;
}

Style by_field() {
  Style style;
  style.field = 0;
  return style;
}

ColorScale zero_to_one() {
  ColorScale scale;
  scale.minimum = 0, scale.maximum = 1;
  return scale;
}

Eigen::Vector3f middle_of(const PlaneField& field, int x, int y) {
  return field.corner + field.cell * ((static_cast<float>(x) + 0.5f) * field.right + (static_cast<float>(y) + 0.5f) * field.up);
}

const ClipPlane slanted{{0.3e-3f, -0.2e-3f, 0.1e-3f}, Eigen::Vector3f(1, 2, 3).normalized()};

// The Shepard mean reproduces a constant exactly; a linear field to within a tenth of its change over a spacing, where particles lie on all
// sides (unevenly about a place that is none of theirs).
TEST(PlaneField, reproduces_constant_and_linear_fields) {
  const ColorScale scale = zero_to_one();
  const auto linear = [](const Eigen::Vector3f& p) { return 0.5f + 30 * p.x() - 20 * p.y() + 10 * p.z(); };
  const PlaneField flat = plane_field(block([](const Eigen::Vector3f&) { return 0.25f; }), by_field(), &scale, slanted);
  const PlaneField sloped = plane_field(block(linear), by_field(), &scale, slanted);
  int inner = 0;
  for (int y = 0; y < sloped.height; ++y)
    for (int x = 0; x < sloped.width; ++x) {
      const std::size_t cell = static_cast<std::size_t>(y * sloped.width + x);
      const Eigen::Vector3f place = middle_of(sloped, x, y);
      EXPECT_NEAR(slanted.normal.dot(place - slanted.point), 0, 1e-8);
      if (flat.sums[cell][0] > 1e-4f) {
        EXPECT_NEAR(flat.sums[cell][1] / flat.sums[cell][0], 0.25, 1e-5);
      }
      if (place.cwiseAbs().maxCoeff() > 4e-3f) continue;  // nearer to the surface than particles reach
      ++inner;
      EXPECT_NEAR(sloped.sums[cell][1] / sloped.sums[cell][0], linear(place), 0.1 * 37.4 * spacing);
    }
  EXPECT_GT(inner, 300);
}

// Deep inside, the weights sum to the kernel's integral over a spacing cubed: 4 pi (1/3 - 2/5 + 1/7) reach³ / spacing³ = 0.957 (reach /
// spacing)³.
TEST(PlaneField, weights_sum_to_the_kernels_integral) {
  const PlaneField field = plane_field(block([](const Eigen::Vector3f&) { return 0.0f; }), by_field(), nullptr, slanted);
  const double whole = 4 * M_PI * (1.0 / 3 - 2.0 / 5 + 1.0 / 7) * std::pow(section_reach * 0.62, 3);
  double sum = 0;
  int inner = 0;
  for (int y = 0; y < field.height; ++y)
    for (int x = 0; x < field.width; ++x) {
      if (middle_of(field, x, y).cwiseAbs().maxCoeff() > 4e-3f) continue;
      sum += field.sums[static_cast<std::size_t>(y * field.width + x)][0];
      ++inner;
    }
  EXPECT_NEAR(sum / inner, whole, 0.02 * whole);
}

TEST(PlaneField, is_empty_away_from_particles_and_passes_over_what_is_no_number) {
  const ColorScale scale = zero_to_one();
  ParticleSet set = block([](const Eigen::Vector3f&) { return 1.0f; });
  EXPECT_EQ(plane_field(set, by_field(), &scale, {{0, 0, 1}, Eigen::Vector3f::UnitZ()}).width, 0);
  EXPECT_EQ(plane_field({}, by_field(), &scale, slanted).width, 0);
  const PlaneField before = plane_field(set, by_field(), &scale, slanted);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  set.positions.insert(set.positions.end(), {{nan, 0, 0}, {0, infinity, 0}, slanted.point});
  set.fields[0].insert(set.fields[0].end(), {1, 1, nan});
  const PlaneField after = plane_field(set, by_field(), &scale, slanted);
  EXPECT_EQ(after.sums, before.sums);
}

// However far particles lie apart, the field stays within its limit of cells.
TEST(PlaneField, stays_small_where_particles_are_spread_thinly) {
  ParticleSet set;
  set.radius = 1e-4f;
  set.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
  const PlaneField field = plane_field(set, {}, nullptr, {{0, 0, 0}, Eigen::Vector3f::UnitZ()});
  EXPECT_LT(static_cast<double>(field.width) * field.height, 4.1e6);
  EXPECT_EQ(field.sums.size(), static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height));
}

}  // namespace
}  // namespace render
