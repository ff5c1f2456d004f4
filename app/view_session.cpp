#include "app/view_session.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/build_case.h"

namespace app {
namespace {

namespace fs = std::filesystem;

double wall_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string lower_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::vector<std::string> with_settings(std::vector<std::string> arguments, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  return arguments;
}

// Those of the settings that decide where particles lie.
std::vector<std::string> placing_settings(const std::vector<std::string>& settings) {
  std::vector<std::string> placing;
  for (const std::string& setting : settings)
    if (moves_particles(setting)) placing.push_back(setting);
  return placing;
}

// "{ center = [...], normal = [...] }" of a plane of import.json, in m, moved along its normal.
std::string plane_text(const nlohmann::json& ring, double shift) {
  double center[3], normal[3];
  for (std::size_t k = 0; k < 3; ++k) normal[k] = ring.at("normal").at(k).get<double>();
  for (std::size_t k = 0; k < 3; ++k) center[k] = 1e-3 * ring.at("center_mm").at(k).get<double>() + shift * normal[k];
  char text[256];
  std::snprintf(text, sizeof text, "{ center = [%.9g, %.9g, %.9g], normal = [%.9g, %.9g, %.9g] }", center[0], center[1], center[2],
                normal[0], normal[1], normal[2]);
  return text;
}

}  // namespace

ViewSession::ViewSession(std::string program)
    : program_(std::move(program)), folder_(fs::temp_directory_path() / ("cusp_view_" + std::to_string(getpid()))) {
  fs::create_directories(folder_);
}

ViewSession::~ViewSession() {
  child_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void ViewSession::open(const fs::path& path) {
  const std::string ending = lower_ending(path);
  if (!fs::is_regular_file(path)) throw SceneError(path.string() + ": no such file; give a run (.h5), a scene (.toml) or a mesh");
  child_.reset();
  job_ = Job::none;
  import_picture_.reset();
  placed_.reset();
  ahead_ = {};
  if (ending == ".h5") {
    model.open_run(path);
    first_run_ = path;
    message.clear();
    read_case_of_run();
  } else if (ending == ".toml") {
    scene_settings_.clear();
    place_scene(path);
  } else {
    scene_.reset();
    start_job(Job::import, {"import", fs::absolute(path).string(), "-o", (folder_ / "import").string()}, folder_ / "import" / "import.png");
    message = "reading the mesh " + path.filename().string();
  }
}

// Its first frame, made in the background: a run of one short step.
void ViewSession::place_scene(const fs::path& path) {
  scene_ = read_scene_file(path, scene_settings_);
  scene_path_ = fs::absolute(path);
  start = now = knobs_of(*scene_);
  first_run_.clear();
  placed_.reset();
  ahead_ = {};
  import_picture_.reset();
  start_job(Job::place,
            with_settings({"run", scene_path_.string(), "-o", (folder_ / "first.h5").string(), "--set", "time.end=1e-7"}, scene_settings_),
            folder_ / "first.h5");
  message = "placing the particles of " + path.filename().string();
}

// A run file holds its scene; where that cannot be read any more (its meshes have gone) the run is shown all the same.
void ViewSession::read_case_of_run() {
  try {
    scene_ = scene_of_run(fs::absolute(first_run_), model.run().reader().header(), {});
    start = now = knobs_of(*scene_);
    place_ahead();
  } catch (const std::exception& error) {
    scene_.reset();
    message = std::string("it can be looked at but not replayed: ") + error.what();
  }
}

// A valve's particles as the case has them, while the user still looks: the first preview then need not wait.
void ViewSession::place_ahead() {
  if (!scene_->patient || scene_->dimension != 3) return;
  ahead_ = std::async(std::launch::async, [scene = *scene_] { return place_case(scene); });
}

bool ViewSession::placing() const { return ahead_.valid() && ahead_.wait_for(std::chrono::seconds(0)) != std::future_status::ready; }

void ViewSession::start_job(Job job, const std::vector<std::string>& arguments, const fs::path& result) {
  child_.reset();
  std::error_code ignored;
  fs::remove(result, ignored);
  result_ = result, result_open_ = false, job_ = job;
  child_ = std::make_unique<ChildProcess>(program_, arguments);
}

void ViewSession::replay() {
  if (busy()) throw SceneError("a run is being made already; wait for it or cancel it");
  if (!scene_) throw SceneError("there is no case to simulate: open a run or a scene");
  const std::vector<std::string> settings = knob_settings(start, now);
  if (!first_run_.empty()) {
    if (settings.empty()) throw SceneError("nothing is changed yet: move a slider first");
    const fs::path result = first_run_.parent_path() / (first_run_.stem().string() + "_replay" + std::to_string(++replays_) + ".h5");
    start_job(Job::replay, with_settings({"replay", first_run_.string(), "-o", result.string()}, settings), result);
  } else {
    std::vector<std::string> all = scene_settings_;
    all.insert(all.end(), settings.begin(), settings.end());
    const fs::path result = scene_path_.parent_path() / (scene_path_.stem().string() + ".h5");
    start_job(Job::replay, with_settings({"run", scene_path_.string(), "-o", result.string()}, all), result);
  }
  message = "simulating: " + changes();
}

void ViewSession::cancel() {
  if (!child_) return;
  child_->interrupt();
  message = "stopping; what was simulated is kept";
}

std::string ViewSession::progress_text() const {
  if (!child_) return "";
  char text[96];
  std::snprintf(text, sizeof text, "%.0f %%%s%s", 100 * child_->progress(), child_->time_left().empty() ? "" : ", still ",
                child_->time_left().c_str());
  return text;
}

void ViewSession::poll() {
  const bool running = child_ && child_->running();
  if (child_ && (job_ == Job::replay || job_ == Job::place)) {
    if (result_open_) {
      model.refresh();
    } else if (fs::exists(result_)) {
      try {
        if (sim::RunReader(result_).frame_count() > 0) {
          const bool beside = job_ == Job::replay && !first_run_.empty();
          if (beside)
            model.open_beside(result_);
          else
            model.open_run(result_);
          result_open_ = true;
        }
      } catch (const std::exception&) {  // not yet a whole file
      }
    }
  }
  if (child_ && !running) finish_job();
  if (!child_) model.refresh();  // a file that somebody else writes
}

void ViewSession::finish_job() {
  const int code = child_->exit_code();
  const std::string last = child_->last_line();
  const Job job = job_;
  child_.reset();
  job_ = Job::none;
  if (result_open_) model.refresh();
  if (job == Job::import && code == 0 && fs::exists(result_)) {
    import_picture_ = render::read_png(result_.string());
    message = "look whether ends, root and valve are understood; then accept";
  } else if (job == Job::replay && result_open_) {
    if (first_run_.empty()) first_run_ = result_;
    message = code == 0 ? "simulated: " + result_.filename().string() : "stopped; " + result_.filename().string() + " keeps what there is";
  } else if (code == 0) {
    if (job == Job::place && scene_) place_ahead();
    message = "ready";
  } else {
    message = last.empty() ? "the background run failed" : last;
  }
}

double ViewSession::preview(double pressure, const std::function<void(double)>& step) {
  if (!scene_) throw SceneError("there is no case to preview: open a run or a scene");
  const double began = wall_seconds();
  std::vector<std::string> settings = knob_settings(start, now);
  const SceneFile scene = first_run_.empty()
                              ? [&] {
                                  std::vector<std::string> all = scene_settings_;
                                  all.insert(all.end(), settings.begin(), settings.end());
                                  return read_scene_file(scene_path_, all);
                                }()
                              : scene_of_run(fs::absolute(first_run_), sim::RunReader(first_run_).header(), settings);
  const std::vector<std::string> placing = placing_settings(settings);
  if (!placed_ || placing != placed_for_) {
    placed_ = ahead_.valid() && placing.empty() ? ahead_.get() : place_case(scene);
    placed_for_ = placing;
    placing_seconds_ = wall_seconds() - began;
  }
  RunCaseOptions options;
  options.quiet = true, options.placed = placed_;
  options.dry = DrySettings{};
  options.dry->pressure = pressure;
  options.output = folder_ / ("dry" + std::to_string(++previews_) + ".h5");
  options.progress = [&](const sim::RunProgress& progress) {
    if (step) step(progress.end > 0 ? progress.time / progress.end : 1);
  };
  const sim::RunResult result = run_case(scene, options);
  if (result.ending == sim::RunEnding::failed) throw SceneError("the preview failed: " + result.message);
  const Shown shown = model.shown;
  const bool had = model.has_run();
  if (had)
    model.open_beside(options.output);
  else
    model.open_run(options.output);
  if (had) model.shown = shown, model.shown.beside = true;
  model.go_to(1e300);
  const double taken = wall_seconds() - began;
  char text[160];
  std::snprintf(text, sizeof text, "without blood: closed under %.1f kPa in %.1f s (%s)", pressure / 1000, taken, changes().c_str());
  message = text;
  return taken;
}

void ViewSession::accept_import() {
  const fs::path scene = folder_ / "import" / "scene.toml", found = folder_ / "import" / "import.json";
  if (!fs::exists(scene)) throw SceneError("import found no valve to place: " + message);
  scene_settings_.clear();
  if (annulus_shift != 0 || junction_shift != 0) {
    std::ifstream file(found);
    const nlohmann::json json = nlohmann::json::parse(file);
    if (annulus_shift != 0) scene_settings_.push_back("patient.root.annulus=" + plane_text(json.at("root").at("annulus"), annulus_shift));
    if (junction_shift != 0)
      scene_settings_.push_back("patient.root.sinotubular_junction=" +
                                plane_text(json.at("root").at("sinotubular_junction"), junction_shift));
  }
  place_scene(scene);
}

}  // namespace app
