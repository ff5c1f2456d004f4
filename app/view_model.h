// What the window shows and why, without a window: opened runs, the moment, the view, what is picked. Panels (view_panels.h) change it,
// the window (view_window.h) draws what it says, tests look at it.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/make_frame.h"
#include "app/replay.h"

namespace app {

// A run file that is looked at; it may still be written.
class OpenRun {
 public:
  // Throws SceneError (one line) where the file is no run.
  explicit OpenRun(std::filesystem::path path);
  // Reads again what is there; true where frames or rows were added. Throws SceneError where the file has gone.
  bool refresh();
  bool growing() const { return reader_->status() == "running"; }
  std::size_t frame_count() const { return maker_ ? maker_->times().size() : 0; }
  const std::vector<double>& times() const;
  const sim::RunReader& reader() const { return *reader_; }
  const FrameMaker& maker() const { return *maker_; }
  const FieldRanges& ranges() const { return ranges_; }
  const std::vector<render::Plot>& plots() const { return plots_; }
  const std::filesystem::path& path() const { return path_; }
  // The frame as the file has it; the last `kept` ones stay in memory, so that scrubbing is quick.
  render::Frame& frame(std::size_t index);

 private:
  void build();
  static constexpr std::size_t kept = 48;
  std::filesystem::path path_;
  std::filesystem::file_time_type written_;  // when the file was last changed before it was read
  std::unique_ptr<sim::RunReader> reader_;
  std::unique_ptr<FrameMaker> maker_;
  FieldRanges ranges_;
  std::size_t ranged_frames_ = 0;
  std::vector<render::Plot> plots_;
  std::map<std::size_t, std::unique_ptr<render::Frame>> frames_;
  std::vector<std::size_t> order_;  // of use, the latest last
};

enum class RangeMode { whole_run, this_moment, by_hand };

// What the user chose to see.
struct Shown {
  std::string view = "from_aorta";  // a view of the run, or "pair"
  std::string field = "stress";
  std::string map;  // empty: the field's own
  std::string pressure_units = "kPa";
  RangeMode range = RangeMode::whole_run;
  Range2 by_hand{0, 1};  // SI
  bool aorta = true, leaflets = true, blood = true, smooth = true;
  bool cut = false;     // a plane across the line of sight, on top of the view's own
  double cut_at = 0;    // m along the line of sight, from the middle of the picture towards the eye
  bool beside = false;  // the run before, beside the new one, on the same scale
};

// A particle that the user clicked on, and what it went through.
struct Picked {
  std::int64_t row = -1;
  std::string what;                 // "leaflet_2, particle 113"
  Eigen::Vector3f place{0, 0, 0};   // m, at present
  Eigen::Vector3d start{0, 0, 0};   // m, in the first frame
  std::vector<double> time, value;  // of the shown field, SI, as far as read
  std::size_t read = 0;             // frames read so far
};

class ViewModel {
 public:
  // --- what is open
  void open_run(const std::filesystem::path& path);     // replaces what is shown
  void open_beside(const std::filesystem::path& path);  // the new run beside the one that was open: that becomes the ghost
  void close_beside();
  bool has_run() const { return main_ != nullptr; }
  OpenRun& run() { return *main_; }
  const OpenRun& run() const { return *main_; }
  OpenRun* ghost() { return ghost_.get(); }
  const std::vector<render::Plot>* ghost_plots() const { return ghost_ ? &ghost_->plots() : nullptr; }
  std::vector<ComparedFigure> comparison() const;  // empty without a ghost
  bool refresh();                                  // of files that grow

  // --- time
  bool playing = false, loop = true;
  double slowness = 10;          // seconds on the wall per simulated second
  void advance(double seconds);  // of wall time, while playing
  void go_to(double time);       // s; cut to the run's
  void step_frames(int by);
  double time() const { return time_; }
  std::size_t frame_index() const;

  // --- what is shown
  Shown shown;
  std::vector<std::string> views() const;   // that the run has, "pair" first for a valve
  std::vector<std::string> fields() const;  // that the run has
  void look(const std::string& view);       // a standard view again, as it is; throws std::invalid_argument naming those there are
  void orbit(float right, float down);      // rad
  void pan(float right, float down);        // shares of the picture's height
  void zoom(float factor);

  // One picture: a panel of a frame. Pointers hold until the next call.
  struct Picture {
    const render::Frame* frame;
    render::Panel panel;
  };
  std::vector<Picture> pictures();
  std::string signature() const;    // changes when the pictures would
  std::string status_text() const;  // "run.h5, frame 12 of 101, still being written"

  // --- picking: x, y in pixels within picture `number` of `pictures()` drawn at that size
  bool pick(std::size_t number, int width, int height, int reserved_right, float x, float y);
  void read_history(std::size_t frames);  // some more of the picked particle's history
  std::optional<Picked> picked;

 private:
  render::Panel panel_of(OpenRun& run, const View& view, render::Frame& frame) const;
  void set_scales(OpenRun& run, render::Frame& frame) const;
  Range2 range_of(const OpenRun& run, const render::Frame& frame, const std::string& field) const;
  std::vector<View> chosen() const;
  double ghost_time() const;
  std::unique_ptr<OpenRun> main_, ghost_;
  double time_ = 0;
  std::optional<render::Camera> camera_;  // the user's own; absent: the view's
};

}  // namespace app
