#include "sim/valve_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "sim/valve_metrics.h"
#include "tests/sim/valve_sheets.h"

namespace {

constexpr double mmHg = 133.322;

// A valve moved by hand, every figure of it known: opens from 0.10 s in 0.04 s, stays, falls slowly from 0.14 s to 80 % at 0.34 s, shuts by
// 0.38 s. Flow: a half sine of 0.1 to 0.36 s, back 20 mL/s until 0.39 s (0.6 mL), then a leak of 4 mL/s. Jet: 1.2 m/s at the flow's top.
struct Prescribed {
  double largest = 3e-4, closed = 0.1e-4, peak_flow = 4e-4, leak = 4e-6, back = 2e-5, jet = 1.2;
  double area(double t) const {
    t = std::fmod(t, 0.8);
    const double range = largest - closed;
    if (t < 0.10) return closed;
    if (t < 0.14) return closed + range * (t - 0.10) / 0.04;
    if (t < 0.34) return closed + range * (1 - 0.2 * (t - 0.14) / 0.2);
    return t < 0.38 ? closed + range * 0.8 * (0.38 - t) / 0.04 : closed;
  }
  double flow(double t) const {
    t = std::fmod(t, 0.8);
    if (t < 0.10) return -leak;
    if (t < 0.36) return peak_flow * std::sin(M_PI * (t - 0.10) / 0.26);
    return t < 0.39 ? -back : -leak;
  }
  sim::ValveSeries series(int beats, double step = 0.001) const {
    sim::ValveSeries series;
    series.columns = {"time",
                      "orifice_area",
                      "valve_flow",
                      "jet_speed",
                      "pressure_difference",
                      "tip_speed",
                      "coaptation_height",
                      "leaflet_stress_p99",
                      "leaflet_1.belly.von_mises",
                      "leaflet_1.belly.principal",
                      "leaflet_1.free_edge.von_mises",
                      "leaflet_1.free_edge.principal",
                      "leaflet_1.commissure.von_mises",
                      "leaflet_1.commissure.principal",
                      "leaflet_1.attachment.von_mises",
                      "leaflet_1.attachment.principal",
                      "port.ventricle.flow",
                      "port.aorta.flow"};
    for (int i = 0; i <= std::lround(0.8 * beats / step); ++i) {
      const double t = i * step, q = flow(t), forward = std::max(0.0, q) / peak_flow, phase = std::fmod(t, 0.8);
      const bool shut = phase < 0.1 || phase > 0.38;
      const double stress = shut ? 4e5 : 1e5 * forward;
      series.rows.push_back({t, area(t), q, jet * forward, 6 * mmHg * forward, phase < 0.2 ? 0.3 : -0.25, shut ? 5e-3 : 0, stress, stress,
                             stress, stress, stress, 1.5 * stress, 2 * stress, stress, stress, q + 1e-6, -q + 1e-6});
    }
    return series;
  }
};

sim::SummaryOptions options(double step = 0.001) {
  sim::SummaryOptions chosen;
  chosen.period = 0.8, chosen.spacing = 1e-3, chosen.output = step, chosen.annulus_radius = 12e-3;
  return chosen;
}

double value(const sim::ValveSummary& summary, const std::string& key) {
  const sim::Figure* figure = summary.find(key);
  if (!figure) ADD_FAILURE() << key << " is missing";
  return figure ? figure->value : NAN;
}

TEST(ValveSummary, TimesOfAPrescribedOpening) {
  const sim::ValveSummary summary = sim::summarise_valve(Prescribed{}.series(1), options());
  EXPECT_NEAR(summary.times.opens, 0.10, 1e-4);
  EXPECT_NEAR(value(summary, "rapid_opening_time"), 0.04, 5e-4);
  EXPECT_NEAR(value(summary, "rapid_closing_time"), 0.04, 5e-4);
  EXPECT_NEAR(value(summary, "ejection_time"), 0.28, 5e-4);
  EXPECT_NEAR(value(summary, "slow_closing"), 0.2, 2e-3);
  EXPECT_NEAR(value(summary, "orifice_area"), 3e-4, 1e-9);
  EXPECT_NEAR(value(summary, "tip_closing_speed"), 0.25, 1e-12);
}

// From the leaflets' places alone: two leaves that slide apart by hand within a lumen of radius R. Half the slit's width is s(t): shut
// until 0.10 s, 2 mm at 0.14 s, then slowly down to 1.8 mm at 0.34 s, shut at 0.38 s. A slit of half width w in a circle is 2 (w sqrt(R^2 -
// w^2) + R^2 asin(w / R)) wide, within 0.5 % of 4 R w here; what is seen of it has half the tissue's thickness less on either side.
TEST(ValveSummary, PrescribedLeafletsGiveTheirTimesTipsAndOrifice) {
  const double radius = 10e-3, spacing = 1e-3, thickness = 0.4e-3, step = 0.008, extent = 12e-3;
  const auto half_width = [](double t) {
    if (t < 0.10 || t > 0.38) return 0.0;
    if (t < 0.14) return 2e-3 * (t - 0.10) / 0.04;
    return t < 0.34 ? 2e-3 - 0.2e-3 * (t - 0.14) / 0.2 : 1.8e-3 * (0.38 - t) / 0.04;
  };
  valve_sheets::Parts parts;
  for (const int k : {0, 1})
    valve_sheets::add_sheet(parts, k, {0, -extent, 0}, {k == 0 ? spacing : -spacing, 0, 0}, {0, spacing, 0}, 13, 25);
  const sim::ValveSheet sheet = parts.build(radius, spacing, thickness);
  sim::ValveSeries series;
  for (int i = 0; i <= 100; ++i) {
    const double t = i * step, s = half_width(t), speed = (half_width(t + 1e-6) - half_width(t - 1e-6)) / 2e-6;
    sim::ValveMoment moment;
    for (std::size_t row = 0; row < sheet.size(); ++row) {
      const double sign = sheet.leaflet[row] == 0 ? 1 : -1;
      moment.position.push_back(sheet.rest[row] + sign * s * Eigen::Vector3d::UnitX());
      moment.velocity.push_back(sign * speed * Eigen::Vector3d::UnitX());
    }
    moment.von_mises.resize(sheet.size()), moment.principal.resize(sheet.size());
    std::vector<double> row{t};
    series.columns = {"time"};
    for (const sim::NamedValue& value : sim::valve_metrics(sheet, moment, sim::Newtonian{3.5e-3}))
      series.columns.push_back(value.name), row.push_back(value.value);
    series.rows.push_back(row);
  }
  const auto at = [&](const char* column, double t) { return sim::value_at(series.curve(column), t); };
  EXPECT_NEAR(at("m_mode.first", 0.144), half_width(0.144), 1e-9);
  EXPECT_NEAR(at("m_mode.second", 0.336), -half_width(0.336), 1e-9);
  EXPECT_NEAR(at("tip_separation", 0.336), 2 * half_width(0.336), 1e-9);
  EXPECT_NEAR(at("tip_speed", 0.12), 0.05, 1e-9);
  const sim::ValveSummary summary = sim::summarise_valve(series, options(step));
  const double seen = 2e-3 - 0.5 * thickness;
  const double slit = 2 * (seen * std::sqrt(radius * radius - seen * seen) + radius * radius * std::asin(seen / radius));
  EXPECT_NEAR(value(summary, "orifice_area"), slit, 0.03 * slit);  // the raster's pixel is a thirtieth of the width
  EXPECT_NEAR(value(summary, "tip_opening_speed"), 0.05, 1e-6);
  EXPECT_NEAR(value(summary, "tip_closing_speed"), 0.045, 1e-6);
  // Seen as open from where the leaves are farther apart than the contact distance (0.4 mm each): a fifth of the opening is a jump, and the
  // straight line through 10 and 95 % begins within that fifth of it. Times are known to an output interval.
  EXPECT_NEAR(summary.times.opens, 0.10, 0.2 * 0.04 + step);
  EXPECT_NEAR(summary.times.open, 0.14, step);
  EXPECT_NEAR(summary.times.closing, 0.34, step);
  EXPECT_NEAR(summary.times.closed, 0.38, 0.22 * 0.04 + step);
  EXPECT_NEAR(value(summary, "slow_closing"), 0.2e-3 / seen, 0.03);
}

// Volumes: forward 0.4 mL/ms * 0.26 s * 2/pi = 66.208 mL; closing 0.02 L/s from 0.36 to 0.39 s less the turn-about; leak over the rest.
TEST(ValveSummary, VolumesOfAKnownFlow) {
  const Prescribed valve;
  const sim::ValveSummary summary = sim::summarise_valve(valve.series(1, 1e-4), options(1e-4));
  const double forward = valve.peak_flow * 0.26 * 2 / M_PI;
  EXPECT_NEAR(value(summary, "forward_volume"), forward, 1e-3 * forward);
  const double backward = valve.back * 0.03 + valve.leak * (0.8 - 0.29);
  EXPECT_NEAR(value(summary, "regurgitant_volume"), backward, 5e-3 * backward);
  EXPECT_NEAR(value(summary, "closing_volume"), valve.back * (0.38 - 0.36), 0.02 * valve.back * 0.02);  // until the valve is shut at 0.38 s
  EXPECT_NEAR(value(summary, "stroke_volume"), forward - backward, 1e-3 * forward);
  EXPECT_NEAR(value(summary, "regurgitant_fraction"), backward / forward, 1e-3);
  // Both ends take in 1e-6 m3/s too much: the flow's error is half of their sum over the time.
  EXPECT_NEAR(summary.find("stroke_volume")->uncertainty, 1e-6 * 0.8, 1e-9);
  EXPECT_TRUE(summary.find("regurgitant_fraction")->warnings.empty());
}

TEST(ValveSummary, JetPressureAndEffectiveAreas) {
  const Prescribed valve;
  const sim::ValveSummary summary = sim::summarise_valve(valve.series(1), options());
  EXPECT_NEAR(value(summary, "peak_jet_speed"), 1.2, 1e-4);
  EXPECT_NEAR(value(summary, "bernoulli_peak"), 4 * 1.44 * mmHg, 0.1);
  EXPECT_NEAR(value(summary, "bernoulli_mean"), 4 * 1.44 * 0.5 * mmHg, 2);  // mean of sin^2
  EXPECT_NEAR(value(summary, "peak_pressure_difference"), 6 * mmHg, 0.1);
  const double mean = 6 * mmHg * 2 / M_PI;
  EXPECT_NEAR(value(summary, "mean_pressure_difference"), mean, 0.02 * mean);
  EXPECT_NEAR(value(summary, "effective_orifice_area"), valve.peak_flow / valve.jet, 1e-3 * valve.peak_flow / valve.jet);
  // Gorlin: 66.2 mL / 0.26 s = 254.6 mL/s; mean 3.82 mmHg: 254.6 / (44.3 * 1.954) = 2.94 cm2.
  EXPECT_NEAR(value(summary, "gorlin_area"), 2.94e-4, 0.05e-4);
  EXPECT_FALSE(summary.find("gorlin_area")->warnings.empty());  // far below the differences it is made for
}

TEST(ValveSummary, StressTellsWhichLeafletRegionAndWhen) {
  const sim::ValveSummary summary = sim::summarise_valve(Prescribed{}.series(1), options());
  EXPECT_NEAR(value(summary, "stress_systole"), 1e5, 100);
  EXPECT_NEAR(value(summary, "stress_diastole"), 4e5, 1e-6);
  ASSERT_NE(summary.find("stress_peak"), nullptr);
  EXPECT_NEAR(summary.find("stress_peak")->value, 6e5, 1e-6);
  EXPECT_EQ(summary.find("stress_peak")->note, "leaflet 1, commissure");
  ASSERT_EQ(summary.leaflets.size(), 4u);
  EXPECT_NEAR(summary.leaflets[2].principal, 8e5, 1e-6);
}

// Three beats of which the first is 20 % weaker: the last one counts, the spread of the later two is none.
TEST(ValveSummary, BeatsAreToldApart) {
  sim::ValveSeries series = Prescribed{}.series(3);
  for (auto& row : series.rows)
    if (row[0] < 0.8) row[2] *= 0.8;
  const sim::ValveSummary summary = sim::summarise_valve(series, options());
  EXPECT_EQ(summary.beats, 3);
  EXPECT_NEAR(summary.beat_start, 1.6, 1e-9);
  EXPECT_NEAR(summary.find("forward_volume")->uncertainty, 1e-6 * 0.26, 1e-8);
  for (auto& row : series.rows)
    if (row[0] > 0.8 && row[0] < 1.6) row[2] *= 0.9;
  const sim::ValveSummary varying = sim::summarise_valve(series, options());
  EXPECT_NEAR(varying.find("forward_volume")->uncertainty, 0.05 * varying.find("forward_volume")->value, 1e-7);
}

TEST(ValveSummary, SaysWhatIsNotToBeTrusted) {
  Prescribed valve;
  valve.leak = 4e-5;  // 20 mL in diastole
  sim::SummaryOptions coarse = options(0.02);
  coarse.spacing = 3e-3;
  const sim::ValveSummary summary = sim::summarise_valve(valve.series(1, 0.02), coarse);
  EXPECT_FALSE(summary.find("orifice_area")->warnings.empty());        // 6.5 particles across
  EXPECT_FALSE(summary.find("rapid_opening_time")->warnings.empty());  // two outputs in it
  EXPECT_FALSE(summary.find("regurgitant_fraction")->warnings.empty());
  sim::ValveSeries open = Prescribed{}.series(1);
  open.rows.resize(300);  // ends at 0.3 s, open
  const sim::ValveSummary half = sim::summarise_valve(open, options());
  EXPECT_TRUE(std::isnan(value(half, "ejection_time")));
  EXPECT_FALSE(half.find("ejection_time")->warnings.empty());
  EXPECT_FALSE(half.warnings.empty());  // 37 % of a beat
}

// The lumped beat that the corridors come from: 2.85 mmHg mean difference, 70.9 mL, ejection 0.277 s (its own summary line).
TEST(ValveSummary, ReadsTheLumpedBeat) {
  const std::filesystem::path shared = std::getenv("CUSP_SHARED") ? std::getenv("CUSP_SHARED") : CUSP_SOURCE_DIR "/../shared";
  const std::filesystem::path file = shared / "reference/cardiac_cycle_120_80.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  std::FILE* in = std::fopen(file.c_str(), "r");
  char line[512];
  sim::ValveSeries series;
  series.columns = {"time", "orifice_area", "valve_flow", "jet_speed", "pressure_difference"};
  double t, lv, ao, q;
  while (std::fgets(line, sizeof line, in))
    if (std::sscanf(line, "%lf,%lf,%lf,%*f,%*f,%lf", &t, &lv, &ao, &q) == 4)
      series.rows.push_back({t, q > 0 ? 3e-4 : 0, 1e-6 * q, 1e-2 * q / 3.0, mmHg * (lv - ao)});
  std::fclose(in);
  const sim::ValveSummary summary = sim::summarise_valve(series, options(0.01));
  EXPECT_NEAR(value(summary, "forward_volume"), 70.87e-6, 0.5e-6);
  EXPECT_NEAR(value(summary, "mean_pressure_difference"), 2.845 * mmHg,
              0.4 * mmHg);  // sampled every 10 ms, the difference turns within one sample
  EXPECT_NEAR(value(summary, "ejection_time"), 0.277, 0.015);
}

}  // namespace
