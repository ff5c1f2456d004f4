// Probes against fields whose values are known: linear velocity and pressure up to the walls, rigid and linear motion of elastic bodies,
// flow through a plane, energy, volume, front.
#include "sim/probes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/fluid_scenes.h"
#include "sim/point_fit.h"

namespace {

using sim::Quantity;
using Vector2 = sim::Vector<2>;

constexpr double l0 = 0.1;

struct Cells {
  int x0, x1, y0, y1;  // cell indices, half open
};

void add_body(sim::SceneDescription<2>& scene, const std::string& name, sim::Kind kind, const Cells& cells, double wall_top = 0) {
  sim::Body body;
  body.name = name, body.kind = kind, body.first = static_cast<std::int64_t>(scene.particles.size());
  body.fluid.density = 1000, body.elastic.density = 2000, body.elastic.youngs_modulus = 1e5, body.elastic.poisson_ratio = 0.3;
  auto& p = scene.particles;
  for (int j = cells.y0; j < cells.y1; ++j)
    for (int i = cells.x0; i < cells.x1; ++i) {
      const Vector2 x((i + 0.5) * l0, (j + 0.5) * l0);
      p.position.push_back(x);
      p.velocity.push_back(Vector2::Zero());
      p.kind.push_back(kind);
      p.body.push_back(static_cast<std::int32_t>(scene.bodies.size()));
      p.volume.push_back(l0 * l0);
      p.normal.push_back(kind == sim::Kind::wall ? Vector2(Vector2::UnitY()) : Vector2(Vector2::Zero()));
      p.depth.push_back(kind == sim::Kind::wall ? wall_top - x.y() : 0);
      Vector2 area = Vector2::Zero();
      if (kind == sim::Kind::elastic) {
        area.x() = (i == cells.x1 - 1 ? l0 : 0) - (i == cells.x0 ? l0 : 0);
        area.y() = (j == cells.y1 - 1 ? l0 : 0) - (j == cells.y0 ? l0 : 0);
        p.depth.back() = area.norm() > 0 ? l0 / 2 : 1.5 * l0;
      }
      p.surface_area.push_back(area);
      p.fixed.push_back(0);
      p.stiffness_scale.push_back(1);
      p.fibre.push_back(Vector2::Zero());
    }
  body.count = static_cast<std::int64_t>(p.size()) - body.first;
  scene.bodies.push_back(body);
}

sim::Probe<2> probe(Quantity quantity, std::vector<Vector2> points, int body = -1) {
  sim::Probe<2> result;
  result.name = "p", result.quantity = quantity, result.points = std::move(points), result.body = body, result.line = true;
  return result;
}

sim::SceneDescription<2> water_on_a_floor() {
  sim::SceneDescription<2> scene;
  scene.spacing = l0;
  add_body(scene, "floor", sim::Kind::wall, {-4, 24, -3, 0});
  add_body(scene, "water", sim::Kind::fluid, {0, 20, 0, 12});
  return scene;
}

TEST(Probes, LinearVelocityIsExactInsideAndAtTheWall) {
  sim::SceneDescription<2> description = water_on_a_floor();
  // no slip on the floor: v = (a y, 0)
  description.probes = {probe(Quantity::velocity, {{0.93, 0.61}, {0.95, 0.03}, {1.0, 0.0}, {1.0, -0.12}})};
  const auto scene = sim::make_scene(description);
  sim::State<2> state = sim::initial_state(scene);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state.kind[i] == sim::Kind::fluid) state.velocity[i] = Vector2(3 * state.position[i].y(), 0);
  sim::Probes<2> probes(scene, state);
  const std::vector<double> v = probes.evaluate(scene, state)[0];
  EXPECT_NEAR(v[0], 3 * 0.61, 1e-9);
  EXPECT_NEAR(v[2], 3 * 0.03, 1e-9);
  EXPECT_EQ(v[4], 0);  // on the wall: the wall's
  EXPECT_EQ(v[6], 0);  // in the wall
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(v[2 * k + 1], 0, 1e-9);
}

TEST(Probes, LinearPressureIsExactDownToTheFloorAndZeroInTheAir) {
  sim::SceneDescription<2> description = water_on_a_floor();
  description.probes = {probe(Quantity::pressure, {{0.93, 0.61}, {1.0, 0.0}, {1.04, -0.11}, {1.0, 1.9}, {5, 9}})};
  const auto scene = sim::make_scene(description);
  sim::State<2> state = sim::initial_state(scene);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state.kind[i] == sim::Kind::fluid) state.pressure[i] = 1e4 * (1.2 - state.position[i].y());
  sim::Probes<2> probes(scene, state);
  const std::vector<double> p = probes.evaluate(scene, state)[0];
  EXPECT_NEAR(p[0], 1e4 * 0.59, 1e-6);
  EXPECT_NEAR(p[1], 1.2e4, 1e-6);
  EXPECT_NEAR(p[2], 1.2e4, 1e-6);
  EXPECT_EQ(p[3], 0);
  EXPECT_EQ(p[4], 0);
}

TEST(Probes, ElasticPointsFollowALinearDisplacementUpToTheSurface) {
  sim::SceneDescription<2> description;
  description.spacing = l0;
  add_body(description, "block", sim::Kind::elastic, {0, 20, 0, 6});
  description.probes = {probe(Quantity::displacement, {{0, 0}, {2, 0.6}, {0.97, 0.31}}, 0), probe(Quantity::position, {{2, 0.6}}, 0),
                        probe(Quantity::stress, {{2, 0.6}, {1.0, 0.3}}, 0)};
  const auto scene = sim::make_scene(description);
  sim::State<2> state = sim::initial_state(scene);
  const auto displacement = [](const Vector2& x) { return Vector2(1e-3 * x.x() + 2e-3 * x.y() + 0.5, -1e-3 * x.x()); };
  for (std::size_t i = 0; i < state.size(); ++i) state.position[i] += displacement(state.position[i]);
  sim::Probes<2> probes(scene, sim::initial_state(scene));
  const auto values = probes.evaluate(scene, state);
  const std::vector<Vector2> points{{0, 0}, {2, 0.6}, {0.97, 0.31}};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(values[0][2 * k], displacement(points[k]).x(), 1e-10);
    EXPECT_NEAR(values[0][2 * k + 1], displacement(points[k]).y(), 1e-10);
  }
  EXPECT_NEAR(values[1][0], 2 + displacement({2, 0.6}).x(), 1e-10);
  // neo-Hookean at small strain: sigma = lambda tr eps + 2 G eps, plane strain; eps_xx = 1e-3, eps_xy = 5e-4
  const double G = 1e5 / 2.6, lambda = 0.3 * 1e5 / (1.3 * 0.4);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(values[2][8 * k], (lambda + 2 * G) * 1e-3, 0.01 * (lambda + 2 * G) * 1e-3);
    EXPECT_NEAR(values[2][8 * k + 1], lambda * 1e-3, 0.02 * lambda * 1e-3);
    EXPECT_NEAR(values[2][8 * k + 3], G * 1e-3, 0.02 * G * 1e-3);
  }
}

TEST(Probes, FlowRateOfAParabolaIsItsIntegral) {
  // Between plates at y = -0.5 and 0.5, eight particles across: their velocities alone sum up to 0.8 % too much.
  sim::testing::FluidScene<2> channel = sim::testing::channel(0.5, 8, {1000, sim::Newtonian{1000}}, 0);
  sim::Probe<2> flow = probe(Quantity::flow_rate, {});
  flow.plane_point = {0.4, 0}, flow.plane_normal = {1, 0};
  channel.description.probes = {flow};
  const auto scene = sim::make_scene(channel.description);
  sim::State<2> state = sim::initial_state(scene);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state.kind[i] == sim::Kind::fluid) state.velocity[i] = Vector2(1 - 4 * std::pow(state.position[i].y(), 2), 0);
  sim::Probes<2> probes(scene, state);
  EXPECT_NEAR(probes.evaluate(scene, state)[0][0], 2.0 / 3.0, 1e-5);  // a link's part in the fluid counts as a fifth at least
}

TEST(Probes, VolumeOfAFluidThatTheSpacingDoesNotDivideIsTheBodys) {
  sim::SceneDescription<2> description = water_on_a_floor();
  for (std::size_t i = 0; i < description.particles.size(); ++i)
    if (description.particles.kind[i] == sim::Kind::fluid) description.particles.volume[i] *= 0.96;
  description.probes = {probe(Quantity::volume, {}, 1)};
  const auto scene = sim::make_scene(description);
  const sim::Lattice even = sim::make_lattice(2, l0, scene.lattice.radius);
  EXPECT_NEAR(scene.fluid_particle_volume, 0.96 * l0 * l0, 1e-12);
  EXPECT_EQ(scene.lattice.number_density, even.number_density);  // below a free surface it is not fitted
  const sim::State<2> state = sim::initial_state(scene);
  sim::Probes<2> probes(scene, state);
  EXPECT_NEAR(probes.evaluate(scene, state)[0][0], 0.96 * 2 * 1.2, 1e-12);
}

TEST(Probes, AFullVesselHasTheNumberDensityOfItsParticlesVolume) {
  sim::SceneDescription<2> description = sim::testing::channel(0.5, 8, {1000, sim::Newtonian{1000}}, 0).description;
  for (std::size_t i = 0; i < description.particles.size(); ++i)
    if (description.particles.kind[i] == sim::Kind::fluid) description.particles.volume[i] *= 0.96;
  const double spacing = description.spacing;
  const auto scene = sim::make_scene(description);
  EXPECT_NEAR(scene.fluid_particle_volume, 0.96 * spacing * spacing, 1e-12);
  EXPECT_NEAR(scene.lattice.number_density, sim::make_lattice(2, spacing, scene.lattice.radius).number_density / 0.96, 1e-9);
}

TEST(Probes, FlowRateEnergyVolumeAndFront) {
  sim::SceneDescription<2> description = water_on_a_floor();
  sim::Probe<2> flow = probe(Quantity::flow_rate, {});
  flow.plane_point = {1.03, 0.6}, flow.plane_normal = {1, 0};
  sim::Probe<2> front = probe(Quantity::front, {});
  front.axis = 0;
  description.probes = {flow, probe(Quantity::energy, {}, 1), probe(Quantity::volume, {}, 1), front};
  const auto scene = sim::make_scene(description);
  sim::State<2> state = sim::initial_state(scene);
  for (std::size_t i = 0; i < state.size(); ++i)
    if (state.kind[i] == sim::Kind::fluid) state.velocity[i] = Vector2(2 * state.position[i].y(), 0);
  sim::Probes<2> probes(scene, state);
  auto values = probes.evaluate(scene, state);
  EXPECT_NEAR(values[0][0], 1.2 * 1.2, 1e-9);  // integral of 2 y over the height
  double kinetic = 0;
  for (int j = 0; j < 12; ++j) kinetic += 20 * 0.5 * 1000 * l0 * l0 * std::pow(2 * (j + 0.5) * l0, 2);
  EXPECT_NEAR(values[1][0], kinetic, 1e-9 * kinetic);
  EXPECT_EQ(values[1][2], 0);
  EXPECT_NEAR(values[2][0], 2 * 1.2, 1e-12);
  EXPECT_NEAR(values[3][0], 2, 1e-12);
  state.position.back() = {9, 5};  // a stray drop is no front
  values = probes.evaluate(scene, state);
  EXPECT_LT(values[3][0], 2.1);
}

TEST(Probes, AreNeverEmptyOrNaN) {
  sim::SceneDescription<2> description = water_on_a_floor();
  std::vector<Vector2> anywhere;
  for (int k = 0; k < 40; ++k) anywhere.emplace_back(-0.6 + 0.09 * k, -0.5 + 0.05 * k);
  for (Quantity quantity : {Quantity::velocity, Quantity::pressure, Quantity::density, Quantity::position})
    description.probes.push_back(probe(quantity, anywhere));
  const auto scene = sim::make_scene(description);
  sim::State<2> state = sim::initial_state(scene);
  sim::Probes<2> probes(scene, state);
  const auto values = probes.evaluate(scene, state);
  ASSERT_EQ(values.size(), 4u);
  EXPECT_EQ(values[0].size(), 80u);
  EXPECT_EQ(values[1].size(), 40u);
  for (const auto& one : values)
    for (double value : one) EXPECT_TRUE(std::isfinite(value));
  EXPECT_NEAR(values[2][20], 1000, 20);  // density in the middle of the water
}

TEST(PointFit, QuadraticFieldsAreExactWhereThereAreEnoughSamples) {
  std::vector<Vector2> offset;
  for (int i = -2; i <= 2; ++i)
    for (int j = 0; j <= 3; ++j) offset.emplace_back(0.3 * i + 0.02 * j, 0.3 * j + 0.1);  // one-sided
  const std::vector<double> weight = sim::fit_weights<2>(offset, 1.0, true);
  double one = 0, linear = 0, square = 0;
  for (std::size_t k = 0; k < offset.size(); ++k) {
    one += weight[k];
    linear += weight[k] * (offset[k].x() - 2 * offset[k].y());
    square += weight[k] * (offset[k].x() * offset[k].y() + offset[k].y() * offset[k].y());
  }
  EXPECT_NEAR(one, 1, 1e-12);
  EXPECT_NEAR(linear, 0, 1e-10);
  EXPECT_NEAR(square, 0, 1e-10);
}

TEST(PointFit, SamplesOnALineAreConstantAcrossIt) {
  const std::vector<Vector2> offset{{-0.3, 0.5}, {0, 0.5}, {0.3, 0.5}};
  const std::vector<double> weight = sim::fit_weights<2>(offset, 1.0, false);
  EXPECT_NEAR(weight[0] * 1 + weight[1] * 2 + weight[2] * 3, 2, 1e-12);
}

}  // namespace
