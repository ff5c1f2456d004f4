// The window itself: GLFW, OpenGL and Dear ImGui around a ViewSession. The pictures in it are drawn by render::PanelPainter, the same code
// that draws without a display.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/view_script.h"

namespace app {

struct WindowSettings {
  int width = 1600, height = 1000;
  bool draft = true;  // less detail while something moves
};

// Runs the window until it is closed, or until the script is done where there is one. Throws std::runtime_error where there is no display
// or no OpenGL 3.3, naming `cusp render`.
void run_window(ViewSession& session, const WindowSettings& settings, std::optional<ScriptRunner> script);

}  // namespace app
