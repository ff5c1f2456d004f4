// Water with a free surface: rest and small waves, over many steps and with steps cut short. Each projection over an uneven arrangement may
// feed the shortest waves of a surface a little; what keeps them down must hold at any step.
#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace sim {
namespace {

double kinetic_energy(const Scene<2>& scene, const State<2>& state) {  // m²/s² times particles
  double sum = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) sum += 0.5 * state.velocity[i].squaredNorm();
  return sum;
}

TEST(FreeSurface, WaterFromAnUnevenStartComesToRestAndStaysThere) {
  testing::FluidScene<2> tank = testing::tank(0.2 / 15, 15, 20, 15, 15);
  std::uint64_t dice = 1;
  for (std::size_t i = static_cast<std::size_t>(tank.description.bodies[1].first); i < tank.description.particles.position.size(); ++i)
    for (int d = 0; d < 2; ++d) {
      dice = dice * 6364136223846793005u + 1442695040888963407u;
      tank.description.particles.position[i][d] += tank.description.spacing * 0.1 * (static_cast<double>(dice >> 33) / (1u << 30) - 1);
    }
  const Scene<2> scene = make_scene(tank.description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  double fastest = 0;  // m/s, root mean square
  while (state.time < 6 - 1e-12) {
    step(scene, state, work, 6 - state.time);
    if (state.time > 1) fastest = std::max(fastest, std::sqrt(2 * kinetic_energy(scene, state) / 225));
  }
  EXPECT_LT(fastest, 0.03);  // 2 % of sqrt(g H); one particle that falls by a spacing makes it 0.5 m/s
}

// Linear waves in water as deep as they are long: w² = g k tanh(k h) (Lamb, Hydrodynamics, 228). The uppermost row moves half a spacing
// below the surface, where the wave is lower by exp(-k l0/2): the period comes out longer by k l0/4, 8 % at 20 particles a wave.
TEST(FreeSurface, AStandingWaveKeepsItsPeriodAndItsDecayDoesNotHangOnTheStep) {
  constexpr double pi = 3.14159265358979;
  const double length = 0.2, wave_number = 2 * pi / length, speed = 0.08;
  const double period = 2 * pi / std::sqrt(9.81 * wave_number * std::tanh(wave_number * length));
  double decay[2];
  for (const bool short_steps : {false, true}) {
    testing::FluidScene<2> tank = testing::tank(length / 20, 20, 28, 20, 20);
    auto& particles = tank.description.particles;
    for (std::size_t i = static_cast<std::size_t>(tank.description.bodies[1].first); i < particles.position.size(); ++i) {
      const Vector<2> x = wave_number * particles.position[i];
      particles.velocity[i] =
          speed / std::sinh(wave_number * length) * Vector<2>(-std::sin(x[0]) * std::cosh(x[1]), std::cos(x[0]) * std::sinh(x[1]));
    }
    if (short_steps) tank.description.scheme.maximum_step = 4e-4;  // an eighth of its own
    const Scene<2> scene = make_scene(tank.description);
    State<2> state = initial_state(scene);
    Workspace<2> work;
    const double start = kinetic_energy(scene, state);
    std::vector<double> peak, when;  // of the kinetic energy, two a period
    double before = start, last = start;
    while (state.time < 3.4 * period) {
      step(scene, state, work, 3.4 * period - state.time);
      const double now = kinetic_energy(scene, state);
      const double apart = when.empty() ? state.time : state.time - when.back();
      if (last > before && last >= now && apart > 0.3 * period) peak.push_back(last / start), when.push_back(state.time);
      before = last, last = now;
    }
    ASSERT_GE(when.size(), 5u);
    EXPECT_NEAR((when[4] - when[0]) / (2 * period), 1 + wave_number * tank.description.spacing / 4, 0.03);
    decay[short_steps] = peak[4];
    EXPECT_LT(peak[4], 1.0);
    EXPECT_GT(peak[4], 0.6);
  }
  EXPECT_NEAR(decay[1], decay[0], 0.02);
}

// Water that collapses keeps its density: 0.1 % in the mean, where pressure alone lets 1 % gather; and with it its energy.
TEST(FreeSurface, ACollapsingColumnKeepsItsDensityAndGainsNoEnergy) {
  const double l0 = 0.2 / 24;
  const Scene<2> scene = make_scene(testing::tank(l0, 96, 48, 24, 24).description);
  State<2> state = initial_state(scene);
  Workspace<2> work, look;
  const auto energy = [&] {
    double sum = kinetic_energy(scene, state);
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) sum += 9.81 * state.position[i][1];
    return sum;
  };
  const double start = energy();
  double error = 0, most = start;
  for (int k = 1; k <= 20; ++k) {
    while (state.time < 0.02 * k - 1e-12) step(scene, state, work, 0.02 * k - state.time);
    find_neighborhood(scene, state, look);
    double sum = 0, count = 0;
    for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i)
      if (look.surface[i] == 0) sum += std::abs(look.number_density[i] - 1), count += 1;
    error += sum / count / 20, most = std::max(most, energy());
  }
  EXPECT_LT(error, 0.001);
  EXPECT_LT(most, 1.002 * start);
}

}  // namespace
}  // namespace sim
