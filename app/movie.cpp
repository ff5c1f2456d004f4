#include "app/movie.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>
#include <stdexcept>

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

namespace {

enum class Output { movie, sequence, picture };

Output output_kind(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".mp4") return Output::movie;
  if (ending == ".png") return path.string().find('%') != std::string::npos ? Output::sequence : Output::picture;
  throw std::invalid_argument("-o '" + path.string() +
                              "': use a name that ends in .mp4 (a movie), .png (one picture) or %04d.png (a sequence)");
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
  if (job.time && kind != Output::picture) throw std::invalid_argument("--time: is for one picture; name it with -o PICTURE.png");
}

// Where a valve is widest open, and the first moment after it when its opening is at its smallest.
std::vector<std::size_t> states_to_hold(const sim::RunReader& run, const std::vector<double>& times) {
  const std::vector<double> area = run.column("orifice_area"), when = run.column("time");
  if (area.empty() || area.size() != when.size()) return {};
  const auto open = std::max_element(area.begin(), area.end());
  const auto closed = std::min_element(open, area.end());
  return {nearest_frame(times, when[static_cast<std::size_t>(open - area.begin())]),
          nearest_frame(times, when[static_cast<std::size_t>(closed - area.begin())])};
}

// The first frame's plots, with the curves of the others in those where each run has a single one.
void compare_plots(std::vector<render::Frame>& frames) {
  static const std::vector<render::Color> colors = {
      {0.10f, 0.32f, 0.66f}, {0.85f, 0.45f, 0.05f}, {0.10f, 0.50f, 0.40f}, {0.55f, 0.20f, 0.55f}};
  for (std::size_t p = 0; p < frames.front().plots.size(); ++p) {
    render::Plot& plot = frames.front().plots[p];
    if (plot.curves.size() != 1) continue;
    plot.curves[0].label = frames.front().title;
    plot.curves[0].color = colors[0];
    for (std::size_t i = 1; i < frames.size(); ++i) {
      if (p >= frames[i].plots.size() || frames[i].plots[p].label != plot.label || frames[i].plots[p].curves.size() != 1) continue;
      render::Curve curve = frames[i].plots[p].curves[0];
      curve.label = frames[i].title;
      curve.color = colors[i % colors.size()];
      plot.curves.push_back(curve);
    }
  }
}

// All runs of a job, opened, with common ranges.
struct Runs {
  std::vector<sim::RunReader> readers;
  std::vector<FrameMaker> makers;

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
      makers.emplace_back(readers[i], choice, ranges, readers.size() == 1);
    }
  }

  // The frame of the first run, with those of the others at the same time beside it.
  render::Frame frame(std::size_t index) const {
    if (makers.size() == 1) return makers.front().make(index);
    std::vector<render::Frame> frames;
    for (const FrameMaker& maker : makers) {
      frames.push_back(maker.make(nearest_frame(maker.times(), makers.front().times()[index])));
      render::Frame& frame = frames.back();
      for (render::Panel& panel : frame.panels) {
        panel.title = frame.title + (panel.title.empty() ? "" : ": " + panel.title);
        panel.note = frame.subtitle;
      }
      frame.subtitle.clear();  // it stands in the panels, and so do the numbers that differ: in the plots
      frame.readouts.clear();
    }
    compare_plots(frames);
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
    schedule = {job.time ? nearest_frame(times, *job.time) : times.size() - 1};
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
