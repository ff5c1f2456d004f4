// cusp view [RUN.h5 | SCENE | MESH]: the window.
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "app/commands.h"
#include "app/view_window.h"

namespace app {
namespace {

struct Options {
  std::string file, script, size = "1600x1000";
};

int view(const Options& options) {
  WindowSettings settings;
  char rest = 0;
  if (std::sscanf(options.size.c_str(), "%dx%d%c", &settings.width, &settings.height, &rest) != 2 || settings.width < 800 ||
      settings.height < 500)
    throw SceneError("--size " + options.size + ": is no size of 800x500 or more; as in 1600x1000");
  std::optional<ScriptRunner> script;
  if (!options.script.empty()) {
    std::ifstream file(options.script);
    if (!file) throw SceneError(options.script + ": no such file; give a list of steps");
    std::stringstream text;
    text << file.rdbuf();
    script.emplace(read_script(text.str(), options.script), options.script);
  }
  ViewSession session(own_program());
  if (!options.file.empty()) session.open(options.file);
  run_window(session, settings, std::move(script));
  return 0;
}

}  // namespace

void add_view_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("view", "the window: look, change the stiffness, replay");
  command->footer(
      "Example: cusp view out/demo/run.h5\n"
      "Steps of a script, one a line: open FILE, view NAME, field NAME, map NAME, range run|moment, cut MM|off, time SECONDS|open|closed,\n"
      "play, pause, slow FACTOR, orbit DEG DEG, zoom FACTOR, pick X Y, set KNOB VALUE, spot RADIUS_MM TIMES, preview KPA, replay, cancel,\n"
      "beside on|off, accept, wait SECONDS, wait_ready, wait_frames N, screenshot FILE.png, print, close");
  command->add_option("FILE", options->file, "run (.h5, also one that is still being written), scene (.toml) or mesh");
  command->add_option("--script", options->script, "a file of steps that drive the window instead of a hand; it closes after the last");
  command->add_option("--size", options->size, "of the window in pixels")->capture_default_str();
  command->callback([options, &exit_code] { exit_code = view(*options); });
}

}  // namespace app
