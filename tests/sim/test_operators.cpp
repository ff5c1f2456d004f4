#include "sim/operators.h"

#include <gtest/gtest.h>

#include <random>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace sim {
namespace {

struct Prepared {
  Scene<2> scene;
  State<2> state;
  Workspace<2> work;
};

// A closed, jittered box of thick fluid in walls, with everything up to the moment matrices.
Prepared jittered_tank(double radius) {
  testing::FluidScene<2> box = testing::tank(0.1, 12, 20, 12, 12);
  box.description.scheme.kernel_radius = radius;
  box.description.bodies[1].fluid.rheology = Newtonian{1e6};  // resolved everywhere: no slip counts in full
  Prepared p{make_scene(box.description), {}, {}};
  p.state = initial_state(p.scene);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.015, 0.015);
  for (std::size_t i = static_cast<std::size_t>(p.scene.first_fluid); i < p.state.size(); ++i)
    p.state.position[i] += Vector<2>(jitter(random), jitter(random));
  find_neighborhood(p.scene, p.state, p.work);
  return p;
}

TEST(Operators, GradientOfALinearVelocityIsExactBesideWallsToo) {
  for (double radius : {2.1, 3.1}) {
    Prepared p = jittered_tank(radius);
    // Zero on the floor y = 0 (its true surface), linear above: what no slip asks for. Columns near the side walls are left out.
    for (std::size_t i = 0; i < p.state.size(); ++i) p.state.velocity[i].setZero();
    for (std::size_t i = static_cast<std::size_t>(p.scene.first_fluid); i < p.state.size(); ++i)
      p.state.velocity[i] = Vector<2>(3 * p.state.position[i][1], 0);
    velocity_gradients(p.scene, p.state, p.work);
    int checked = 0;
    for (std::size_t i = static_cast<std::size_t>(p.scene.first_fluid); i < p.state.size(); ++i) {
      const Vector<2>& x = p.state.position[i];
      if (x[0] < 0.35 || x[0] > 0.85 || x[1] > 0.8) continue;
      // Nearer than 0.7 l0 to the floor some samples lie below the least fluid_fraction of 0.2.
      const double tolerance = x[1] > 0.07 ? 1e-9 : 0.02;
      EXPECT_NEAR(p.work.velocity_gradient[i](0, 1), 3, tolerance);
      EXPECT_NEAR(p.work.velocity_gradient[i].trace(), 0, tolerance);
      ++checked;
    }
    EXPECT_GT(checked, 20);
  }
}

TEST(Operators, UnresolvedSlipIsNoDivergence) {
  testing::FluidScene<2> box = testing::tank(0.1, 12, 20, 12, 12);
  box.description.bodies[1].fluid.rheology = Newtonian{0};
  const Scene<2> scene = make_scene(box.description);
  State<2> state = initial_state(scene);
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) state.velocity[i] = Vector<2>(2, 0);
  Workspace<2> work;
  find_neighborhood(scene, state, work);
  velocity_gradients(scene, state, work);
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
    if (state.position[i][0] > 0.35 && state.position[i][0] < 0.85) {
      EXPECT_LT(work.velocity_gradient[i].norm(), 1e-9);
    }
}

TEST(Operators, FluidFractionIsWhereTheTrueSurfaceLies) {
  const Vector<2> up(0, 1);
  EXPECT_NEAR(fluid_fraction<2>({0, -1}, up, 0.25), 0.75, 1e-15);
  EXPECT_NEAR(fluid_fraction<2>({3, -1}, up, 0.5), 0.5, 1e-15);       // oblique: the same plane
  EXPECT_EQ(fluid_fraction<2>({0, -1}, up, 0), 1);                    // a shell's particle lies on its surface
  EXPECT_NEAR(fluid_fraction<2>({0, 2}, up, 0.5, 1.5), 0.25, 1e-15);  // from the other side of a thin wall: its far face
  EXPECT_EQ(fluid_fraction<2>({0, -0.5}, up, 0.49), 0.2);             // never less
}

TEST(Operators, EigenvaluesAreLiftedToTheFloor) {
  Tensor<2> moment;
  moment << 2, 0, 0, 0.01;
  const Tensor<2> inverse = floored_inverse<2>(moment, 0.1);
  EXPECT_NEAR(inverse(0, 0), 0.5, 1e-12);
  EXPECT_NEAR(inverse(1, 1), 10, 1e-9);
}

TEST(NumberDensity, IsOneInTheLatticeAndMarksOnlyTheOutermostLayer) {
  for (double radius : {2.1, 3.1}) {
    testing::FluidScene<2> box = testing::tank(0.1, 12, 20, 12, 12);
    box.description.scheme.kernel_radius = radius;
    const Scene<2> scene = make_scene(box.description);
    const State<2> state = initial_state(scene);
    Workspace<2> work;
    find_neighborhood(scene, state, work);
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
      const double rows_below_surface = (1.2 - state.position[i][1]) / 0.1 - 0.5;
      EXPECT_EQ(work.surface[i] == 1, rows_below_surface < 0.5) << state.position[i].transpose();
      if (rows_below_surface > 3.5) {
        EXPECT_NEAR(work.number_density[i], 1, 1e-12);
      }
    }
  }
}

// Blood whose viscosity falls with the shear rate, sheared at a rate that grows from plate to plate: each link takes the viscosity at its
// middle, where the rate is the mean of the ends'.
TEST(ParticleViscosity, OfALinkIsThatAtTheMeanRate) {
  const HerschelBulkley blood{0.009, 0.86, 0.0175};
  const Scene<2> scene = make_scene(testing::channel(0.5, 10, {1060, blood}, 0).description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
    state.velocity[i] = Vector<2>(0.05 * std::pow(state.position[i][1] + 1, 2), 0);  // rate 0.1 (y + 1)
  find_neighborhood(scene, state, work);
  velocity_gradients(scene, state, work);
  particle_viscosity(scene, state, work);
  ASSERT_EQ(work.pair_viscosity.size(), work.neighbors.index.size());
  int links = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const auto j = static_cast<std::size_t>(work.neighbors.index[k]);
      if (std::abs(state.position[i][1]) > 0.16 || std::abs(state.position[j][1]) > 0.16) continue;  // far from the plates
      const double rate = 0.1 * (0.5 * (state.position[i][1] + state.position[j][1]) + 1);
      const double expected = herschel_bulkley_viscosity(blood, rate, 1000);
      EXPECT_NEAR(work.pair_viscosity[k], expected, 1e-9 * expected);
      ++links;
    }
  EXPECT_GT(links, 50);
}

}  // namespace
}  // namespace sim
