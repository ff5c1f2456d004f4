// The whole fluid solver against closed forms and bounds. Coarse, so that the suite stays fast; cusp validate runs the fine ones.
#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace sim {
namespace {

void run_until(const Scene<2>& scene, State<2>& state, Workspace<2>& work, double end) {
  while (state.time < end - 1e-12) step(scene, state, work, end - state.time);
}

TEST(FluidAtRest, KeepsHydrostaticPressureAndDoesNotCreep) {
  for (double radius : {2.1, 3.1}) {
    testing::FluidScene<2> tank = testing::tank(0.2 / 16, 13, 22, 13, 16);
    tank.description.scheme.kernel_radius = radius;
    const Scene<2> scene = make_scene(tank.description);
    State<2> state = initial_state(scene);
    Workspace<2> work;
    run_until(scene, state, work, 0.5);
    double squares = 0, fastest = 0, count = 0;
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i, ++count) {
      squares += std::pow(state.pressure[i] - 9810 * (0.2 - state.position[i][1]), 2);
      fastest = std::max(fastest, state.velocity[i].norm());
    }
    EXPECT_LT(std::sqrt(squares / count) / 1962, 0.005) << "radius " << radius;
    EXPECT_LT(fastest, 0.02) << "radius " << radius;  // 1.4 % of sqrt(g H)
  }
}

// Speed of Herschel-Bulkley fluid between plates (reference/hb_profiles.csv), m/s.
double plane_speed(const HerschelBulkley& blood, double gradient, double half, double y) {
  const double power = 1 / blood.index + 1;
  auto term = [&](double at) { return std::pow(std::max(gradient * at - blood.yield_stress, 0.0), power); };
  return (term(half) - term(std::abs(y))) / (gradient * std::pow(blood.consistency, 1 / blood.index) * power);
}

void compare_channel(const HerschelBulkley& blood, const Rheology& rheology, double end) {
  const double half = 1e-3, gradient = 100;
  testing::FluidScene<2> channel = testing::channel(half, 16, {1060, rheology}, gradient);
  channel.description.scheme.kernel_radius = 2.1;
  const Scene<2> scene = make_scene(channel.description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  run_until(scene, state, work, end);
  double error = 0, size = 0, flow = 0, exact_flow = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    const double exact = plane_speed(blood, gradient, half, state.position[i][1]);
    error += (state.velocity[i] - Vector<2>(exact, 0)).squaredNorm();
    size += exact * exact;
    flow += state.velocity[i][0];
    exact_flow += exact;
  }
  EXPECT_LT(std::sqrt(error / size), 0.015);
  EXPECT_NEAR(flow / exact_flow, 1, 0.01);
}

TEST(PlanePoiseuille, NewtonianProfileAndFlow) { compare_channel({0.0035, 1, 0}, Newtonian{0.0035}, 0.6); }
TEST(PlanePoiseuille, HerschelBulkleyProfileAndFlow) {
  const HerschelBulkley blood{0.0089721, 0.8601, 0.0175};
  compare_channel(blood, blood, 0.6);
}

TEST(DamBreak, GainsNoEnergyAndNoParticleOutrunsTheInviscidBound) {
  const double height = 0.2, l0 = height / 20;
  testing::FluidScene<2> dam = testing::tank(l0, 80, 40, 10, 20);
  dam.description.scheme.kernel_radius = 3.1;
  const Scene<2> scene = make_scene(dam.description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  const std::size_t particles = state.size();
  run_until(scene, state, work, 0.2);
  ASSERT_EQ(state.size(), particles);
  double energy = 0, front = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    energy += 0.5 * state.velocity[i].squaredNorm() + 9.81 * state.position[i][1];
    front = std::max(front, state.position[i][0] + 0.5 * l0);
    EXPECT_LT(state.velocity[i].norm(), 2 * std::sqrt(9.81 * height));
  }
  EXPECT_LT(energy, 1.02 * 200 * 9.81 * 0.5 * height);
  EXPECT_GT(front, 3.0 * 0.1);  // Martin & Moyce and Koshizuka & Oka: 3.1 to 3.4 columns at t sqrt(2g/a) = 2.8
  EXPECT_LT(front, 3.9 * 0.1);
}

}  // namespace
}  // namespace sim
