// The ledger against closed forms: free fall, plane Poiseuille flow, a lost particle.
#include "sim/ledger.h"

#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace {

using sim::testing::channel;
using sim::testing::FluidScene;

TEST(Ledger, FindsEnergyThatNobodyGave) {
  FluidScene<2> drop;
  drop.description.spacing = 0.1;
  drop.description.time.end = 1;
  drop.description.gravity = sim::Vector<2>(0, -10);
  drop.start_body("water", sim::Kind::fluid);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 6; ++i) drop.add({(i + 0.5) * 0.1, (j + 0.5) * 0.1});
  const auto scene = sim::make_scene(drop.description);
  auto before = sim::initial_state(scene);
  for (auto& v : before.velocity) v = {1, 0};
  auto after = before;
  sim::Workspace<2> scratch;
  EXPECT_EQ(sim::runaway_energy(scene, before, after, scratch), 0);
  for (auto& v : after.velocity) v = {2, 0};
  // 36 particles of 10 kg/m: 180 J/m before, 720 J/m after; half of what there was and blood at 0.1 m/s (1.8 J/m) are free.
  EXPECT_NEAR(sim::runaway_energy(scene, before, after, scratch), 540 - 90 - 1.8, 1e-9);
  after.ledger.load_work = 500;
  EXPECT_EQ(sim::runaway_energy(scene, before, after, scratch), 0);
}

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

// Inviscid blood in a straight channel of length L and height H, with a pressure difference between its open ends.
FluidScene<2> open_channel(double spacing, int along, int across, double pressure) {
  FluidScene<2> scene;
  scene.description.spacing = spacing;
  const double height = across * spacing, length = along * spacing;
  scene.start_body("plates", sim::Kind::wall);
  for (int j = -4; j < across + 4; ++j)
    for (int i = 0; i < along; ++i) {
      if (j >= 0 && j < across) continue;
      const double y = (j + 0.5) * spacing;
      scene.add({(i + 0.5) * spacing, y}, sim::Vector<2>::Zero(), {0, j < 0 ? 1.0 : -1.0}, j < 0 ? -y : y - height);
    }
  scene.start_body("blood", sim::Kind::fluid);
  scene.description.bodies.back().fluid = {1000, sim::Newtonian{0}};
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i) scene.add({(i + 0.5) * spacing, (j + 0.5) * spacing});
  sim::Port<2> in, out;
  in.name = "in", in.point = {0, 0.5 * height}, in.normal = {-1, 0}, in.radius = 0.5 * height, in.table = sim::constant_table(pressure);
  out.name = "out", out.point = {length, 0.5 * height}, out.normal = {1, 0}, out.radius = 0.5 * height;
  out.table = sim::constant_table(0);
  scene.description.ports = {in, out};
  return scene;
}

// du/dt = dp / (rho L); what flows in carries as much kinetic energy as what flows out: E = dp H int u dt.
TEST(Ledger, PortsDoTheWorkThatSpeedsAColumnUp) {
  constexpr double l0 = 0.001, pressure = 200, end = 0.03;
  const auto scene = sim::make_scene(open_channel(l0, 20, 8, pressure).description);
  auto state = sim::initial_state(scene);
  sim::Workspace<2> work, scratch;
  while (state.time < end * (1 - 1e-9)) sim::step(scene, state, work, end - state.time);
  sim::measure_ledger(scene, state, scratch);
  const double speed = pressure / (1000 * 20 * l0) * end, exact = 0.5 * 1000 * 20 * l0 * 8 * l0 * speed * speed;
  EXPECT_GT(state.ledger.particles_in, 16);  // several layers came and went
  EXPECT_NEAR(state.ledger.kinetic_energy, exact, 0.02 * exact);
  EXPECT_NEAR(state.ledger.port_work, exact, 0.02 * exact);
}

// A leaflet across the channel, held at both walls, takes a sudden pressure difference and swings: energy goes to and fro between blood,
// leaflet and ports. What the books do not name stays a few percent of what the ports gave and took.
TEST(Ledger, SwingingLeafletKeepsItsBooks) {
  constexpr double l0 = 0.001, pressure = 200, end = 0.04;
  constexpr int along = 25, across = 12;
  FluidScene<2> scene;
  const auto empty = open_channel(l0, along, across, pressure);
  scene.description = empty.description;
  scene.description.particles = {};
  scene.description.bodies.clear();
  scene.start_body("leaflet", sim::Kind::shell);
  sim::ElasticMaterial tissue;
  tissue.density = 1060, tissue.law = sim::ElasticLaw::neo_hookean, tissue.youngs_modulus = 5e5, tissue.poisson_ratio = 0.45;
  tissue.thickness = 0.5e-3;
  scene.description.bodies.back().elastic = tissue;
  for (int s = 0; s < across; ++s) {
    scene.add({12.5 * l0, (s + 0.5) * l0}, sim::Vector<2>::Zero(), {1, 0});
    scene.description.particles.volume.back() = l0;
    scene.description.particles.fixed.back() = s == 0 || s == across - 1 ? 3 : 0;
  }
  sim::ShellMesh<2> mesh;
  mesh.body = 0;
  for (int s = 0; s + 1 < across; ++s) mesh.elements.push_back({s + 1, s});  // the segment's direction turned by +90 degrees is +x
  scene.description.shell_meshes = {mesh};
  for (std::size_t b = 0; b < 2; ++b) {
    const sim::Body& body = empty.description.bodies[b];
    scene.start_body(body.name, body.kind);
    scene.description.bodies.back().fluid = body.fluid;
    for (auto i = static_cast<std::size_t>(body.first); i < static_cast<std::size_t>(body.first + body.count); ++i) {
      const auto& p = empty.description.particles;
      if (body.kind == sim::Kind::fluid && std::abs(p.position[i][0] - 12.5 * l0) < 0.1 * l0) continue;  // the leaflet's layer
      scene.add(p.position[i], p.velocity[i], p.normal[i], p.depth[i]);
    }
  }
  const auto built = sim::make_scene(scene.description);
  auto state = sim::initial_state(built);
  sim::Workspace<2> work, scratch;
  double given = 0, worst = 0, largest_elastic = 0;
  while (state.time < end * (1 - 1e-9)) {
    sim::step(built, state, work, end - state.time);
    sim::measure_ledger(built, state, scratch);
    const sim::Ledger& l = state.ledger;
    given = std::max(given, std::abs(l.port_work));
    largest_elastic = std::max(largest_elastic, l.elastic_energy);
    worst = std::max(worst, std::abs(l.kinetic_energy + l.elastic_energy - l.port_work));
  }
  EXPECT_EQ(state.ledger.particles_lost, 0);
  EXPECT_GT(largest_elastic, 0.3 * given);
  EXPECT_LT(worst, 0.05 * given);
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
  EXPECT_EQ(lines[1], "ledger: deepest penetration 5 l0 is over limits.penetration = 1");
}

}  // namespace
