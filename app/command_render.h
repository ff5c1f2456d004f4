// cusp render RUN.h5... [-o movie.mp4 | frames/%04d.png | picture.png]
#pragma once

#include <CLI/CLI.hpp>

namespace app {

void add_render_command(CLI::App& program, int& exit_code);

}  // namespace app
