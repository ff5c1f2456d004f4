#include "app/view_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "app/movie.h"
#include "app/valve_moments.h"
#include "app/view_plots.h"
#include "render/camera_motion.h"
#include "render/panel_painter.h"

namespace app {

// --- OpenRun ----------------------------------------------------------------------------------------------------------------------------

OpenRun::OpenRun(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code ignored;
  written_ = std::filesystem::last_write_time(path_, ignored);
  try {
    reader_ = std::make_unique<sim::RunReader>(path_);
  } catch (const std::runtime_error& error) {
    throw SceneError(error.what());
  }
  build();
}

void OpenRun::build() {
  plots_ = window_plots(*reader_, make_plots(reader_->header(), reader_->series()));
  if (reader_->frame_count() == 0) return;
  if (reader_->frame_count() >= 2 * ranged_frames_ || !growing()) {  // while a run grows, its scale changes seldom
    ranges_ = field_ranges({reader_.get()});
    ranged_frames_ = reader_->frame_count();
  }
  maker_ = std::make_unique<FrameMaker>(*reader_, PictureChoice{}, ranges_);
  frames_.clear();
  order_.clear();
}

bool OpenRun::refresh() {
  std::error_code ignored;
  const auto written = std::filesystem::last_write_time(path_, ignored);
  if (ignored || written == written_) return false;
  written_ = written;
  const std::size_t frames = reader_->frame_count(), rows = reader_->column("time").size();
  const std::string status = reader_->status();
  maker_.reset();
  reader_.reset();  // HDF5 shares what it knows of a file between openings: the old one has to go first
  for (int attempt = 0; !reader_; ++attempt) {
    try {
      reader_ = std::make_unique<sim::RunReader>(path_);
    } catch (const std::runtime_error& error) {
      if (attempt > 50) throw SceneError(error.what());
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // between two finished states
    }
  }
  build();
  return reader_->frame_count() != frames || reader_->column("time").size() != rows || reader_->status() != status;
}

const std::vector<double>& OpenRun::times() const {
  static const std::vector<double> none;
  return maker_ ? maker_->times() : none;
}

render::Frame& OpenRun::frame(std::size_t index) {
  const auto found = frames_.find(index);
  std::erase(order_, index);
  order_.push_back(index);
  if (found != frames_.end()) return *found->second;
  if (frames_.size() >= kept) {
    frames_.erase(order_.front());
    order_.erase(order_.begin());
  }
  return *frames_.emplace(index, std::make_unique<render::Frame>(maker_->make(index))).first->second;
}

// --- what is open -----------------------------------------------------------------------------------------------------------------------

void ViewModel::open_run(const std::filesystem::path& path) {
  main_ = std::make_unique<OpenRun>(path);
  ghost_.reset();
  picked.reset();
  camera_.reset();
  playing = false;
  time_ = main_->times().empty() ? 0 : main_->times().front();
  shown = Shown();
  const std::vector<std::string> there = views(), known = fields();
  if (std::find(there.begin(), there.end(), shown.view) == there.end()) shown.view = there.front();
  if (std::find(known.begin(), known.end(), shown.field) == known.end() && !known.empty()) shown.field = known.front();
}

void ViewModel::open_beside(const std::filesystem::path& path) {
  auto fresh = std::make_unique<OpenRun>(path);
  if (!ghost_) ghost_ = std::move(main_);  // a second replay is compared with the first run too
  main_ = std::move(fresh);
  picked.reset();
  shown.beside = true;
  if (!main_->times().empty()) go_to(time_);
}

void ViewModel::close_beside() {
  ghost_.reset();
  shown.beside = false;
}

std::vector<ComparedFigure> ViewModel::comparison() const {
  if (!ghost_ || !main_) return {};
  return compare_runs({&ghost_->reader(), &main_->reader()});
}

bool ViewModel::refresh() {
  if (!main_ || !main_->growing()) return false;
  const bool at_end = main_->times().empty() || time_ >= main_->times().back();
  if (!main_->refresh()) return false;
  if (at_end && !main_->times().empty()) time_ = main_->times().back();  // follows the run while it grows
  return true;
}

// --- time -------------------------------------------------------------------------------------------------------------------------------

void ViewModel::go_to(double time) {
  if (!main_ || main_->times().empty()) return;
  time_ = std::clamp(time, main_->times().front(), main_->times().back());
}

void ViewModel::advance(double seconds) {
  if (!playing || !main_ || main_->times().empty()) return;
  const double first = main_->times().front(), last = main_->times().back();
  time_ += seconds / slowness;
  if (time_ <= last) return;
  time_ = loop && last > first ? first + std::fmod(time_ - first, last - first) : last;
  if (!loop) playing = false;
}

std::size_t ViewModel::frame_index() const { return nearest_frame(main_->times(), time_); }

void ViewModel::step_frames(int by) {
  if (!main_ || main_->times().empty()) return;
  playing = false;
  const auto last = static_cast<long>(main_->times().size()) - 1;
  time_ = main_->times()[static_cast<std::size_t>(std::clamp(static_cast<long>(frame_index()) + by, 0L, last))];
}

// --- what is shown ----------------------------------------------------------------------------------------------------------------------

std::vector<std::string> ViewModel::views() const {
  if (!main_) return {};
  const sim::RunHeader& header = main_->reader().header();
  if (header.dimension == 2) return {"plane"};
  std::vector<std::string> names{"oblique", "front", "side", "top"};
  if (header.valve) names.insert(names.begin(), {"from_aorta", "from_ventricle", "long_axis", "short_axis", "pair"});
  return names;
}

std::vector<std::string> ViewModel::fields() const {
  std::vector<std::string> names;
  if (!main_) return names;
  for (const auto& [field, range] : main_->ranges()) names.push_back(field);
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) { return scale_slot(a) > scale_slot(b); });
  const auto stress = std::find(names.begin(), names.end(), "stress");
  if (stress != names.end()) std::rotate(names.begin(), stress, stress + 1);
  return names;
}

void ViewModel::look(const std::string& view) {
  const std::vector<std::string> there = views();
  if (std::find(there.begin(), there.end(), view) == there.end()) {
    std::string known;
    for (const std::string& name : there) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("this run has no view '" + view + "'; use one of " + known);
  }
  shown.view = view;
  camera_.reset();
}

namespace {

std::vector<View> views_of(const std::string& view, const std::string& field, const std::vector<std::string>& fields) {
  if (view != "pair") return {{view, field}};
  const bool blood = std::find(fields.begin(), fields.end(), "pressure") != fields.end();
  return {{"long_axis", blood ? "pressure" : "stress"}, {"long_axis", "stress"}};
}

// What carries the field is shown whatever the boxes say; the rest as they are ticked.
void hide_unwanted(render::Panel& panel, const Shown& shown) {
  std::erase_if(panel.surfaces, [&](const render::SurfaceLayer& layer) {
    return layer.surface < first_leaflet ? !shown.aorta : !shown.leaflets && layer.style.field < 0;
  });
  std::erase_if(panel.particles, [&](const render::ParticleLayer& layer) { return layer.set == fluid_set && !shown.blood; });
}

}  // namespace

std::vector<View> ViewModel::chosen() const { return views_of(shown.view, shown.field, fields()); }

Range2 ViewModel::range_of(const OpenRun& run, const render::Frame& frame, const std::string& field) const {
  if (shown.range == RangeMode::by_hand && field == shown.field) return shown.by_hand;
  const auto found = run.ranges().find(field);
  Range2 range = found == run.ranges().end() ? Range2{0, 1} : found->second;
  if (shown.range == RangeMode::this_moment) {
    const auto k = static_cast<std::size_t>(field_index(field));
    std::vector<float> values;
    if (is_fluid_field(field)) {
      values = frame.particles[fluid_set].fields[k];
    } else {
      values = frame.particles[solid_set].fields[k];
      for (std::size_t s = first_leaflet; s < frame.surfaces.size(); ++s)
        values.insert(values.end(), frame.surfaces[s].fields[k].begin(), frame.surfaces[s].fields[k].end());
    }
    if (values.size() > 1) {
      std::sort(values.begin(), values.end());
      const double low = field == "pressure" ? values[values.size() / 100] : std::min(0.0f, values.front());
      range = {low, values[values.size() - 1 - values.size() / 100]};
    }
  }
  if (ghost_ && shown.beside && shown.range == RangeMode::whole_run)
    for (const OpenRun* other : {main_.get(), ghost_.get()})
      if (const auto there = other->ranges().find(field); there != other->ranges().end())
        range = {std::min(range[0], there->second[0]), std::max(range[1], there->second[1])};
  if (!(range[1] > range[0])) range[1] = range[0] + std::max(1e-6 * std::abs(range[0]), 1e-6);
  return range;
}

void ViewModel::set_scales(OpenRun& run, render::Frame& frame) const {
  for (const auto* list : {&fluid_fields, &solid_fields})
    for (const std::string& field : *list) {
      render::ColorScale& scale = frame.scales[static_cast<std::size_t>(scale_slot(field))];
      const std::optional<double> highest = scale.highest;
      scale = field_scale(field, range_of(run, frame, field), shown.pressure_units, field == shown.field ? shown.map : "");
      scale.highest = highest;
    }
  for (std::size_t s = first_leaflet; s < frame.surfaces.size(); ++s) frame.surfaces[s].averaging = shown.smooth ? 2 : 0;
}

render::Panel ViewModel::panel_of(OpenRun& run, const View& view, render::Frame& frame) const {
  render::Panel panel = run.maker().panel(view, frame);
  if (camera_) {
    panel.camera = *camera_;
    if (!is_fluid_field(view.field)) panel.clip.reset();  // the surgeon's views cut what lies before the valve: no longer before it
  }
  if (shown.cut) {
    const Eigen::Vector3f back = panel.camera.backward.normalized();
    panel.clip = render::ClipPlane{panel.camera.target + static_cast<float>(shown.cut_at) * back, back};
    for (render::SurfaceLayer& layer : panel.surfaces) layer.style.clipped = layer.section = true;
    for (render::ParticleLayer& layer : panel.particles) layer.section = true;
  }
  hide_unwanted(panel, shown);
  return panel;
}

// The moment of the other run: the same; beside a dry preview of the closed valve, the moment when the other's valve is closed.
double ViewModel::ghost_time() const {
  const sim::RunHeader& header = main_->reader().header();
  if (!(header.valve && header.ports.empty())) return time_;
  const std::optional<ValveMoments> moments = valve_moments(ghost_->reader());
  return moments ? moments->closed : time_;
}

std::vector<ViewModel::Picture> ViewModel::pictures() {
  std::vector<Picture> all;
  if (!main_ || main_->times().empty()) return all;
  const auto add = [&](OpenRun& run, double time, const std::string& whose) {
    render::Frame& frame = run.frame(nearest_frame(run.times(), time));
    set_scales(run, frame);
    for (const View& view : chosen()) {
      all.push_back({&frame, panel_of(run, view, frame)});
      if (!whose.empty()) all.back().panel.title = whose + ": " + all.back().panel.title;
    }
  };
  const bool both = ghost_ && shown.beside && !ghost_->times().empty();
  if (both) add(*ghost_, ghost_time(), "before");
  const sim::RunHeader& header = main_->reader().header();
  const bool dry = header.valve && header.ports.empty();
  add(*main_, time_, both && dry ? "after, without blood" : both ? "after" : dry ? "without blood" : "");
  return all;
}

void ViewModel::orbit(float right, float down) {
  const std::vector<Picture> all = pictures();
  if (!all.empty()) camera_ = render::orbited(all.front().panel.camera, right, down);
}

void ViewModel::pan(float right, float down) {
  const std::vector<Picture> all = pictures();
  if (all.empty()) return;
  const render::Camera& camera = all.front().panel.camera;
  camera_ = render::panned(camera, right * camera.height, down * camera.height);
}

void ViewModel::zoom(float factor) {
  const std::vector<Picture> all = pictures();
  if (all.empty()) return;
  const float whole = std::max(2 * render::panel_bounds(*all.front().frame, all.front().panel).radius(), 1e-6f);
  camera_ = render::zoomed(all.front().panel.camera, factor, whole);
}

std::string ViewModel::signature() const {
  if (!main_ || main_->times().empty()) return "";
  std::string text = main_->path().string() + " " + std::to_string(main_->times().size()) + " " + std::to_string(frame_index());
  if (ghost_ && shown.beside) text += " " + std::to_string(nearest_frame(ghost_->times(), ghost_time()));
  const auto add = [&](double value) { text += " " + std::to_string(value); };
  text += " " + shown.view + " " + shown.field + " " + shown.map + " " + shown.pressure_units;
  for (const double value : {static_cast<double>(shown.range), shown.by_hand[0], shown.by_hand[1], 1e6 * shown.cut_at}) add(value);
  for (const bool ticked : {shown.aorta, shown.leaflets, shown.blood, shown.smooth, shown.cut, shown.beside}) text += ticked ? '1' : '0';
  if (camera_)
    for (const Eigen::Vector3f& v : {camera_->target, camera_->backward, camera_->up, Eigen::Vector3f(camera_->width, 0, 0)})
      for (int k = 0; k < 3; ++k) add(1e3 * v[k]);
  if (picked) text += " " + std::to_string(picked->row);
  return text;
}

std::string ViewModel::status_text() const {
  if (!main_) return "nothing open";
  const std::string name = main_->path().filename().string();
  if (main_->times().empty()) return name + ": no finished frame yet";
  std::string text = name + ", frame " + std::to_string(frame_index() + 1) + " of " + std::to_string(main_->times().size());
  if (main_->growing()) text += ", still being written";
  return text;
}

}  // namespace app
