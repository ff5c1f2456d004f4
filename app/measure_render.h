// How long a picture takes: `cusp render --measure`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "app/movie.h"

namespace app {

struct RenderSpeed {
  std::size_t pictures = 0, particles = 0, panels = 0;
  double read = 0;   // s: a frame out of the run file and into a render::Frame; mean
  double full = 0;   // s: drawn as a movie shows it; mean
  double draft = 0;  // s: drawn with less detail, as the window does while the mouse moves (draft_settings); mean
  double full_processor = 0, draft_processor = 0;  // s of all processors together for the same; other programs do not lengthen it
  std::string driver;
};

// What the window draws while something moves: half the pixels each way, no darkened corners, no smoothed edges.
render::PictureSettings draft_settings(int width, int height);

// Draws `pictures` frames of the job's first run, spread over it.
RenderSpeed measure_render(const MovieJob& job, int pictures);
nlohmann::json render_speed_json(const RenderSpeed& speed);

}  // namespace app
