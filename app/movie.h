// Runs to movies and pictures: what `cusp render` does, callable from other commands.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/make_frame.h"
#include "render/renderer.h"

namespace app {

struct CameraKey {
  std::string view;
  double time = 0;  // s, simulated
};

struct MovieJob {
  std::vector<std::filesystem::path> runs;  // several: side by side, at the same time, with the same scales
  std::filesystem::path output;             // .mp4, .webp, .gif; .png with %04d (a sequence) or without (one picture)
  PictureChoice choice;                     // choice.label is ignored where there are several runs; their titles are shown
  std::vector<std::string> labels;          // one a run, instead of their titles
  int width = 1920, height = 1080;
  double fps = 25;
  std::optional<double> slow;         // movie seconds per simulated second; absent: every frame of the run once
  double hold = 0;                    // s that a movie of a valve rests where it is widest open, and where it closes
  std::optional<double> time;         // s: the one moment of a picture; absent: the last
  bool open = false, closed = false;  // of a picture: the moment when the valve is widest open, or closed and at rest (valve_moments.h)
  std::vector<CameraKey> path;        // not empty: one panel whose camera goes through these views; choice.views is ignored
  bool difference = false;            // two runs: what the second's solids have more than the first's, as a third picture
  std::string caption;                // beside the standing one, bottom right
  int quality = 0;                    // pixels squared for each drawn one; 0: 2 for single pictures, 1 for movies
  const std::atomic<bool>* stop = nullptr;  // set by Ctrl-C: the movie ends there and is kept
  std::function<void(std::size_t done, std::size_t all, double seconds)> progress;
};

struct MovieResult {
  std::size_t frames = 0;
  double seconds = 0;  // wall time
  bool stopped = false;
  std::string driver;
};

// Throws std::invalid_argument (one line) for what the user can mend, std::runtime_error for what failed.
MovieResult make_movie(const MovieJob& job);

// Which run frame each movie frame shows, for frames at `times`. `slow` and `hold` as in MovieJob; `held` = run frames to rest on.
std::vector<std::size_t> movie_schedule(const std::vector<double>& times, double fps, std::optional<double> slow, double hold,
                                        const std::vector<std::size_t>& held);
// "from_aorta@0,long_axis@0.4" as keys. Throws std::invalid_argument where a key has no time or the times do not increase.
std::vector<CameraKey> read_camera_path(const std::string& text);
// The panel at a time on the path: `panels` = those of the keys' views. Between two different views nothing is cut open.
render::Panel panel_on_path(const std::vector<render::Panel>& panels, const std::vector<CameraKey>& path, double time);
// The frame nearest to the time.
std::size_t nearest_frame(const std::vector<double>& times, double time);
// "frames/%04d.png" with the number in place. Throws where the pattern holds no or another conversion.
std::string numbered_path(const std::string& pattern, std::size_t number);

}  // namespace app
