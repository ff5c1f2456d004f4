// Open ends: blood between two pressures against the closed form.
#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/ports.h"
#include "sim/step.h"

namespace sim {
namespace {

// Blood between plates, open at x = 0 and x = length, `across` particles wide, with a pressure at each end.
testing::FluidScene<2> open_channel(double half, int across, double length, const FluidMaterial& blood, double in, double out) {
  testing::FluidScene<2> scene = testing::plates(half, across, static_cast<int>(std::lround(length * across / (2 * half))), 4, blood);
  for (const bool inlet : {true, false}) {
    Port<2> port;
    port.name = inlet ? "in" : "out", port.radius = half;
    port.point = {inlet ? 0 : length, 0}, port.normal = {inlet ? -1 : 1, 0};
    port.table.time = {0}, port.table.value = {inlet ? in : out};
    scene.description.ports.push_back(port);
  }
  return scene;
}

TEST(OpenChannel, FlowsBetweenTwoPressuresAsPoiseuilleSays) {
  const double half = 0.01, length = 0.06, viscosity = 1, difference = 60;  // developed after half²/nu = 0.1 s; Re 1
  testing::FluidScene<2> channel = open_channel(half, 10, length, {1000, Newtonian{viscosity}}, difference, 0);
  channel.description.scheme.kernel_radius = 2.1, channel.description.scheme.maximum_step = 1e-3;
  const Scene<2> scene = make_scene(channel.description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  const auto run_until = [&](double end) {
    while (state.time < end - 1e-12) step(scene, state, work, end - state.time);
  };
  run_until(0.5);
  const double gradient = difference / length, fastest = gradient * half * half / (2 * viscosity);
  const double before_in = state.port_volume[0], before_out = state.port_volume[1];
  run_until(1.5);
  const double exact = fastest * 2 / 3 * 2 * half;  // m²/s
  EXPECT_NEAR((state.port_volume[0] - before_in) / exact, 1, 0.03);
  EXPECT_NEAR((state.port_volume[1] - before_out) / exact, -1, 0.03);
  // The profile is the parabola at the inlet's layers too, and they are full: three rows of ten.
  double error = 0, size = 0, count = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    if (state.port[i] != 0) continue;
    const double y = state.position[i][1], parabola = fastest * (1 - y * y / (half * half));
    error += std::pow(state.velocity[i][0] - parabola, 2), size += parabola * parabola, ++count;
  }
  EXPECT_LT(std::sqrt(error / size), 0.06);
  EXPECT_NEAR(count, 30, 2);
}

TEST(OpenChannel, APortCarriesTheBloodsMeanFlowAndNotItsNoise) {
  const double half = 0.01;
  testing::FluidScene<2> channel = open_channel(half, 10, 0.04, {1000, Newtonian{1}}, 0, 0);
  const Scene<2> scene = make_scene(channel.description);
  State<2> state = initial_state(scene);
  const double noise = 0.01, flow = 0.001;  // m/s
  double inside = 0, count = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    state.velocity[i] = {flow + noise * std::sin(12.9898 * static_cast<double>(i)), 0};
    if (state.kind[i] == Kind::fluid && state.position[i][0] < 2 * scene.description.spacing) inside += state.velocity[i][0], ++count;
  }
  prescribe_ports(scene, state, 1e-4);
  double mean = 0, rows = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    if (state.port[i] != 0) continue;
    mean += state.velocity[i][0], ++rows;
    EXPECT_GE(state.velocity[i][0] * inside, 0);
  }
  EXPECT_NEAR(mean / rows, inside / count, 1e-12);
}

}  // namespace
}  // namespace sim
