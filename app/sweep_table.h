// What came out of many runs of one scene: a table (CSV, JSON) and a page with plots of any figure over the keys that varied.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/case_grid.h"

namespace app {

// Cases of a CSV file: a heading of keys, one case a row. Fills `variations` with the keys and the values that occur. Throws SceneError.
std::vector<GridCase> listed_cases(const std::filesystem::path& file, const std::filesystem::path& folder,
                                   std::vector<Variation>& variations);

// {"title", "keys", "figures": [{"key", "label", "unit", "factor"}], "cases": [{"case", "settings" {key: value}, "exit_code", "status",
// "wall_seconds", "figures" {key: SI value}, "uncertainty" {key: SI value}, "last" {column: value}, "largest" {column: value}}]}.
// `codes`: exit code a case, -1 = not started.
nlohmann::json sweep_table(const std::string& title, const std::vector<Variation>& variations, const std::vector<GridCase>& cases,
                           const std::vector<int>& codes);
// sweep.csv, sweep.json, sweep.html in the folder.
void write_sweep(const nlohmann::json& table, const std::filesystem::path& folder);

}  // namespace app
