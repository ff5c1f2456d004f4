// One picture of the window with its title, colour bar and the picked place: whatever OpenGL context is current draws it.
#pragma once

#include <optional>

#include "app/view_model.h"
#include "render/overlay.h"
#include "render/panel_painter.h"

namespace app {

struct WindowPicture {
  render::Image image;
  int top = 0, reserved_right = 0;  // pixels that the title and the colour bar take
};

// `draft`: half the pixels each way and no darkened corners, for while something moves.
WindowPicture draw_window_picture(render::PanelPainter& painter, render::Lettering& lettering, const ViewModel::Picture& picture,
                                  const std::optional<Picked>& picked, int width, int height, bool draft);

}  // namespace app
