#include "sim/curve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

sim::Curve sine(int samples, double noise = 0) {
  sim::Curve curve;
  for (int i = 0; i <= samples; ++i) {
    curve.time.push_back(static_cast<double>(i) / samples);
    curve.value.push_back(std::sin(2 * M_PI * i / samples) + (i % 2 ? noise : -noise));
  }
  return curve;
}

TEST(Curve, IntegralAndMeanOfTheFirstHalfOfASine) {
  const sim::Curve curve = sine(400);
  EXPECT_NEAR(sim::integral(curve, 0, 0.5), 1 / M_PI, 1e-5);
  EXPECT_NEAR(sim::mean(curve, 0, 0.5), 2 / M_PI, 1e-4);
  EXPECT_NEAR(sim::integral(curve, 0.1234, 0.1234), 0, 1e-15);
  EXPECT_NEAR(sim::integral(curve, 0.11, 0.2) + sim::integral(curve, 0.2, 0.37), sim::integral(curve, 0.11, 0.37), 1e-12);
}

TEST(Curve, ExtremesAndCrossings) {
  const sim::Curve curve = sine(400);
  EXPECT_NEAR(sim::largest(curve, 0, 1).time, 0.25, 1e-12);
  EXPECT_NEAR(sim::smallest(curve, 0, 1).value, -1, 1e-12);
  EXPECT_NEAR(*sim::crossing(curve, 0.5, true, 0, 1), 1.0 / 12, 1e-4);
  EXPECT_NEAR(*sim::crossing(curve, 0.5, false, 0, 1), 5.0 / 12, 1e-4);
  EXPECT_FALSE(sim::crossing(curve, 1.5, true, 0, 1));
}

// Single samples off by +-a have the standard deviation a; their second difference is 4 a: rms / sqrt(6) = 1.63 a. White noise: sigma.
TEST(Curve, NoiseOfASmoothCurveIsNone) {
  EXPECT_LT(sim::noise(sine(400), 0, 1), 2e-4);
  EXPECT_NEAR(sim::noise(sine(400, 0.05), 0, 1), 4 * 0.05 / std::sqrt(6.0), 1e-3);
}

TEST(Curve, KneeOfASlowThenFastFall) {
  sim::Curve curve;
  for (int i = 0; i <= 100; ++i) curve.time.push_back(i), curve.value.push_back(i <= 70 ? 1 - 0.2 * i / 70 : 0.8 * (100 - i) / 30.0);
  EXPECT_EQ(sim::knee(curve, 0, 100), 70);
}

TEST(Curve, MedianAndSpread) {
  const sim::Curve curve{{0, 1, 2, 3, 4}, {5, 1, 3, 2, 4}};
  EXPECT_EQ(sim::median(curve, 0, 4), 3);
  EXPECT_EQ(sim::half_spread(curve, 0, 4), 1);
}

}  // namespace
