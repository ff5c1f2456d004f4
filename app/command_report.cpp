// cusp report RUN.h5... [-o report.html]
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/report.h"
#include "app/scene_error.h"

namespace app {
namespace {

struct Options {
  std::vector<std::string> runs, movies, labels;
  std::string output = "report.html";
  bool no_movie = false, no_pictures = false, quiet = false, json = false;
};

int report(const Options& options) {
  ReportOptions chosen;
  chosen.runs.assign(options.runs.begin(), options.runs.end());
  chosen.movies.assign(options.movies.begin(), options.movies.end());
  chosen.labels = options.labels, chosen.output = options.output;
  chosen.with_movie = !options.no_movie, chosen.with_pictures = !options.no_pictures;
  if (chosen.movies.size() > chosen.runs.size()) throw SceneError("--movie: more movies than runs; give one a run, in their order");
  const std::uintmax_t bytes = write_report(chosen);
  if (options.json)
    std::printf("{\"report\": \"%s\", \"bytes\": %ju}\n", options.output.c_str(), bytes);
  else if (!options.quiet)
    std::printf("%s: %.1f MB\n", options.output.c_str(), 1e-6 * static_cast<double>(bytes));
  return 0;
}

}  // namespace

void add_report_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("report", "one self-contained page: movie, clinical figures, curves, model, settings, warnings");
  command->footer("Example: cusp report run.h5 -o report.html; two runs make a comparison: cusp report before.h5 after.h5");
  command->add_option("RUN", options->runs, "run files (.h5)")->required();
  command->add_option("-o,--output", options->output, "page (default: report.html)");
  command->add_option("--movie", options->movies, "movie to take in, one a run (default: movie.mp4 or RUN.mp4 beside it)");
  command->add_option("--label", options->labels, "name a run in the page, one a run (default: its title)");
  command->add_flag("--no-movie", options->no_movie, "leave the movie out");
  command->add_flag("--no-pictures", options->no_pictures, "draw no stills");
  command->add_flag("--quiet", options->quiet, "no words");
  command->add_flag("--json", options->json, "print the result as one JSON object");
  command->callback([options, &exit_code] { exit_code = report(*options); });
}

}  // namespace app
