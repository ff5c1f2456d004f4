#include "app/case_grid.h"

#include <gtest/gtest.h>

#include "app/scene_error.h"

namespace {

TEST(CaseGrid, VariationsKeepBracketsTogether) {
  const app::Variation plain = app::parse_variation("spacing=0.02,0.01");
  EXPECT_EQ(plain.key, "spacing");
  EXPECT_EQ(plain.values, (std::vector<std::string>{"0.02", "0.01"}));
  EXPECT_EQ(app::parse_variation("load.0.force=[0,1],[0,2]").values, (std::vector<std::string>{"[0,1]", "[0,2]"}));
  EXPECT_THROW(app::parse_variation("spacing"), app::SceneError);
  EXPECT_THROW(app::parse_variation("spacing=1,,2"), app::SceneError);
}

TEST(CaseGrid, RunsEveryCombinationInFoldersOfTheirOwn) {
  const auto cases = app::grid_cases({app::parse_variation("a=1,2"), app::parse_variation("b=x,y,z")}, "out");
  ASSERT_EQ(cases.size(), 6u);
  EXPECT_EQ(cases[0].settings, (std::vector<std::string>{"a=1", "b=x"}));
  EXPECT_EQ(cases[5].settings, (std::vector<std::string>{"a=2", "b=z"}));
  EXPECT_EQ(cases[1].folder, std::filesystem::path("out/a=1__b=y"));
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(cases[i].folder, cases[j].folder);
}

TEST(CaseGrid, CommandsGoOnWhereACaseStopped) {
  const auto one = app::grid_cases({app::parse_variation("a=1")}, "out").front();
  const auto words = app::case_command(one, {"scene.toml", {"c=3"}, 2, 1, true, 0}, "cusp");
  const std::vector<std::string> expected{"cusp",      "run", "scene.toml", "-o",  "out/a=1/run.h5", "--continue", "--quiet",
                                          "--threads", "1",   "--set",      "c=3", "--set",          "a=1"};
  EXPECT_EQ(words, expected);
}

}  // namespace
