#include "geometry/place_particles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "geometry/cell_volumes.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

PlacementOptions plane(double spacing) {
  PlacementOptions options;
  options.dimension = 2;
  options.spacing = spacing;
  return options;
}

double total(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

Vector3d total(const std::vector<Vector3d>& values) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& v : values) sum += v;
  return sum;
}

// The contract's own example: water in a tank over a plate.
std::vector<PlacedBody> water_over_plate() {
  Shape tank = box_shape({-0.05, 0, 0}, {1.05, 2.5, 0});
  tank.subtract = {box_shape({0, 0, 0}, {1, 2.5, 0})};
  return {{"water", Matter::fluid, box_shape({0, 0, 0}, {1, 2, 0})},
          {"tank", Matter::wall, tank},
          {"plate", Matter::elastic, box_shape({-0.05, -0.05, 0}, {1.05, 0, 0})}};
}

TEST(PlaceParticles, BoxesThatTouchShareOneLattice) {
  const Placement placement = place_particles(water_over_plate(), plane(0.01));
  ASSERT_EQ(placement.bodies[0].size(), 100u * 200u);
  ASSERT_EQ(placement.bodies[1].size(), 2u * 5u * 250u);
  ASSERT_EQ(placement.bodies[2].size(), 110u * 5u);
  for (const ParticleSet& body : placement.bodies)
    for (const Vector3d& p : body.position)
      for (int k : {0, 1}) EXPECT_NEAR(std::remainder(p[k] - 0.005, 0.01), 0, 1e-12);
  EXPECT_NEAR(total(placement.bodies[0].volume), 2, 1e-12);
  EXPECT_NEAR(total(placement.bodies[1].volume), 2 * 0.05 * 2.5, 1e-12);
  EXPECT_EQ(placement.relaxed, 0u);
}

TEST(PlaceParticles, WallsKnowTheirDepthAndTheSideOfTheFluid) {
  const Placement placement = place_particles(water_over_plate(), plane(0.01));
  const ParticleSet& tank = placement.bodies[1];
  for (std::size_t i = 0; i < tank.size(); ++i) {
    const bool left = tank.position[i].x() < 0;
    const double depth = left ? -tank.position[i].x() : tank.position[i].x() - 1;
    if (depth > 0.045 || tank.position[i].y() > 2.46) continue;  // farther than fluid looks, or at the rim
    EXPECT_NEAR(tank.depth[i], depth, 1e-9);
    EXPECT_NEAR((tank.normal[i] - Vector3d(left ? 1 : -1, 0, 0)).norm(), 0, 1e-6) << tank.position[i].transpose();
  }
}

TEST(PlaceParticles, WallOfSeveralBoxesHasNoSurfaceWhereTheyTouch) {
  const std::vector<PlacedBody> bodies{{"water", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 0})},
                                       {"floor", Matter::wall, box_shape({-0.3, -0.3, 0}, {1.3, 0, 0})},
                                       {"left", Matter::wall, box_shape({-0.3, 0, 0}, {0, 1, 0})},
                                       {"right", Matter::wall, box_shape({1, 0, 0}, {1.3, 1, 0})}};
  const Placement placement = place_particles(bodies, plane(0.1));
  const ParticleSet& floor = placement.bodies[1];
  int corner = 0;
  for (std::size_t i = 0; i < floor.size(); ++i) {
    if (floor.position[i].x() > 0 && floor.position[i].x() < 1) {
      EXPECT_NEAR(floor.depth[i], -floor.position[i].y(), 1e-9);
      EXPECT_NEAR((floor.normal[i] - Vector3d::UnitY()).norm(), 0, 1e-6);
    } else if (std::abs(floor.position[i].x() + 0.05) < 1e-9 && std::abs(floor.position[i].y() + 0.05) < 1e-9) {
      ++corner;  // nearest to the fluid's corner at the origin, not to the face under the left wall
      EXPECT_NEAR(floor.depth[i], std::hypot(0.05, 0.05), 1e-6);
      EXPECT_NEAR((floor.normal[i] - Vector3d(1, 1, 0).normalized()).norm(), 0, 1e-3);
    }
  }
  EXPECT_EQ(corner, 1);
}

TEST(PlaceParticles, ThinPlateKeepsItsThickness) {
  // 0.5 mm plate at 1 mm: one layer with half the pitch; and 2.6 spacings: three layers.
  for (const auto& [thickness, layers] : {std::pair{0.5e-3, 1}, std::pair{2.6e-3, 3}}) {
    const Placement placement = place_particles({{"plate", Matter::elastic, box_shape({0, 0, 0}, {0.02, 0.01, thickness})}}, [] {
      PlacementOptions options;
      options.spacing = 1e-3;
      return options;
    }());
    const ParticleSet& plate = placement.bodies[0];
    ASSERT_EQ(plate.size(), std::size_t(20 * 10 * layers));
    EXPECT_NEAR(total(plate.volume), 0.02 * 0.01 * thickness, 1e-18);
    const double lowest =
        std::min_element(plate.position.begin(), plate.position.end(), [](auto& a, auto& b) { return a.z() < b.z(); })->z();
    EXPECT_NEAR(lowest, 0.5 * thickness / layers, 1e-12);
    EXPECT_NEAR(total(plate.surface_area).norm(), 0, 1e-15);
    double top = 0;
    for (const Vector3d& a : plate.surface_area) top += std::max(0.0, a.z());
    if (layers > 1) {
      EXPECT_NEAR(top, 0.02 * 0.01, 1e-15);
    }
  }
}

TEST(PlaceParticles, ElasticSurfaceAreaSitsOnTheOutermostParticles) {
  const Placement placement = place_particles({{"plate", Matter::elastic, box_shape({0, 0, 0}, {1, 0.3, 0})}}, plane(0.1));
  const ParticleSet& plate = placement.bodies[0];
  for (std::size_t i = 0; i < plate.size(); ++i) {
    const Vector3d& p = plate.position[i];
    Vector3d expected = Vector3d::Zero();
    if (p.x() < 0.1) expected.x() = -0.1;
    if (p.x() > 0.9) expected.x() = 0.1;
    if (p.y() < 0.1) expected.y() = -0.1;
    if (p.y() > 0.2) expected.y() = 0.1;
    EXPECT_NEAR((plate.surface_area[i] - expected).norm(), 0, 1e-12);
    EXPECT_NEAR(plate.depth[i], std::min({p.x(), 1 - p.x(), p.y(), 0.3 - p.y()}), 1e-12);
  }
}

TEST(PlaceParticles, OverlapIsRefusedWithBothNames) {
  const auto message = [](const std::vector<PlacedBody>& bodies) {
    try {
      place_particles(bodies, plane(0.1));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const PlacedBody water{"water", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 0})};
  for (const PlacedBody& other : {PlacedBody{"slab", Matter::wall, box_shape({0.98, 0, 0}, {1.3, 1, 0})},
                                  PlacedBody{"thin", Matter::elastic, box_shape({0.5, 0, 0}, {0.52, 0.5, 0})},
                                  PlacedBody{"ball", Matter::wall, sphere_shape({1, 0.5, 0}, 0.2)},
                                  PlacedBody{"oil", Matter::fluid, box_shape({0.5, 0.5, 0}, {2, 2, 0})}}) {
    const std::string text = message({water, other});
    EXPECT_NE(text.find("\"water\""), std::string::npos) << other.name << ": " << text;
    EXPECT_NE(text.find("\"" + other.name + "\""), std::string::npos) << text;
  }
  EXPECT_EQ(message({water, {"next", Matter::wall, box_shape({1, 0, 0}, {1.3, 1, 0})}}), "accepted");
}

TEST(PlaceParticles, TooManyParticlesAreRefusedBeforeWork) {
  PlacementOptions options;
  options.spacing = 1e-4;
  const std::vector<PlacedBody> bodies{{"sea", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 1})}};
  EXPECT_EQ(estimate_particle_counts(bodies, options)[0], 1'000'000'000'000);
  EXPECT_THROW(place_particles(bodies, options), std::invalid_argument);
}

TEST(PlaceParticles, PeriodicBoxHasOneSpacingAcrossTheSeam) {
  PlacementOptions options = plane(0.03);  // no whole number of spacings in 1
  options.periodic = {true, true, false};
  options.domain_max = {1, 1, 0};
  const Placement placement = place_particles({{"fluid", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 0})}}, options);
  ASSERT_EQ(placement.bodies[0].size(), 33u * 33u);
  const Evenness even = measure_evenness(placement.bodies[0].position, placement.bodies[0].volume, 2, 1.0 / 33, &options);
  for (double density : even.density) EXPECT_NEAR(density, 1, 1e-12);
}

TEST(PlaceParticles, PeriodicWallHasNoSurfaceAtTheSeam) {
  PlacementOptions options = plane(0.1);
  options.periodic = {true, false, false};
  options.domain_max = {1, 1, 0};
  const Placement placement = place_particles(
      {{"fluid", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 0})}, {"floor", Matter::wall, box_shape({0, -0.3, 0}, {1, 0, 0})}}, options);
  const ParticleSet& floor = placement.bodies[1];
  for (std::size_t i = 0; i < floor.size(); ++i) {
    EXPECT_NEAR(floor.depth[i], -floor.position[i].y(), 1e-9);
    EXPECT_NEAR(floor.normal[i].y(), 1, 1e-9);
  }
}

// What a curved body must be: true volume, outermost centres half a spacing below the true surface, nothing too near.
void expect_follows_surface(const ParticleSet& set, const Shape& shape, const PlacementOptions& options, double volume, double tolerance) {
  EXPECT_NEAR(total(set.volume), volume, tolerance * volume);
  const Evenness even = measure_evenness(set.position, set.volume, options.dimension, options.spacing);
  EXPECT_GE(*std::min_element(even.nearest.begin(), even.nearest.end()), 0.7 * options.spacing);
  for (const Vector3d& p : set.position) EXPECT_LE(signed_distance(shape, p, options.dimension), -0.4 * options.spacing);
}

TEST(PlaceParticles, ElasticDiscFollowsItsCircle) {
  const Shape disc = sphere_shape({0.03, 0.02, 0}, 0.1);
  const PlacementOptions options = plane(0.01);
  const ParticleSet set = place_particles({{"disc", Matter::elastic, disc}}, options).bodies[0];
  expect_follows_surface(set, disc, options, std::numbers::pi * 0.01, 1e-4);
  // All round the rim a particle lies within 0.6 spacings of the surface, in a chain without gaps.
  for (int i = 0; i < 360; ++i) {
    const double angle = i * std::numbers::pi / 180;
    const Vector3d rim = Vector3d(0.03, 0.02, 0) + 0.095 * Vector3d(std::cos(angle), std::sin(angle), 0);
    double nearest = 1;
    for (const Vector3d& p : set.position) nearest = std::min(nearest, (p - rim).norm());
    EXPECT_LT(nearest, 0.75 * options.spacing) << i;
  }
  EXPECT_NEAR(total(set.surface_area).norm(), 0, 1e-12);
  double outward = 0;  // divergence theorem: sum x . A = D V for the surface's own points; particles lie l0/2 below
  for (std::size_t i = 0; i < set.size(); ++i) outward += (set.position[i] - Vector3d(0.03, 0.02, 0)).dot(set.surface_area[i]);
  EXPECT_NEAR(outward, 2 * std::numbers::pi * 0.1 * 0.095, 0.02 * 2 * std::numbers::pi * 0.1 * 0.095);
}

TEST(PlaceParticles, SharesOfACurvedSurfaceCloseAndKeepFacesApart) {
  // A quarter of a ring: each particle in one of its four corners has a share of the ring's face and one of the end.
  const double inner = 0.2, outer = 0.26;
  Shape ring = sphere_shape({0, 0, 0}, outer);
  ring.subtract.push_back(sphere_shape({0, 0, 0}, inner));
  ring.intersect.push_back(box_shape({0, 0, 0}, {0.3, 0.3, 0}));
  const ParticleSet set = place_particles({{"ring", Matter::elastic, ring}}, plane(0.01)).bodies[0];
  Vector3d sum = Vector3d::Zero(), largest = Vector3d::Zero();
  double moment = 0, ends = 0;
  for (const SurfaceShare& share : set.surface) {
    sum += share.area;
    moment += share.area.dot(set.position[share.particle] + share.offset);
    const Vector3d at = set.position[share.particle] + share.offset;
    if (std::min(at.x(), at.y()) < 1e-3) {
      ends += share.area.norm();
      EXPECT_GT(-share.area.minCoeff() / share.area.norm(), 0.98);  // faces along an axis
    } else {
      EXPECT_GT(std::abs(share.area.dot(at)) / (share.area.norm() * at.norm()), 0.99);  // faces along the radius
    }
  }
  EXPECT_NEAR(sum.norm(), 0, 1e-12);
  EXPECT_NEAR(moment, 2 * total(set.volume), 1e-9);
  EXPECT_NEAR(ends, 2 * (outer - inner), 0.02 * (outer - inner));
}

TEST(PlaceParticles, CellsOfACurvedBodyAddUpToItsMomentsSectorBySector) {
  // With equal volumes the middle of a sector of this ring lies up to 0.1 spacings beside the ring's own.
  const double inner = 0.2, outer = 0.26, spacing = 0.01;
  Shape ring = sphere_shape({0, 0, 0}, outer);
  ring.subtract.push_back(sphere_shape({0, 0, 0}, inner));
  ring.intersect.push_back(box_shape({0, 0, 0}, {0.3, 0.3, 0}));
  const ParticleSet set = place_particles({{"ring", Matter::elastic, ring}}, plane(spacing)).bodies[0];
  double second = 0;  // harmonic of the first moment about the ring's middle radius that bends it into an oval
  const double middle = 2.0 / 3 * (std::pow(outer, 3) - std::pow(inner, 3)) / (outer * outer - inner * inner);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const Vector3d& x = set.position[i];
    second += set.volume[i] * (x.norm() - middle) * std::cos(2 * std::atan2(x.y(), x.x()));
  }
  EXPECT_NEAR(second, 0, 0.005 * spacing * total(set.volume));
  EXPECT_NEAR(total(set.volume), std::numbers::pi / 4 * (outer * outer - inner * inner), 1e-6);
  for (double volume : set.volume) EXPECT_NEAR(volume / (spacing * spacing), 1, 0.35);
}

TEST(PlaceParticles, ParticlesOfACurvedBodyLieAtTheirCellsCentroids) {
  // An eighth of a thick sphere, four layers. Off the centroid (0.026 spacings rms without Lloyd's sweeps) a sum over cells is right to
  // first order only, and where the lattice lies well the sphere is softer than elsewhere.
  const double spacing = 0.05;
  Shape sphere = sphere_shape({0, 0, 0}, 1.2);
  sphere.subtract.push_back(sphere_shape({0, 0, 0}, 1));
  sphere.intersect.push_back(box_shape({0, 0, 0}, {1.3, 1.3, 1.3}));
  PlacementOptions options;
  options.spacing = spacing;
  const ParticleSet set = place_particles({{"sphere", Matter::elastic, sphere}}, options).bodies[0];
  const Cells cells = cell_volumes(sphere, set.position, set.depth, 3, spacing);
  double squares = 0;
  for (const Vector3d& centroid : cells.centroid) squares += centroid.squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(set.size())), 0.015 * spacing);
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < set.size(); ++i) moment += set.volume[i] * set.position[i];
  const double exact = std::numbers::pi / 16 * (std::pow(1.2, 4) - 1);
  for (int k : {0, 1, 2}) EXPECT_NEAR(moment[k], exact, 0.001 * exact);
}

TEST(PlaceParticles, BloodInAPipeMeetsTheWallEvenly) {
  PlacementOptions options;
  options.spacing = 0.05;
  options.periodic = {true, false, false};
  options.domain_max = {1, 1, 1};
  const Shape blood = cylinder_shape({0, 0, 0}, {1, 0, 0}, 0.4), wall = cylinder_shape({0, 0, 0}, {1, 0, 0}, 0.6, 0.4);
  const Placement placement = place_particles({{"blood", Matter::fluid, blood}, {"wall", Matter::wall, wall}}, options);
  std::vector<Vector3d> position;
  std::vector<double> volume;
  for (const ParticleSet& set : placement.bodies) {
    position.insert(position.end(), set.position.begin(), set.position.end());
    volume.insert(volume.end(), set.volume.begin(), set.volume.end());
  }
  const Evenness even = measure_evenness(position, volume, 3, options.spacing, &options);
  double mean = 0, square = 0;
  int count = 0;
  for (std::size_t i = 0; i < placement.bodies[0].size(); ++i) {
    if (std::hypot(position[i].y(), position[i].z()) < 0.4 - 1.2 * options.spacing) continue;
    mean += even.density[i];
    square += even.density[i] * even.density[i];
    ++count;
  }
  mean /= count;
  EXPECT_NEAR(mean, 1, 0.015);
  EXPECT_LT(std::sqrt(square / count - mean * mean), 0.025);
  EXPECT_GE(*std::min_element(even.nearest.begin(), even.nearest.end()), 0.7 * options.spacing);
  const ParticleSet& shell = placement.bodies[1];
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const double radius = std::hypot(shell.position[i].y(), shell.position[i].z());
    if (radius > 0.53) continue;
    EXPECT_NEAR(shell.depth[i], radius - 0.4, 1e-3);
    EXPECT_LT(shell.normal[i].dot(Vector3d(0, shell.position[i].y(), shell.position[i].z())) / radius, -0.999);
  }
}

// Along a short straight pipe every layer holds its share: cells equally far from the surface are not dropped all at one end.
TEST(PlaceParticles, CoarsePipeHoldsAsMuchInEveryLayer) {
  PlacementOptions options;
  options.spacing = 0.2;
  options.periodic = {false, false, true};
  options.domain_min = {-2, -2, 0};
  options.domain_max = {2, 2, 1.6};
  const Shape blood = cylinder_shape({0, 0, 0}, {0, 0, 1.6}, 1), wall = cylinder_shape({0, 0, 0}, {0, 0, 1.6}, 1.6, 1);
  const Placement placement = place_particles({{"blood", Matter::fluid, blood}, {"wall", Matter::wall, wall}}, options);
  std::array<int, 8> fluid{}, solid{};
  for (const Vector3d& x : placement.bodies[0].position) ++fluid[std::size_t(x.z() / 0.2)];
  for (const Vector3d& x : placement.bodies[1].position) solid[std::size_t(x.z() / 0.2)] += std::hypot(x.x(), x.y()) < 1.2;
  for (std::size_t layer = 0; layer < 8; ++layer) {
    EXPECT_NEAR(fluid[layer], std::numbers::pi * 25, 1.6) << "layer " << layer;
    EXPECT_NEAR(solid[layer], solid[0], 2) << "layer " << layer;
  }
}

// Two flaps 0.5 mm thick on 2 mm particles, whose lengths no spacing divides: each flap takes whole cells, half from either side.
TEST(PlaceParticles, ThinFlapsTakeFromBothSidesAlike) {
  constexpr double l0 = 0.002;
  PlacementOptions options = plane(l0);
  double flaps = 0;
  for (int s = 0; s < 5; ++s)
    for (double side : {-1.0, 1.0}) {
      options.obstacle_position.push_back({0, side * (0.0019 + 0.0018 * s), 0});
      options.obstacle_volume.push_back(0.0018 * l0);
      flaps += 0.0018 * l0;
    }
  Shape blood = box_shape({-0.016, -0.01, 0}, {0.024, 0.01, 0});
  blood.subtract = {box_shape({-0.00025, 0.001, 0}, {0.00025, 0.01, 0}), box_shape({-0.00025, -0.01, 0}, {0.00025, -0.001, 0})};
  Shape wall = box_shape({-0.016, -0.018, 0}, {0.024, 0.018, 0});
  wall.subtract = {box_shape({-0.017, -0.01, 0}, {0.025, 0.01, 0})};
  const Placement placement = place_particles({{"blood", Matter::fluid, blood}, {"wall", Matter::wall, wall}}, options);
  const ParticleSet& fluid = placement.bodies[0];
  EXPECT_NEAR(static_cast<double>(fluid.size()), (0.04 * 0.02 - flaps) / (l0 * l0), 1);
  std::array<int, 2> beside{};
  for (const Vector3d& x : fluid.position)
    if (std::abs(x.x()) < 0.01) ++beside[x.x() > 0];
  EXPECT_LE(std::abs(beside[0] - beside[1]), 2);
  std::vector<Vector3d> all = fluid.position;
  std::vector<double> volume(fluid.size(), l0 * l0);
  all.insert(all.end(), placement.bodies[1].position.begin(), placement.bodies[1].position.end());
  all.insert(all.end(), options.obstacle_position.begin(), options.obstacle_position.end());
  volume.resize(fluid.size() + placement.bodies[1].size(), l0 * l0);
  volume.insert(volume.end(), options.obstacle_volume.begin(), options.obstacle_volume.end());
  const Evenness even = measure_evenness(all, volume, 2, l0);
  for (std::size_t i = 0; i < fluid.size(); ++i)
    if (fluid.position[i].x() > -0.012 && fluid.position[i].x() < 0.02) {
      EXPECT_NEAR(even.density[i], 1, 0.05) << fluid.position[i];
    }
}

TEST(PlaceParticles, SameParticlesForAnyNumberOfThreadsAndRepeat) {
  const PlacementOptions options = plane(0.01);
  const std::vector<PlacedBody> bodies{{"drop", Matter::fluid, sphere_shape({0, 0, 0}, 0.3)}};
  const Placement one = place_particles(bodies, options), two = place_particles(bodies, options);
  ASSERT_EQ(one.bodies[0].size(), two.bodies[0].size());
  for (std::size_t i = 0; i < one.bodies[0].size(); ++i) EXPECT_EQ(one.bodies[0].position[i], two.bodies[0].position[i]);
}

TEST(PlaceParticles, AMillionLatticePointsTakeSeconds) {
  PlacementOptions options;
  options.spacing = 0.01;
  const Placement placement = place_particles({{"block", Matter::fluid, box_shape({0, 0, 0}, {1, 1, 1})}}, options);
  EXPECT_EQ(placement.bodies[0].size(), 1'000'000u);
  EXPECT_LT(placement.seconds, 10);
}

}  // namespace
