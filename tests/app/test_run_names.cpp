#include "app/run_names.h"

#include <gtest/gtest.h>

namespace {

TEST(RunNames, TitlesWhereTheyDiffer) {
  const auto result =
      app::run_names({"before", "after"}, {"leaflets 1 MPa, 0.5 mm  ·  spacing 1 mm", "leaflets 2 MPa, 0.5 mm  ·  spacing 1 mm"}, {{}, {}});
  EXPECT_EQ(result.names, (std::vector<std::string>{"before", "after"}));
  EXPECT_EQ(result.shared, "0.5 mm, spacing 1 mm");
}

TEST(RunNames, SettingsThatDifferWhereTitlesDoNot) {
  const auto result = app::run_names(
      {"beat", "beat", "beat"},
      {"leaflets 0.5 MPa, 0.5 mm, fibre-reinforced  ·  spacing 1.5 mm", "leaflets 1 MPa, 0.5 mm, fibre-reinforced  ·  spacing 1.5 mm",
       "leaflets 1 MPa, 0.4 mm, fibre-reinforced  ·  spacing 1.5 mm"},
      {{}, {}, {}});
  EXPECT_EQ(result.names, (std::vector<std::string>{"leaflets 0.5 MPa, 0.5 mm", "leaflets 1 MPa, 0.5 mm", "leaflets 1 MPa, 0.4 mm"}));
  EXPECT_EQ(result.shared, "fibre-reinforced, spacing 1.5 mm");
}

TEST(RunNames, KeysSetByHandWhereWordsAreTheSame) {
  const auto result = app::run_names({"beat", "beat"}, {"spacing 1 mm", "spacing 1 mm"},
                                     {{"time.end=0.4"}, {"time.end=0.4", "patient.valve.over_closure=1e-3"}});
  EXPECT_EQ(result.names, (std::vector<std::string>{"1", "2: over closure=1e-3"}));
}

TEST(RunNames, NumbersWhereNothingTellsThemApart) {
  const auto result = app::run_names({"beat", "beat"}, {"spacing 1 mm", "spacing 1 mm"}, {{"time.end=0.4"}, {"time.end=0.4"}});
  EXPECT_EQ(result.names, (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(result.shared, "spacing 1 mm");
}

}  // namespace
