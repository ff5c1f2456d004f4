// The ledger against closed forms: free fall, plane Poiseuille flow, a lost particle.
#include "sim/ledger.h"

#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace {

using sim::testing::channel;
using sim::testing::FluidScene;

TEST(Ledger, FreeFallTurnsTheWorkOfGravityIntoKineticEnergy) {
  constexpr double l0 = 0.1, g = 10, end = 0.1;
  FluidScene<2> drop;
  drop.description.spacing = l0;
  drop.description.time.end = end;
  drop.description.gravity = sim::Vector<2>(0, -g);
  drop.description.scheme.maximum_step = 0.002;
  drop.description.scheme.shifting = 0;  // it takes a little at the surface
  drop.start_body("water", sim::Kind::fluid);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 6; ++i) drop.add({(i + 0.5) * l0, (j + 0.5) * l0});
  const auto scene = sim::make_scene(drop.description);
  auto state = sim::initial_state(scene);
  sim::Workspace<2> work, scratch;
  sim::measure_ledger(scene, state, scratch);
  EXPECT_EQ(state.ledger.kinetic_energy, 0);
  while (state.time < end * (1 - 1e-9)) sim::step(scene, state, work, end - state.time);
  sim::measure_ledger(scene, state, scratch);
  const double mass = 36 * 1000 * l0 * l0, exact = 0.5 * mass * g * g * end * end;
  const double first_order = 1.0 / static_cast<double>(state.step);  // of a sum of v dt with v at each step's end
  EXPECT_NEAR(state.ledger.kinetic_energy, exact, 1e-6 * exact);
  EXPECT_NEAR(state.ledger.load_work, exact, 1.01 * first_order * exact);
  EXPECT_GT(state.ledger.load_work, exact);
  EXPECT_EQ(state.ledger.elastic_energy, 0);
  EXPECT_EQ(state.ledger.particles_lost, 0);
  EXPECT_TRUE(sim::over_limits(scene, state).empty());
}

TEST(Ledger, PoiseuilleFlowLosesWhatItsDriveDoes) {
  constexpr double half = 0.01, gradient = 40, viscosity = 0.05, density = 1000;
  auto blood = channel(half, 16, {density, sim::Newtonian{viscosity}}, gradient);
  auto& particles = blood.description.particles;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (particles.kind[i] == sim::Kind::fluid) {
      const double y = particles.position[i][1];
      particles.velocity[i][0] = gradient / (2 * viscosity) * (half * half - y * y);
    }
  blood.description.scheme.maximum_step = 1e-4;
  const auto scene = sim::make_scene(blood.description);
  auto state = sim::initial_state(scene);
  sim::Workspace<2> work;
  for (int k = 0; k < 5; ++k) sim::step(scene, state, work, 1.0);
  // int mu (du/dy)² dy = G int u dy = 2/3 G² h³ / mu, times the length and the time
  const double exact = 2.0 / 3 * gradient * gradient * half * half * half / viscosity * (2 * half) * state.time;
  EXPECT_NEAR(state.ledger.viscous_loss, exact, 0.03 * exact);
  EXPECT_NEAR(state.ledger.load_work, exact, 0.03 * exact);
  EXPECT_EQ(state.ledger.refused_steps, 0);
}

TEST(Ledger, SaysWhichBookIsOverItsLimit) {
  auto blood = channel(0.01, 12, {1000, sim::Newtonian{0.01}}, 0);
  const auto scene = sim::make_scene(blood.description);
  auto state = sim::initial_state(scene);
  sim::Workspace<2> scratch;
  sim::measure_ledger(scene, state, scratch);
  EXPECT_LT(state.ledger.density_error, 1e-9);  // a full lattice
  EXPECT_TRUE(sim::over_limits(scene, state).empty());
  for (auto* column : {&state.position, &state.velocity}) column->pop_back();
  state.id.pop_back(), state.kind.pop_back(), state.body.pop_back(), state.port.pop_back(), state.pressure.pop_back();
  state.ledger.deepest_penetration = 5 * scene.description.spacing;
  sim::measure_ledger(scene, state, scratch);
  EXPECT_EQ(state.ledger.particles_lost, 1);
  const auto lines = sim::over_limits(scene, state);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "ledger: particles lost 1 is over limits.lost = 0");
  EXPECT_EQ(lines[1], "ledger: deepest penetration 5 l0 is over limits.penetration = 4");
}

}  // namespace
