#include "sim/walls.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sim/fluid_scenes.h"
#include "sim/operators.h"
#include "sim/step.h"

namespace sim {
namespace {

// Two layers of wall outside a circle (2-D) or a pipe along z, and one drop of fluid on the axis.
template <int D>
SceneDescription<D> round_wall(double radius, double spacing) {
  testing::FluidScene<D> scene;
  scene.description.spacing = spacing;
  scene.start_body("wall", Kind::wall);
  for (int layer = 0; layer < 2; ++layer) {
    const double r = radius + (layer + 0.5) * spacing;
    const int count = static_cast<int>(std::lround(2 * M_PI * r / spacing));
    for (int k = 0; k < count; ++k)
      for (int z = 0; z < (D == 3 ? 7 : 1); ++z) {
        const double angle = 2 * M_PI * (k + 0.5 * layer) / count;
        Vector<D> x = Vector<D>::Zero(), normal = Vector<D>::Zero();
        normal[0] = -std::cos(angle), normal[1] = -std::sin(angle);
        x = -r * normal;
        if (D == 3) x[D - 1] = (z - 3) * spacing;
        scene.add(x, Vector<D>::Zero(), normal, r - radius);
      }
  }
  scene.start_body("drop", Kind::fluid);
  scene.add(Vector<D>::Zero());
  return scene.description;
}

TEST(WallCurvature, IsOneOverTheRadiusRoundAPipeAndNoneAlongIt) {
  for (const double radius : {5.0, 12.0}) {
    const double tolerance = 6.25 / (4 * radius * radius * radius);  // a circle over its parabola: (s / 2R)², s up to 2.5 l0
    const Scene<3> pipe = make_scene(round_wall<3>(radius, 1.0));
    ASSERT_EQ(pipe.curvature.size(), static_cast<std::size_t>(pipe.first_fluid));
    for (std::int64_t i = 0; i < pipe.first_fluid; ++i) {
      const Vector<3>& x = pipe.description.particles.position[i];
      const Vector<3>& normal = pipe.description.particles.normal[i];
      if (std::abs(x[2]) > 1.5) continue;
      const Vector<3> round = normal.cross(Vector<3>::UnitZ());
      EXPECT_NEAR(round.dot(pipe.curvature[i] * round), 1 / radius, tolerance);  // towards the fluid: the wall is hollow
      EXPECT_NEAR(Vector<3>::UnitZ().dot(pipe.curvature[i] * Vector<3>::UnitZ()), 0, tolerance);
    }
    const Scene<2> circle = make_scene(round_wall<2>(radius, 1.0));
    for (std::int64_t i = 0; i < circle.first_fluid; ++i) EXPECT_NEAR(circle.curvature[i].trace(), 1 / radius, tolerance);
  }
}

TEST(WallCurvature, IsAbsentWhereWallsAreFlat) {
  const Scene<2> tank = make_scene(testing::tank(0.1, 12, 12, 12, 8).description);
  EXPECT_TRUE(tank.curvature.empty());
}

TEST(FluidFraction, EndsOnTheCurvedSurface) {
  // From a point in a circle of radius 5 to wall particles behind it: the part of the way is that to the circle.
  const double radius = 5, kappa = 1 / radius;
  for (const double aside : {0.0, 0.1, 0.2, 0.3}) {
    const Vector<2> x(0.0, -4.3), normal(-std::sin(aside), std::cos(aside)), b = -(radius + 0.5) * normal;
    const Vector<2> r = b - x, tangent(normal[1], -normal[0]);
    const Tensor<2> curvature = kappa * tangent * tangent.transpose();
    const double t = fluid_fraction<2>(r, normal, 0.5, 0, r.dot(curvature * r));
    EXPECT_NEAR((x + t * r).norm(), radius, 0.01) << aside;
  }
}

TEST(TurningWall, DragsAtItsSurfaceAndKeepsItsCircle) {
  SceneDescription<2> description = round_wall<2>(5.0, 1.0);
  Motion<2> motion;
  motion.body = 0;
  motion.angular_velocity = TimeTable{{0, 0.1, 0.2}, {3, -3, 3}, true};  // to and fro, many times
  description.motions.push_back(motion);
  const Scene<2> scene = make_scene(description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  for (int s = 0; s < 1001; ++s) {
    move_walls(scene, state, 0.01);
    state.time += 0.01;
  }
  boundary_surfaces(scene, state, work);
  for (std::int64_t i = 0; i < scene.first_fluid; ++i) {
    const Vector<2> surface = state.position[i] + scene.description.particles.depth[i] * work.boundary_normal[i];
    EXPECT_NEAR(surface.norm(), 5, 1e-9);
    EXPECT_NEAR(work.boundary_velocity[i].norm(), 5 * std::abs(motion.angular_velocity.at(state.time)), 1e-9);
    EXPECT_NEAR(work.boundary_velocity[i].dot(work.boundary_normal[i]), 0, 1e-9);
  }
}

TEST(SlidingWall, ComesInAgainInAPeriodicDomain) {
  // Couette flow between plates, the upper one sliding past its own length several times (exact: linear).
  const double half = 1e-3, speed = 0.1;
  testing::FluidScene<2> channel = testing::channel(half, 10, {1000, Newtonian{0.5}}, 0);
  SceneDescription<2>& description = channel.description;
  auto& rows = description.particles;
  const std::int64_t walls = description.bodies[0].count;
  Body upper = description.bodies[0];  // rows ascend in y: the upper half of the plates' rows is the upper plate
  upper.name = "upper", upper.first = walls / 2, upper.count = walls - walls / 2;
  description.bodies[0].count = walls / 2;
  description.bodies.push_back(upper);
  for (std::int64_t i = upper.first; i < walls; ++i) rows.body[i] = 2;
  Motion<2> motion;
  motion.body = 2;
  motion.velocity[0] = constant_table(speed);
  description.motions.push_back(motion);
  const Scene<2> scene = make_scene(description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  const double end = 3.3 * 2 * half / speed;
  while (state.time < end - 1e-12) step(scene, state, work, end - state.time);
  for (std::size_t i = 0; i < state.size(); ++i) {
    EXPECT_GE(state.position[i][0], -1e-12);
    EXPECT_LT(state.position[i][0], 2 * half);
    if (i >= static_cast<std::size_t>(scene.first_fluid)) {
      EXPECT_NEAR(state.velocity[i][0], speed * (state.position[i][1] + half) / (2 * half), 0.01 * speed);
    }
  }
}

}  // namespace
}  // namespace sim
