// One sitting at the window: what is open, the sliders, the run in the background. No window needed.
#pragma once

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "app/child_process.h"
#include "app/view_knobs.h"
#include "app/view_model.h"
#include "render/image.h"

namespace app {

class ViewSession {
 public:
  // `program`: the cusp that background runs are made with.
  explicit ViewSession(std::string program);
  ~ViewSession();

  // A run file is shown at once; a scene is placed in the background and shown when it is; a mesh is imported in the background, its
  // picture shown. Throws SceneError (one line) for what is none of them.
  void open(const std::filesystem::path& path);
  // Looks after the background run: opens its file when there is a frame, reads on, notes its end. Call it often.
  void poll();

  ViewModel model;
  Knobs start, now;  // the sliders as the case has them, and as they stand
  bool has_case() const { return scene_.has_value(); }
  bool valve() const { return scene_ && scene_->patient.has_value(); }
  std::string changes() const { return knobs_text(start, now); }

  // The case as the sliders have it, simulated in the background beside the run that is open (or on its own). Throws SceneError.
  void replay();
  bool busy() const { return child_ != nullptr; }
  double progress() const { return child_ ? child_->progress() : 0; }
  std::string progress_text() const;
  void cancel();  // what was simulated stays

  // Leaflets alone under a pressure difference (dry_case.h), here and now: `step` is called after every step of it with the part done.
  // Returns the seconds from the call to the new valve. Particles that the sliders do not move are placed once, from the moment on at which
  // the case is opened, in the background. Throws SceneError.
  double preview(double pressure, const std::function<void(double)>& step);
  double placing_seconds() const { return placing_seconds_; }  // that previews waited for the placement; 0 before the first
  bool placing() const;                                        // in the background still

  // Of a mesh: what import understood, and the way on. Shifts in m along the planes' normals, on top of what was found.
  const std::optional<render::Image>& import_picture() const { return import_picture_; }
  double annulus_shift = 0, junction_shift = 0;
  void accept_import();  // places the valve with the shifts; then as a scene

  std::string message;  // the last thing to tell the user, one line

 private:
  enum class Job { none, place, import, replay };
  void start_job(Job job, const std::vector<std::string>& arguments, const std::filesystem::path& result);
  void finish_job();
  void read_case_of_run();
  void place_ahead();
  void place_scene(const std::filesystem::path& path);
  std::string program_;
  std::filesystem::path folder_;  // for what need not be kept
  std::optional<SceneFile> scene_;
  std::filesystem::path first_run_, scene_path_, result_;
  std::vector<std::string> scene_settings_;
  std::unique_ptr<ChildProcess> child_;
  Job job_ = Job::none;
  bool result_open_ = false;
  int replays_ = 0, previews_ = 0;
  std::shared_ptr<const CaseParticles> placed_;
  std::vector<std::string> placed_for_;
  std::future<std::shared_ptr<const CaseParticles>> ahead_;  // the case as it was opened, being placed
  double placing_seconds_ = 0;
  std::optional<render::Image> import_picture_;
};

}  // namespace app
