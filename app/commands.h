// The program's commands, one file each (command_*.cpp). Each adds its sub-command and, when it was chosen, sets the exit code:
// 0 success, 1 a failed run or check, 2 wrong usage or bad input.
#pragma once

#include <CLI/CLI.hpp>

namespace app {

int run_program(int argc, char** argv);

void add_demo_command(CLI::App& program, int& exit_code);
void add_import_command(CLI::App& program, int& exit_code);
void add_explain_command(CLI::App& program, int& exit_code);
void add_run_command(CLI::App& program, int& exit_code);
void add_replay_command(CLI::App& program, int& exit_code);
void add_view_command(CLI::App& program, int& exit_code);
void add_sweep_command(CLI::App& program, int& exit_code);
void add_accuracy_command(CLI::App& program, int& exit_code);
void add_validate_command(CLI::App& program, int& exit_code);
void add_export_command(CLI::App& program, int& exit_code);
void add_report_command(CLI::App& program, int& exit_code);
void add_info_command(CLI::App& program, int& exit_code);

}  // namespace app
