#include "app/valve_moments.h"

#include <gtest/gtest.h>

#include <cmath>

namespace app {
namespace {

// A beat of 0.8 s: opens at 0.05, open to 0.30, closed from 0.32 on; rings while it closes; the flow settles at 0.55.
struct Series {
  std::vector<double> time, area, flow;
  Series() {
    for (int i = 0; i <= 160; ++i) {
      const double t = 0.005 * i, ringing = t > 0.32 ? std::exp(-(t - 0.32) / 0.05) : 0;
      time.push_back(t);
      area.push_back(t < 0.05   ? 3e-4 * t / 0.05
                     : t < 0.30 ? 3e-4 - 2e-5 * std::abs(t - 0.12)
                     : t < 0.32 ? 3e-4 * (0.32 - t) / 0.02
                                : 5e-6 * (1 + ringing));
      flow.push_back(t < 0.31 ? 4e-4 : -1e-4 * ringing * std::cos(80 * (t - 0.32)));
    }
  }
};

TEST(ValveMoments, are_found_in_a_beat) {
  const Series beat;
  const auto moments = valve_moments(beat.time, beat.area, beat.flow);
  ASSERT_TRUE(moments);
  EXPECT_NEAR(moments->opened, 0.025, 0.006);
  EXPECT_NEAR(moments->open, 0.12, 0.011);
  EXPECT_NEAR(moments->closing, 0.31, 0.006);
  EXPECT_GT(moments->closed, 0.32 + 0.1);  // after the ringing, not at the first moment of closure
  EXPECT_LT(moments->closed_area, 6e-6);
}

TEST(ValveMoments, one_noisy_row_does_not_count) {
  Series beat;
  beat.area[100] = 9e-4;  // at 0.5 s, while closed
  const auto moments = valve_moments(beat.time, beat.area, beat.flow);
  ASSERT_TRUE(moments);
  EXPECT_NEAR(moments->open, 0.12, 0.011);
}

TEST(ValveMoments, a_valve_that_never_opens_or_never_closes) {
  Series beat;
  EXPECT_FALSE(valve_moments(beat.time, std::vector<double>(beat.time.size(), 4e-6), beat.flow));
  EXPECT_FALSE(valve_moments({}, {}, {}));
  std::vector<double> open = beat.area;
  for (std::size_t i = 30; i < open.size(); ++i) open[i] = 2.9e-4;
  const auto moments = valve_moments(beat.time, open, {});
  ASSERT_TRUE(moments);
  EXPECT_EQ(moments->closing, 0.8);
  EXPECT_EQ(moments->closed, 0.8);
}

}  // namespace
}  // namespace app
