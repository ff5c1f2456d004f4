// Lists of cases, the sweep's table and page.
#include "app/sweep_table.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "app/scene_error.h"
#include "tests/app/example_run.h"

namespace {

namespace fs = std::filesystem;

class SweepTable : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("cusp_sweep_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(SweepTable, AListOfCases) {
  std::ofstream(folder_ / "list.csv") << "# chosen pairs\nspacing, body.plate.fixed\n0.1, [1, 2]\n0.2, [3]\n0.1, [3]\n";
  std::vector<app::Variation> keys;
  const auto cases = app::listed_cases(folder_ / "list.csv", folder_, keys);
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases[1].settings, (std::vector<std::string>{"spacing=0.2", "body.plate.fixed=[3]"}));
  ASSERT_EQ(keys.size(), 2u);
  EXPECT_EQ(keys[0].values, (std::vector<std::string>{"0.1", "0.2"}));
  std::ofstream(folder_ / "bad.csv") << "a,b\n1\n";
  keys.clear();
  EXPECT_THROW(app::listed_cases(folder_ / "bad.csv", folder_, keys), app::SceneError);
  EXPECT_THROW(app::listed_cases(folder_ / "none.csv", folder_, keys), app::SceneError);
}

TEST_F(SweepTable, OneRowACaseWithItsFigures) {
  const std::vector<app::Variation> keys{{"modulus", {"1e6", "2e6", "3e6"}}};
  const auto cases = app::grid_cases(keys, folder_);
  for (int k = 0; k < 2; ++k) {
    fs::create_directories(cases[k].folder);
    app::example::write_valve_run(cases[k].run(), 21, 3e5 * (k + 1));
  }
  const nlohmann::json table = app::sweep_table("valve", keys, cases, {0, 0, -1});
  ASSERT_EQ(table["cases"].size(), 3u);
  EXPECT_EQ(table["cases"][1]["settings"]["modulus"], 2e6);
  EXPECT_EQ(table["cases"][2]["status"], "not started");
  const auto stress = [&](int k) { return table["cases"][k]["figures"]["stress_systole"].get<double>(); };
  EXPECT_NEAR(stress(1), 2 * stress(0), 1e-3 * stress(1));
  app::write_sweep(table, folder_);
  std::ifstream csv(folder_ / "sweep.csv");
  std::string heading, row;
  std::getline(csv, heading), std::getline(csv, row);
  EXPECT_EQ(heading.rfind("case,modulus,status,wall_seconds,", 0), 0u);
  EXPECT_EQ(std::count(heading.begin(), heading.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_TRUE(fs::exists(folder_ / "sweep.json"));
  EXPECT_GT(fs::file_size(folder_ / "sweep.html"), 10000u);
}

}  // namespace
