// Frames to pictures, without a display.
#pragma once

#include <memory>
#include <string>

#include "render/frame.h"
#include "render/image.h"
#include "render/panel_painter.h"

namespace render {

struct PictureSettings {
  int width = 1920, height = 1080;  // pixels, at least 160 x 120
  DrawSettings draw;
};

// Owns an OpenGL context; use it from the thread that made it. The same frame gives the same pixels on the same driver.
class Renderer {
 public:
  Renderer();  // throws std::runtime_error where no EGL device works, saying what was tried
  ~Renderer();
  // Throws std::invalid_argument for a frame that does not hold together (check_frame), std::runtime_error where a panel would be all
  // background.
  Image draw(const Frame& frame, const PictureSettings& settings);
  const std::string& driver() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace render
