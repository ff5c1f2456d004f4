#include "app/command_render.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/measure_render.h"
#include "app/movie.h"
#include "app/progress.h"

namespace app {
namespace {

struct Options {
  std::vector<std::string> runs, views, fields, ranges, labels;
  std::string output, size = "1920x1080", map, units = "kPa", path, caption;
  double fps = 25, slow = 0, hold = 0, time = 0;
  int quality = 0;
  bool open = false, closed = false, difference = false;
  int measure = 0;
  bool balls = false, walls = false, quiet = false, json = false;
  bool time_given = false, slow_given = false;
};

void read_size(const std::string& text, MovieJob& job) {
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &job.width, &job.height, &rest) != 2)
    throw std::invalid_argument("--size: '" + text + "' is no size; write WIDTHxHEIGHT, as in 1920x1080");
}

void read_range(const std::string& text, FieldRanges& ranges) {
  const auto equals = text.find('=');
  double low = 0, high = 0;
  char rest = 0;
  if (equals == std::string::npos || std::sscanf(text.c_str() + equals + 1, "%lf:%lf%c", &low, &high, &rest) != 2 || !(high > low))
    throw std::invalid_argument("--range: '" + text + "' is no range; write FIELD=LOW:HIGH in SI units, as in pressure=0:20000");
  field_index(text.substr(0, equals));
  ranges[text.substr(0, equals)] = {low, high};
}

MovieJob job_of(const Options& options) {
  MovieJob job;
  job.runs.assign(options.runs.begin(), options.runs.end());
  job.output = options.output;
  if (options.output.empty()) {
    job.output = job.runs.front();
    job.output.replace_extension(options.time_given || options.open || options.closed ? ".png" : ".mp4");
  }
  job.choice.views = options.views;
  job.choice.fields = options.fields;
  job.choice.map = options.map;
  job.choice.pressure_units = options.units;
  job.choice.balls = options.balls;
  job.choice.walls = options.walls;
  for (const std::string& range : options.ranges) read_range(range, job.choice.ranges);
  if (!options.map.empty()) render::colormap_by_name(options.map);
  read_size(options.size, job);
  job.labels = options.labels;
  job.fps = options.fps;
  if (options.slow_given) job.slow = options.slow;
  job.hold = options.hold;
  if (options.time_given) job.time = options.time;
  job.open = options.open, job.closed = options.closed, job.difference = options.difference;
  if (!options.path.empty()) job.path = read_camera_path(options.path);
  job.caption = options.caption;
  job.quality = options.quality;
  return job;
}

void print_progress(std::size_t done, std::size_t all, double seconds) {
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (!terminal && done != all && done % std::max<std::size_t>(all / 10, 1) != 0) return;
  const double left = seconds / static_cast<double>(done) * static_cast<double>(all - done);
  std::fprintf(stderr, "%spicture %zu of %zu, %s left%s", terminal ? "\r\x1b[K" : "", done, all, duration_text(left).c_str(),
               terminal && done != all ? "" : "\n");
  std::fflush(stderr);
}

int measure(const Options& options, const MovieJob& job) {
  const RenderSpeed speed = measure_render(job, options.measure);
  if (options.json) {
    std::printf("%s\n", render_speed_json(speed).dump(2).c_str());
    return 0;
  }
  std::printf("%zu pictures of %d x %d, %zu particles, %zu panels, %s\n", speed.pictures, job.width, job.height, speed.particles,
              speed.panels, speed.driver.c_str());
  std::printf("%-34s %8.1f ms\n", "reading a frame of the run", 1e3 * speed.read);
  std::printf("%-34s %8.1f ms  (%.1f a second; %.1f ms of processor time)\n", "drawing it, everything shown", 1e3 * speed.full,
              1 / speed.full, 1e3 * speed.full_processor);
  std::printf("%-34s %8.1f ms  (%.1f a second; %.1f ms of processor time)\n", "drawing it with less detail", 1e3 * speed.draft,
              1 / speed.draft, 1e3 * speed.draft_processor);
  return 0;
}

int render_runs(const Options& options) {
  MovieJob job = job_of(options);
  if (options.measure > 0) return measure(options, job);
  job.stop = &stop_on_signal();
  if (!options.quiet) job.progress = print_progress;
  const MovieResult result = make_movie(job);
  if (options.json) {
    const nlohmann::json json = {{"output", job.output.string()},
                                 {"frames", result.frames},
                                 {"width", job.width},
                                 {"height", job.height},
                                 {"fps", job.fps},
                                 {"seconds", result.seconds},
                                 {"pictures_per_second", static_cast<double>(result.frames) / std::max(result.seconds, 1e-9)},
                                 {"driver", result.driver},
                                 {"stopped", result.stopped}};
    std::printf("%s\n", json.dump(2).c_str());
  } else if (!options.quiet) {
    std::printf("%s: %zu picture%s of %d x %d in %s, drawn by %s\n", job.output.c_str(), result.frames, result.frames == 1 ? "" : "s",
                job.width, job.height, duration_text(result.seconds).c_str(), result.driver.c_str());
  }
  if (result.stopped) std::fprintf(stderr, "cusp render: stopped by a signal; %s ends where it was\n", job.output.c_str());
  return result.stopped ? 1 : 0;
}

}  // namespace

void add_render_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("render", "movies and pictures of runs, without a display");
  command->add_option("RUN", options->runs, "run files (.h5); several are shown side by side at the same time with the same scales")
      ->required();
  command->add_option("-o,--output", options->output,
                      "movie.mp4, preview.webp, preview.gif, picture.png, or frames/%04d.png (default: the run's name with .mp4)");
  command
      ->add_option(
          "--view", options->views,
          "valve: standard, pair, long_axis, short_axis, from_aorta, from_ventricle; other 3-D: oblique, front, side, top; 2-D: plane")
      ->delimiter(',');
  command
      ->add_option("--field", options->fields, "pressure, speed, stress, principal_stress or displacement; one for all views, or one each")
      ->delimiter(',');
  command->add_option("--size", options->size, "pixels, WIDTHxHEIGHT")->capture_default_str();
  command->add_option("--fps", options->fps, "movie frames a second")->capture_default_str();
  CLI::Option* slow =
      command->add_option("--slow", options->slow, "movie seconds per simulated second (default: each frame of the run once)");
  command->add_option("--hold", options->hold, "seconds to rest where the valve is widest open and where it is closed and at rest");
  CLI::Option* time = command->add_option("--time", options->time, "the simulated time of one picture, s (default: the last)");
  command->add_flag("--open", options->open, "one picture of the moment when the valve is widest open");
  command->add_flag("--closed", options->closed, "one picture of a moment when the valve is closed and at rest");
  command->add_option("--path", options->path, "one picture whose camera moves: VIEW@SECONDS,..., as in from_aorta@0,long_axis@0.4");
  command->add_flag("--difference", options->difference,
                    "of two runs, also what the second's stress (or other field) exceeds the first's by");
  command->add_option("--caption", options->caption, "words at the bottom right, before the standing ones");
  command->add_option("--measure", options->measure, "draw so many pictures, write none, say how long one takes")
      ->check(CLI::Range(1, 1000));
  command->add_option("--range", options->ranges, "FIELD=LOW:HIGH in SI units, as in pressure=0:20000 (default: the run's own range)");
  command->add_option("--map", options->map, "colour map: viridis, inferno, plasma, cividis, diverging");
  command->add_option("--units", options->units, "of the blood's pressure")
      ->check(CLI::IsMember({"kPa", "mmHg", "Pa"}))
      ->capture_default_str();
  command->add_option("--label", options->labels, "the case's label instead of the run's title; one a run");
  command
      ->add_option("--quality", options->quality, "pixels squared drawn for each (1 fast ... 4); default 1 for movies, 2 for one picture")
      ->check(CLI::Range(0, 4));
  command->add_flag("--balls", options->balls, "cut blood as particles instead of a continuous field");
  command->add_flag("--walls", options->walls, "show the wall's particles in 3-D");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "the result as JSON");
  command->footer("Example: cusp render out/demo/run.h5 -o valve.mp4 --view from_aorta,long_axis --field stress,pressure");
  command->callback([options, slow, time, &exit_code] {
    options->slow_given = slow->count() > 0;
    options->time_given = time->count() > 0;
    exit_code = render_runs(*options);
  });
}

}  // namespace app
