#include "app/commands.h"

#include <cstdio>
#include <exception>
#include <string>

#include "app/command_bench.h"
#include "app/command_render.h"
#include "app/limits.h"
#include "app/scene_error.h"

namespace app {

int run_program(int argc, char** argv) {
  install_fault_handlers();
  CLI::App program("cusp: stress on an aortic valve, by the Moving Particle Semi-implicit method", "cusp");
  program.set_version_flag("--version", CUSP_VERSION);
  program.require_subcommand(1);
  int exit_code = 0;
  add_demo_command(program, exit_code);
  add_import_command(program, exit_code);
  add_explain_command(program, exit_code);
  add_run_command(program, exit_code);
  add_replay_command(program, exit_code);
  add_render_command(program, exit_code);
  add_view_command(program, exit_code);
  add_sweep_command(program, exit_code);
  add_accuracy_command(program, exit_code);
  add_bench_command(program, exit_code);
  add_validate_command(program, exit_code);
  add_export_command(program, exit_code);
  add_report_command(program, exit_code);
  add_info_command(program, exit_code);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    std::fprintf(stderr, "cusp: %s; `cusp --help` and `cusp COMMAND --help` say what can be typed\n", error.what());
    return 2;
  } catch (const SceneError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "cusp: not enough memory; make the spacing larger, or raise limits.memory or the system's limit\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return exit_code;
}

}  // namespace app
