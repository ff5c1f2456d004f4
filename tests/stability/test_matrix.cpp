// The stability matrix as a user runs it: its fast cells hold, and a state of rest stays one.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "stability/child.h"

namespace {

using namespace stability;
using nlohmann::json;

TEST(StabilityMatrix, FastCellsHold) {
  const fs::path folder = fresh_folder("matrix");
  const ChildResult result =
      run_cusp({"validate", "--stability", "--fast", "--threads", "1", "--quiet", "-o", (folder / "m").string()}, folder / "log.txt");
  const json all = json::parse(text_of(folder / "m" / "stability.json"));
  std::map<std::string, json> cells;
  for (const json& one : all["cases"]) cells[one["name"]] = one;
  ASSERT_GE(cells.size(), 11u);
  for (const auto& [name, one] : cells) EXPECT_NE(one["status"], "fail") << name << ": " << one["cause"];
  EXPECT_EQ(result.exit_code, 0) << result.errors;

  // Without drive nothing stirs: not the unevenness of blood beside the flaps, not their coupling.
  EXPECT_LT(cells.at("rest")["largest_speed"].get<double>(), 1e-9);
  // Flaps of 60 MPa ran away at 100 m/s once: the blood past them is no faster than twice that past flaps of 1 MPa.
  EXPECT_LT(cells.at("modulus_60_MPa")["largest_speed"].get<double>(), 2 * cells.at("base")["largest_speed"].get<double>());
  EXPECT_EQ(cells.at("threads")["apart_l0"].get<double>(), 0);
  EXPECT_EQ(cells.at("restart")["apart_l0"].get<double>(), 0);
  fs::remove_all(folder);
}

}  // namespace
