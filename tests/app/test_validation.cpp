// The built-in cases: those quick enough for every run are run here and must keep their limits; the others by `cusp validate`.
#include "app/validation.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "app/measure_effects.h"

namespace {

using namespace app;

std::filesystem::path scratch() {
  const auto folder = std::filesystem::temp_directory_path() / ("cusp_validation_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

TEST(Validation, OrderIsTheSlopeAndNoneWhereErrorsDoNotFall) {
  const auto order = convergence_order({0.4, 0.2, 0.1}, {0.16, 0.04, 0.01});
  ASSERT_TRUE(order.has_value());
  EXPECT_NEAR(*order, 2, 1e-12);
  EXPECT_FALSE(convergence_order({0.4, 0.2, 0.1}, {0.16, 0.17, 0.01}).has_value());
  EXPECT_FALSE(convergence_order({0.4}, {0.16}).has_value());
}

TEST(Validation, EveryPriorityOfTheQuickCasesHoldsItsLimits) {
  const std::vector<std::string> quick{"patch_pressure",   "patch_uniaxial",  "patch_shear",
                                       "cantilever_small", "turek_hron_csm2", "leaflet_beam"};
  const std::filesystem::path folder = scratch();
  std::size_t found = 0;
  for (const ValidationCase& one : read_validation_cases()) {
    if (std::find(quick.begin(), quick.end(), one.name) == quick.end()) continue;
    ++found;
    const ValidationResult result = run_validation_case(one, false, 0, folder);
    EXPECT_EQ(result.json["status"], "pass") << result.json.dump(1);
    ASSERT_FALSE(result.panels.empty()) << one.name;
    EXPECT_NE(svg_plot(one.title, result.panels).find("<path"), std::string::npos) << one.name;
  }
  EXPECT_EQ(found, quick.size());
  std::filesystem::remove_all(folder);
}

TEST(Effects, CostNothingWhereAbsentAndChangeNothingAtZeroStrength) {
  const nlohmann::json all = measure_effects(4);
  ASSERT_GE(all["effects"].size(), 10u);
  int at_zero = 0;
  for (const auto& row : all["effects"]) {
    if (!row.contains("zero_strength_position")) continue;
    ++at_zero;
    EXPECT_LT(row["zero_strength_position"].get<double>(), 1e-11) << row.dump();
    EXPECT_LT(row["zero_strength_velocity"].get<double>(), 1e-11) << row.dump();
  }
  EXPECT_GE(at_zero, 9);
  const auto viscosity =
      std::find_if(all["effects"].begin(), all["effects"].end(), [](const auto& row) { return row["effect"] == "viscosity"; });
  ASSERT_NE(viscosity, all["effects"].end());
  EXPECT_LT((*viscosity)["bytes_without"].get<long long>(), (*viscosity)["bytes_with"].get<long long>());
}

}  // namespace
