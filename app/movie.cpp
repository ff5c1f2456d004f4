#include "app/movie.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "app/difference.h"
#include "app/run_names.h"
#include "app/valve_moments.h"
#include "render/camera_motion.h"
#include "render/video.h"

namespace app {

std::size_t nearest_frame(const std::vector<double>& times, double time) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - time) < std::abs(times[best] - time)) best = i;
  return best;
}

std::vector<std::size_t> movie_schedule(const std::vector<double>& times, double fps, std::optional<double> slow, double hold,
                                        const std::vector<std::size_t>& held) {
  std::vector<std::size_t> schedule;
  if (times.empty()) return schedule;
  if (slow) {
    const auto count = static_cast<std::size_t>(std::llround((times.back() - times.front()) * *slow * fps)) + 1;
    for (std::size_t k = 0; k < count; ++k)
      schedule.push_back(nearest_frame(times, times.front() + static_cast<double>(k) / (fps * *slow)));
  } else {
    for (std::size_t i = 0; i < times.size(); ++i) schedule.push_back(i);
  }
  const auto rest = static_cast<std::size_t>(std::llround(hold * fps));
  for (const std::size_t frame : held) {
    const auto at = std::find(schedule.begin(), schedule.end(), frame);
    if (at != schedule.end()) schedule.insert(at, rest, frame);
  }
  return schedule;
}

std::string numbered_path(const std::string& pattern, std::size_t number) {
  static const std::regex conversion("%(0[0-9]+)?d");
  std::smatch found;
  if (!std::regex_search(pattern, found, conversion) || std::count(pattern.begin(), pattern.end(), '%') != 1)
    throw std::invalid_argument("-o '" + pattern + "': a sequence of pictures is named like frames/%04d.png");
  std::string digits = std::to_string(number);
  const std::size_t width = found[1].matched ? std::stoul(found[1].str()) : 0;
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return found.prefix().str() + digits + found.suffix().str();
}

std::vector<CameraKey> read_camera_path(const std::string& text) {
  std::vector<CameraKey> path;
  std::stringstream keys(text);
  for (std::string key; std::getline(keys, key, ',');) {
    const auto at = key.find('@');
    char rest = 0;
    double time = 0;
    if (at == std::string::npos || at == 0 || std::sscanf(key.c_str() + at + 1, "%lf%c", &time, &rest) != 1)
      throw std::invalid_argument("--path: '" + key + "' is no step of a path; write VIEW@SECONDS, as in from_aorta@0,long_axis@0.4");
    if (!path.empty() && time <= path.back().time) throw std::invalid_argument("--path: the times do not increase at '" + key + "'");
    path.push_back({key.substr(0, at), time});
  }
  if (path.empty()) throw std::invalid_argument("--path: is empty; write VIEW@SECONDS, as in from_aorta@0,long_axis@0.4");
  return path;
}

render::Panel panel_on_path(const std::vector<render::Panel>& panels, const std::vector<CameraKey>& path, double time) {
  if (panels.size() != path.size())
    throw std::invalid_argument("--path: goes through views of one picture each, so not through pair or standard");
  std::size_t next = 0;
  while (next < path.size() && path[next].time <= time) ++next;
  if (next == 0) return panels.front();
  if (next == path.size()) return panels.back();
  const double part = render::eased((time - path[next - 1].time) / (path[next].time - path[next - 1].time));
  render::Panel panel = panels[part < 0.5 ? next - 1 : next];
  panel.camera = render::between(panels[next - 1].camera, panels[next].camera, part);
  if (part > 0 && path[next - 1].view != path[next].view) panel.clip.reset();
  return panel;
}

namespace {

enum class Output { movie, sequence, picture };

Output output_kind(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".mp4" || ending == ".webp" || ending == ".gif") return Output::movie;
  if (ending == ".png") return path.string().find('%') != std::string::npos ? Output::sequence : Output::picture;
  throw std::invalid_argument(
      "-o '" + path.string() +
      "': use a name that ends in .mp4 (a movie), .webp or .gif (a preview), .png (one picture) or %04d.png (a sequence)");
}

void check_job(const MovieJob& job, Output kind) {
  if (job.runs.empty()) throw std::invalid_argument("no run file was given");
  if (kind == Output::sequence) numbered_path(job.output.string(), 0);
  if (!(job.fps >= 1 && job.fps <= 240)) throw std::invalid_argument("--fps: give 1 to 240 frames a second");
  if (job.slow && !(*job.slow > 0 && *job.slow < 1e6))
    throw std::invalid_argument("--slow: give a number above 0 (movie seconds per simulated second)");
  if (!(job.hold >= 0 && job.hold <= 60)) throw std::invalid_argument("--hold: give 0 to 60 seconds");
  if (job.width < 160 || job.height < 120 || job.width > 16384 || job.height > 16384)
    throw std::invalid_argument("--size: give 160x120 to 16384x16384 pixels");
  if (!job.labels.empty() && job.labels.size() != job.runs.size()) throw std::invalid_argument("--label: give one for each run");
  if ((job.time || job.open || job.closed) && kind != Output::picture)
    throw std::invalid_argument("--time, --open, --closed: are for one picture; name it with -o PICTURE.png");
  if (static_cast<int>(job.time.has_value()) + job.open + job.closed > 1)
    throw std::invalid_argument("--time, --open, --closed: give one of them");
  if (job.difference && job.runs.size() != 2) throw std::invalid_argument("--difference: is between two runs; give two");
}

// Where a valve is widest open, and where it is closed and at rest.
std::vector<std::size_t> states_to_hold(const sim::RunReader& run, const std::vector<double>& times) {
  const std::optional<ValveMoments> moments = valve_moments(run);
  if (!moments) return {};
  return {nearest_frame(times, moments->open), nearest_frame(times, moments->closed)};
}

std::size_t frame_of_picture(const MovieJob& job, const sim::RunReader& run, const std::vector<double>& times) {
  if (!job.open && !job.closed) return job.time ? nearest_frame(times, *job.time) : times.size() - 1;
  const std::optional<ValveMoments> moments = valve_moments(run);
  if (!moments)
    throw std::invalid_argument(job.runs.front().string() + ": has no valve that opens; give --time instead of --open or --closed");
  return nearest_frame(times, job.open ? moments->open : moments->closed);
}

// The first frame's plots, with the curves of the others in those where each run has a single one.
void compare_plots(std::vector<render::Frame>& frames, const std::vector<std::string>& names) {
  static const std::vector<render::Color> colors = {
      {0.10f, 0.32f, 0.66f}, {0.85f, 0.45f, 0.05f}, {0.10f, 0.50f, 0.40f}, {0.55f, 0.20f, 0.55f}};
  for (std::size_t p = 0; p < frames.front().plots.size(); ++p) {
    render::Plot& plot = frames.front().plots[p];
    if (plot.curves.size() != 1) continue;
    plot.curves[0].label = names.front();
    plot.curves[0].color = colors[0];
    for (std::size_t i = 1; i < names.size(); ++i) {
      if (p >= frames[i].plots.size() || frames[i].plots[p].label != plot.label || frames[i].plots[p].curves.size() != 1) continue;
      render::Curve curve = frames[i].plots[p].curves[0];
      curve.label = names[i];
      curve.color = colors[i % colors.size()];
      plot.curves.push_back(curve);
    }
  }
}

// All runs of a job, opened, with common ranges.
struct Runs {
  std::vector<sim::RunReader> readers;
  std::vector<FrameMaker> makers;
  std::vector<CameraKey> path;
  std::vector<double> extent;  // of the differences; empty: none are shown
  std::string caption;

  explicit Runs(const MovieJob& job) {
    for (const auto& path : job.runs) {
      try {
        readers.emplace_back(path);
      } catch (const std::runtime_error& error) {
        throw std::invalid_argument(error.what());  // the user's file, not our failure
      }
      if (readers.back().frame_count() == 0) throw std::invalid_argument(path.string() + ": holds no finished frame yet");
    }
    std::vector<const sim::RunReader*> all;
    for (const sim::RunReader& reader : readers) all.push_back(&reader);
    const FieldRanges ranges = field_ranges(all);
    for (std::size_t i = 0; i < readers.size(); ++i) {
      PictureChoice choice = job.choice;
      if (readers.size() > 1) choice.label.clear();
      if (!job.labels.empty()) choice.label = job.labels[i];
      if (!job.path.empty()) choice.views.clear();
      for (const CameraKey& key : job.path) choice.views.push_back(key.view);
      makers.emplace_back(readers[i], choice, ranges, readers.size() == 1);
    }
    path = job.path;
    caption = job.caption;
    if (job.difference) find_extent();
  }

  // The sizes of the differences over both runs, from frames spread over the first.
  void find_extent() {
    constexpr std::size_t sample = 12;
    const std::size_t count = makers[0].times().size();
    for (std::size_t k = 0; k < std::min(sample, count); ++k) {
      const std::size_t index = count > 1 ? k * (count - 1) / std::max<std::size_t>(std::min(sample, count) - 1, 1) : 0;
      const std::vector<double> here = difference_extent(makers[0].make(index), makers[1].make(beside(1, index)));
      extent.resize(here.size(), 0);
      for (std::size_t f = 0; f < here.size(); ++f) extent[f] = std::max(extent[f], here[f]);
    }
  }

  // The frame of another run at the time of the first run's.
  std::size_t beside(std::size_t run, std::size_t index) const { return nearest_frame(makers[run].times(), makers.front().times()[index]); }

  render::Frame one(std::size_t run, std::size_t index) const {
    render::Frame frame = makers[run].make(index);
    if (!path.empty()) frame.panels = {panel_on_path(frame.panels, path, makers[run].times()[index])};
    if (!caption.empty()) frame.caption = caption + (frame.caption.empty() ? "" : "  ·  " + frame.caption);
    return frame;
  }

  // The frame of the first run, with those of the others at the same time beside it.
  render::Frame frame(std::size_t index) const {
    if (makers.size() == 1) return one(0, index);
    std::vector<render::Frame> frames;
    for (std::size_t run = 0; run < makers.size(); ++run) frames.push_back(one(run, beside(run, index)));
    std::optional<render::Frame> difference;
    if (!extent.empty()) difference = difference_frame(frames[0], frames[1], extent);
    std::vector<std::string> titles, settings;
    for (const render::Frame& frame : frames) titles.push_back(frame.title), settings.push_back(frame.subtitle);
    std::vector<std::vector<std::string>> keys;
    for (const sim::RunReader& reader : readers) keys.push_back(reader.header().settings);
    const RunNames called = run_names(titles, settings, keys);
    for (std::size_t run = 0; run < frames.size(); ++run) {
      for (render::Panel& panel : frames[run].panels) {
        panel.note = panel.title;
        panel.title = called.names[run];
      }
      frames[run].subtitle = called.shared;
      frames[run].readouts.clear();  // the numbers differ: they stand in the plots
    }
    if (difference) {
      for (render::Panel& panel : difference->panels) {
        panel.title = "Difference: " + panel.title;
        panel.note = called.names[1] + " minus " + called.names[0];
      }
      difference->title.clear();
      frames.push_back(std::move(*difference));
    }
    compare_plots(frames, called.names);
    return render::side_by_side(frames);
  }
};

}  // namespace

MovieResult make_movie(const MovieJob& job) {
  const Output kind = output_kind(job.output);
  check_job(job, kind);
  const auto began = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(); };
  const Runs runs(job);
  const std::vector<double>& times = runs.makers.front().times();
  std::vector<std::size_t> schedule;
  if (kind == Output::picture)
    schedule = {frame_of_picture(job, runs.readers.front(), times)};
  else
    schedule = movie_schedule(times, job.fps, job.slow, job.hold,
                              job.hold > 0 ? states_to_hold(runs.readers.front(), times) : std::vector<std::size_t>{});
  if (job.output.has_parent_path()) std::filesystem::create_directories(job.output.parent_path());

  render::Renderer renderer;
  render::PictureSettings settings{job.width, job.height, {}};
  settings.draw.supersampling = job.quality > 0 ? job.quality : kind == Output::picture ? 2 : 1;
  std::optional<render::VideoWriter> movie;
  if (kind == Output::movie) movie.emplace(job.output.string(), job.width, job.height, render::VideoSettings{job.fps, 18});
  MovieResult result;
  result.driver = renderer.driver();
  render::Image image;
  for (std::size_t k = 0; k < schedule.size(); ++k) {
    if (job.stop && *job.stop) {
      result.stopped = true;
      break;
    }
    if (k == 0 || schedule[k] != schedule[k - 1]) image = renderer.draw(runs.frame(schedule[k]), settings);
    if (movie)
      movie->add(image);
    else
      render::write_png(image, kind == Output::sequence ? numbered_path(job.output.string(), k) : job.output.string());
    ++result.frames;
    if (job.progress) job.progress(k + 1, schedule.size(), seconds());
  }
  if (movie && result.frames > 0) movie->finish();
  result.seconds = seconds();
  return result;
}

}  // namespace app
