#include "sim/solid_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/solid_bodies.h"
#include "sim/solid_stress.h"

namespace {

using namespace sim;

// Clamped-free strip of beam_frequencies.csv ("Gray_plate": FE2D f1 = 3.9188 Hz), in its first mode.
struct Strip {
  static constexpr double length = 0.2, thickness = 0.02, frequency = 3.9188;
  SolidElasticity<2> solid;
  std::vector<Vector<2>> position, velocity;
  explicit Strip(int layers, double damping = 0) {
    ElasticMaterial m;
    m.youngs_modulus = 2e6;
    m.poisson_ratio = 0.3975;
    m.damping = damping;
    const double spacing = thickness / layers;
    const auto scene = solid_bodies::box<2>({-3 * spacing, 0}, {length, thickness}, spacing, m,
                                            [](const Vector<2>& x) -> std::uint8_t { return x(0) < 0 ? 3 : 0; });
    solid = build_solids(scene);
    position = solid.rest;
    velocity.assign(solid.size(), Vector<2>::Zero());
  }
  // Velocity of beam theory's first mode, vf m/s at the tip, with the plane sections' rotation.
  void start(double vf) {
    const double kl = 1.875104, k = kl / length, a = std::cos(kl) + std::cosh(kl), b = std::sin(kl) - std::sinh(kl);
    const auto mode = [&](double x) { return a * (std::cosh(k * x) - std::cos(k * x)) + b * (std::sinh(k * x) - std::sin(k * x)); };
    const auto slope = [&](double x) { return k * (a * (std::sinh(k * x) + std::sin(k * x)) + b * (std::cosh(k * x) - std::cos(k * x))); };
    for (std::size_t i = 0; i < solid.size(); ++i)
      if (!solid.fixed[i]) {
        const double x = solid.rest[i](0), y = solid.rest[i](1) - thickness / 2;
        velocity[i] = vf / mode(length) * Vector<2>(-y * slope(x), mode(x));
      }
  }
  double energy(SolidWork<2>& work) const {
    double sum = solid_energy<2>(solid, position, work);
    for (std::size_t i = 0; i < solid.size(); ++i) sum += solid.mass[i] / 2 * velocity[i].squaredNorm();
    return sum;
  }
};

struct Vibration {
  double frequency = 0, energy_span = 0;  // Hz; largest relative distance of the energy from its start
};
Vibration vibrate(Strip& strip, double step, int explicit_limit) {
  SolidMotion<2> motion;
  SolidStepInput<2> input;
  input.duration = step;
  input.explicit_limit = explicit_limit;
  SolidWork<2> work;
  const double start = strip.energy(work);
  Vibration result;
  const SolidPoint<2> tip = locate_in_solid<2>(strip.solid, 0, {Strip::length, Strip::thickness / 2});
  double before = 0;
  for (int s = 0; result.frequency == 0 && s < 100000; ++s) {
    input.time = s * step;
    advance_solids<2>(strip.solid, input, motion, std::span<Vector<2>>(strip.position), std::span<Vector<2>>(strip.velocity), {});
    result.energy_span = std::max(result.energy_span, std::abs(strip.energy(work) / start - 1));
    const double y = displacement_at<2>(strip.solid, tip, strip.position, work)(1);
    if (before < 0 && y >= 0) result.frequency = 1 / ((s + 1) * step - step * y / (y - before));
    before = y;
  }
  return result;
}

TEST(SolidDynamics, FreeVibrationExplicit) {
  Strip strip(3);
  strip.start(0.05);
  const Vibration v = vibrate(strip, 1 / Strip::frequency / 50, 1000000);
  std::printf("free vibration, 3 layers, explicit: f %.4f Hz (%+.2f %%), energy %.3f %%\n", v.frequency,
              100 * (v.frequency / Strip::frequency - 1), 100 * v.energy_span);
  EXPECT_NEAR(v.frequency, Strip::frequency, 0.02 * Strip::frequency);
  EXPECT_LT(v.energy_span, 0.005);
}

TEST(SolidDynamics, FreeVibrationImplicit) {
  Strip strip(4);
  strip.start(0.05);
  const Vibration v = vibrate(strip, 1 / Strip::frequency / 60, 0);
  std::printf("free vibration, 4 layers, implicit, 60 steps a period: f %.4f Hz (%+.2f %%), energy %.3f %%\n", v.frequency,
              100 * (v.frequency / Strip::frequency - 1), 100 * v.energy_span);
  EXPECT_NEAR(v.frequency, Strip::frequency, 0.02 * Strip::frequency);
  EXPECT_LT(v.energy_span, 0.005);
}

// Long implicit steps on a stiff body settle at the static answer: M + s^2 K with mass damping.
TEST(SolidDynamics, ChoosesImplicitWhereExplicitWouldNeedTooMany) {
  Strip strip(2, 5);
  SolidMotion<2> motion;
  SolidStepInput<2> input;
  input.duration = 0.05;
  input.gravity = Vector<2>(0, -0.1);
  std::vector<Vector<2>> mean(strip.solid.size());
  SolidStepReport report;
  for (int s = 0; s < 120; ++s) {
    input.time = s * input.duration;
    report = advance_solids<2>(strip.solid, input, motion, std::span<Vector<2>>(strip.position), std::span<Vector<2>>(strip.velocity),
                               std::span<Vector<2>>(mean));
    EXPECT_TRUE(report.implicit);
  }
  const double rigidity = 2e6 * std::pow(Strip::thickness, 3) / 12 / (1 - 0.3975 * 0.3975);
  const double sag = 1000 * Strip::thickness * 0.1 * std::pow(Strip::length, 4) / (8 * rigidity);
  EXPECT_NEAR(strip.position.back()(1) - strip.solid.rest.back()(1), -sag, 0.04 * sag);
  input.duration = 1e-4;
  report = advance_solids<2>(strip.solid, input, motion, std::span<Vector<2>>(strip.position), std::span<Vector<2>>(strip.velocity), {});
  EXPECT_FALSE(report.implicit);
}

// A stiff direction with added mass: one free particle row feels (m + m_e) along N and m across.
TEST(SolidDynamics, AddedMassActsAlongItsDirectionAndTheMeanForceBalances) {
  for (const int limit : {1000, 0}) {
    Strip strip(2);
    const std::size_t n = strip.solid.size();
    SolidMotion<2> motion;
    SolidStepInput<2> input;
    input.duration = 1e-6;  // short: elastic forces stay negligible
    input.explicit_limit = limit;
    const std::vector<Vector<2>> force(n, Vector<2>(1, 1)), normal(n, Vector<2>::UnitY()), reference(n, Vector<2>(0, 3));
    const std::vector<double> added(n, 2 * strip.solid.mass[0]);
    input.external_force = force;
    input.added_mass = added;
    input.added_direction = normal;
    input.reference_acceleration = reference;
    std::vector<Vector<2>> mean(n);
    advance_solids<2>(strip.solid, input, motion, std::span<Vector<2>>(strip.position), std::span<Vector<2>>(strip.velocity),
                      std::span<Vector<2>>(mean));
    const double m = strip.solid.mass.back();
    const Vector<2> change = strip.velocity.back() / input.duration;
    EXPECT_NEAR(change(0), 1 / m, 1e-3 / m);
    EXPECT_NEAR(change(1), (1 + 2 * m * 3) / (3 * m), 1e-3 / m);
    EXPECT_LT(mean.back().norm(), 1e-2);          // no elastic force yet
    EXPECT_EQ(strip.velocity.front().norm(), 0);  // held
  }
}

TEST(SolidDynamics, OperatorSolvesMassPlusStiffness) {
  Strip strip(2);
  SolidOperator<2> op;
  const double c = 1e-6;
  op.factorise(strip.solid, strip.position, c);
  const std::size_t n = strip.solid.size();
  std::vector<Vector<2>> rhs(n, Vector<2>(0, 1e-3)), x(n), plus(n), minus(n), moved(n);
  op.solve(rhs, x);
  SolidWork<2> work;
  for (std::size_t i = 0; i < n; ++i) moved[i] = strip.position[i] + 1e-6 * x[i];
  solid_forces<2>(strip.solid, moved, work, plus);
  for (std::size_t i = 0; i < n; ++i) moved[i] = strip.position[i] - 1e-6 * x[i];
  solid_forces<2>(strip.solid, moved, work, minus);
  for (std::size_t i = 0; i < n; ++i)
    if (!strip.solid.fixed[i]) {
      const Vector<2> product = strip.solid.mass[i] * x[i] - c * (plus[i] - minus[i]) / 2e-6;
      EXPECT_LT((product - rhs[i]).norm(), 1e-6 * rhs[i].norm());
    }
}

}  // namespace
