// What a finished run says on the terminal.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "sim/run.h"

namespace app {

nlohmann::json run_result_json(const sim::RunResult& result, const std::filesystem::path& file);
void print_run_result(const sim::RunResult& result, const std::filesystem::path& file, bool json, bool quiet);
void print_profile(const sim::RunResult& result);
int exit_code_of(const sim::RunResult& result);  // 0 finished or stopped by limits.wall_time, 1 interrupted, failed, or a book of the ledger over its limit

}  // namespace app
