// Corridors, verdicts and the table of figures.
#include "app/clinical.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <set>

#include "app/assets.h"
#include "tests/app/example_run.h"

namespace {

sim::Figure figure(double value, double uncertainty) {
  sim::Figure made;
  made.key = "effective_orifice_area", made.label = "area", made.units = "m2";
  made.value = value, made.uncertainty = uncertainty;
  return made;
}

TEST(Clinical, VerdictComparesInTheCorridorsOwnUnit) {
  const app::Corridor corridor{"effective_orifice_area", "cm²", "published", "", 1e4, 2.0, 3.2};
  EXPECT_EQ(app::verdict(figure(2.5e-4, 0), corridor), app::Verdict::inside);
  EXPECT_EQ(app::verdict(figure(1.9e-4, 0.2e-4), corridor), app::Verdict::borderline);
  EXPECT_EQ(app::verdict(figure(1.7e-4, 0.2e-4), corridor), app::Verdict::below);
  EXPECT_EQ(app::verdict(figure(3.5e-4, NAN), corridor), app::Verdict::above);
  EXPECT_EQ(app::verdict(figure(NAN, NAN), corridor), app::Verdict::none);
  app::Corridor remembered = corridor;
  remembered.kind = "orientation";
  EXPECT_EQ(app::verdict(figure(9e-4, 0), remembered), app::Verdict::none);
}

TEST(Clinical, EveryCorridorHasASourceAndAKind) {
  const auto corridors = app::read_corridors(app::asset("corridors/valve.csv"));
  EXPECT_GT(corridors.size(), 25u);
  std::set<std::string> seen;
  for (const app::Corridor& corridor : corridors) {
    EXPECT_TRUE(seen.insert(corridor.figure).second) << corridor.figure << " stands twice";
    if (!corridor.low && !corridor.high) continue;
    EXPECT_FALSE(corridor.source.empty()) << corridor.figure;
    EXPECT_TRUE(std::set<std::string>({"published", "computed", "formula", "orientation"}).count(corridor.kind)) << corridor.figure;
    if (corridor.low && corridor.high) EXPECT_LT(*corridor.low, *corridor.high) << corridor.figure;
  }
}

// The made-up valve of the tests of pictures has no such columns: they come from its frames. Its flow is 4e-4 sin(pi t / 0.8) m3/s.
TEST(Clinical, FiguresOfAnOlderRunComeFromItsFrames) {
  const auto file = std::filesystem::temp_directory_path() / ("cusp_clinical_" + std::to_string(getpid()) + ".h5");
  app::example::write_valve_run(file, 41);
  const sim::RunReader run(file);
  const auto clinical = app::clinical_figures(run, file);
  ASSERT_TRUE(clinical);
  EXPECT_TRUE(clinical->series.from_frames);
  EXPECT_EQ(clinical->corridors.size(), clinical->summary.figures.size());
  const sim::Figure* forward = clinical->summary.find("forward_volume");
  ASSERT_NE(forward, nullptr);
  EXPECT_GT(forward->value, 0.5 * 0.5 * 4e-4 * 0.8 * 2 / 3.14159);  // its outlet reports no flow: half of it, from the opening on
  EXPECT_LT(forward->value, 1.05 * 0.5 * 4e-4 * 0.8 * 2 / 3.14159);
  const std::string text = app::clinical_text(*clinical);
  EXPECT_NE(text.find("Geometric orifice area"), std::string::npos);
  EXPECT_NE(text.find("not for clinical decisions"), std::string::npos);
  EXPECT_EQ(app::clinical_json(*clinical)["figures"].size(), clinical->summary.figures.size());
  std::filesystem::remove(file);
}

}  // namespace
