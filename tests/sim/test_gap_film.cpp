#include "sim/gap_film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

// A strip of n shell rows in a line.
struct Strip {
  std::vector<std::int32_t> start, neighbor;
  explicit Strip(int n) {
    start.push_back(0);
    for (int s = 0; s < n; ++s) {
      if (s > 0) neighbor.push_back(s - 1);
      if (s + 1 < n) neighbor.push_back(s + 1);
      start.push_back(static_cast<std::int32_t>(neighbor.size()));
    }
  }
};

// Reynolds' equation in an even film between two pressures: the pressure falls linearly.
TEST(GapFilm, PressureFallsLinearlyBetweenItsWetEnds) {
  constexpr int n = 11;
  const Strip strip(n);
  std::vector<double> wet(2 * n, 1.0), pressure(2 * n, 7.0);
  for (int s = 1; s + 1 < n; ++s) wet[2 * s + 1] = 0;
  pressure[1] = 16000;
  pressure[2 * (n - 1) + 1] = 0;
  const auto film = sim::make_gap_film(wet, strip.start, strip.neighbor);
  sim::film_pressure(film, pressure);
  // the thousandth that comes through from the other face bends the line by less than 25 nodes' thousandths
  for (int s = 0; s < n; ++s) EXPECT_NEAR(pressure[2 * s + 1], 16000 * (1 - s / (n - 1.0)), 0.025 * 16000) << s;
  for (int s = 0; s < n; ++s) EXPECT_DOUBLE_EQ(pressure[2 * s], 7.0);
}

TEST(GapFilm, AnEvenPressureStaysEven) {
  const Strip strip(8);
  std::vector<double> wet(16, 0.0), pressure(16, 0.0);
  wet[1] = 1, wet[2] = 0.4, wet[6] = 0.2, wet[11] = 0.7;
  for (std::size_t a = 0; a < 16; ++a)
    if (wet[a] > 0) pressure[a] = 1234;
  sim::film_pressure(sim::make_gap_film(wet, strip.start, strip.neighbor), pressure);
  for (double p : pressure) EXPECT_NEAR(p, 1234, 1e-3);
}

TEST(GapFilm, OutflowIsThePressuresTransposeAndKeepsTheVolume) {
  const Strip strip(9);
  std::vector<double> wet(18, 0.0), own(18, 0.0), volume(18), given(18);
  for (std::size_t a = 0; a < 18; ++a) {
    if (a % 5 == 0) wet[a] = 0.3 + 0.05 * static_cast<double>(a);
    wet[a] = std::min(wet[a], 1.0);
    if (wet[a] > 0) own[a] = std::sin(3.0 * static_cast<double>(a));
    volume[a] = given[a] = std::cos(2.0 * static_cast<double>(a));
  }
  const auto film = sim::make_gap_film(wet, strip.start, strip.neighbor);
  std::vector<double> pressure = own;
  sim::film_pressure(film, pressure);
  sim::film_outflow(film, volume);
  EXPECT_NEAR(std::inner_product(given.begin(), given.end(), pressure.begin(), 0.0),
              std::inner_product(volume.begin(), volume.end(), own.begin(), 0.0), 1e-9);
  double before = 0, after = 0;
  for (std::size_t a = 0; a < 18; ++a) {
    before += given[a];
    if (wet[a] > 0)
      after += volume[a];
    else
      EXPECT_EQ(volume[a], 0.0);
  }
  EXPECT_NEAR(before, after, 1e-5);  // 1e-9 of the diagonal leaks
}

TEST(GapFilm, WithoutAnyBloodThereIsNoPressure) {
  const Strip strip(3);
  std::vector<double> wet(6, 0.0), pressure(6, 0.0);
  sim::film_pressure(sim::make_gap_film(wet, strip.start, strip.neighbor), pressure);
  for (double p : pressure) EXPECT_EQ(p, 0.0);
}

}  // namespace
