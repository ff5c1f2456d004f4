#pragma once

#include <CLI/CLI.hpp>

namespace app {

void add_bench_command(CLI::App& program, int& exit_code);

}  // namespace app
