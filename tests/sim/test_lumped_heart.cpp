#include "sim/lumped_heart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace {

// The reference beat (its own summary line): 119.9/77.47 mmHg, 70.87 mL, flow from 0.117 to 0.393 s; and every tabulated row.
TEST(LumpedHeart, ReproducesTheReferenceBeat) {
  const sim::HeartBeat beat = sim::simulate_heart(sim::HeartParameters{}, 80);
  EXPECT_NEAR(beat.systolic, 119.9, 0.3);
  EXPECT_NEAR(beat.diastolic, 77.47, 0.3);
  EXPECT_NEAR(beat.stroke_volume, 70.87, 0.3);
  EXPECT_NEAR(beat.opens, 0.117, 3e-3);
  EXPECT_NEAR(beat.closes, 0.393, 4e-3);
  const std::filesystem::path shared = std::getenv("CUSP_SHARED") ? std::getenv("CUSP_SHARED") : CUSP_SOURCE_DIR "/../shared";
  const std::filesystem::path file = shared / "reference/cardiac_cycle_120_80.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  std::FILE* in = std::fopen(file.c_str(), "r");
  char line[512];
  double t, lv, ao, q;
  std::size_t row = 0;
  while (std::fgets(line, sizeof line, in)) {
    if (std::sscanf(line, "%lf,%lf,%lf,%*f,%*f,%lf", &t, &lv, &ao, &q) != 4 || row >= beat.time.size()) continue;
    EXPECT_NEAR(beat.time[row], t, 1e-9);
    EXPECT_NEAR(beat.ventricle[row], lv, 1.2) << t;
    EXPECT_NEAR(beat.aorta[row], ao, 1.2) << t;
    EXPECT_NEAR(beat.flow[row], q, 15) << t;
    ++row;
  }
  std::fclose(in);
  EXPECT_GE(row, 80u);
}

// From its readings the fit finds the reference's own parameters again.
TEST(LumpedHeart, FitFindsTheReferenceAgain) {
  const sim::HeartBeat reference = sim::simulate_heart(sim::HeartParameters{});
  sim::CuffReadings readings{75, reference.systolic, reference.diastolic, reference.stroke_volume};
  sim::HeartParameters wanted;
  wanted.emax = 2.2 * reference.systolic / 120;
  const sim::HeartParameters found = sim::fit_heart(readings);
  EXPECT_NEAR(found.peripheral, 1.08, 0.01);
  EXPECT_NEAR(found.compliance, 1.35, 0.02);
  EXPECT_NEAR(found.venous_pressure, 6.9, 0.1);
}

TEST(LumpedHeart, OtherPatientsGetTheirReadings) {
  for (const sim::CuffReadings& readings : {sim::CuffReadings{60, 110, 65, 85}, {95, 160, 95, 55}, {75, 140, 60, 95}, {120, 100, 60, 45}}) {
    const sim::HeartBeat beat = sim::simulate_heart(sim::fit_heart(readings));
    EXPECT_NEAR(beat.systolic, readings.systolic, 1);
    EXPECT_NEAR(beat.diastolic, readings.diastolic, 1);
    EXPECT_NEAR(beat.stroke_volume, readings.stroke_volume, 1);
    EXPECT_NEAR(beat.time.back(), 60 / readings.heart_rate, 1e-9);
  }
}

TEST(LumpedHeart, RefusesWhatNoHeartDoes) {
  EXPECT_THROW(sim::fit_heart({75, 80, 120, 70}), std::invalid_argument);
  EXPECT_THROW(sim::fit_heart({75, 120, 80, 700}), std::invalid_argument);
  EXPECT_THROW(sim::fit_heart({7, 120, 80, 70}), std::invalid_argument);
}

// Waves for ports begin when the valve opens: both pressures are equal there, and repeat after a period.
TEST(LumpedHeart, WavesBeginWhenTheValveOpens) {
  const sim::HeartBeat beat = sim::simulate_heart(sim::HeartParameters{});
  const sim::PortWaves waves = sim::port_waves(beat);
  EXPECT_NEAR(waves.ventricle.front(), waves.aorta.front(), 1.5 * 133.322);
  EXPECT_NEAR(waves.ventricle.front(), waves.ventricle.back(), 1);
  EXPECT_GT(waves.ventricle[4], waves.aorta[4]);
}

}  // namespace
