// Draws one panel's scene (without text) with whatever OpenGL context is current: the same code for files and for a window.
#pragma once

#include <memory>

#include "render/frame.h"
#include "render/image.h"

namespace render {

struct DrawSettings {
  int supersampling = 1;          // 1: edges smoothed afterwards (fast); 2, 3: so many pixels squared for each (stills)
  bool ambient_occlusion = true;  // darkens where the sky is hidden, so that depth is read
  bool smooth_edges = true;       // at supersampling 1
};

class PanelPainter {
 public:
  PanelPainter();
  ~PanelPainter();
  // `drawn_pixels`, where given, receives the number of pixels that are not background.
  // `reserved_right`: see project() in camera.h.
  Image draw(const Frame& frame, const Panel& panel, int width, int height, int reserved_right, const DrawSettings& settings,
             long* drawn_pixels = nullptr);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// What the panel shows, clip plane or not; where nothing is, empty.
Bounds panel_bounds(const Frame& frame, const Panel& panel);
// The panel's camera for a picture of that size, as PanelPainter uses it (to place text).
Projection panel_projection(const Frame& frame, const Panel& panel, int width, int height, int reserved_right);

}  // namespace render
