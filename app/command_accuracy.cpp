// cusp accuracy SCENE [--vary …] [--budget 20min] [-o DIR]: what accuracy costs in time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>

#include "app/case_grid.h"
#include "app/commands.h"
#include "app/compare.h"

namespace app {
namespace {

struct Options {
  std::string scene, output, budget;
  std::vector<std::string> vary, settings;
  int jobs = 1, threads = 0;
  bool quiet = false, json = false;
};

double read_budget(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string unit(end);
  const double factor = unit == "s" || unit.empty() ? 1 : unit == "min" ? 60 : unit == "h" ? 3600 : -1;
  if (end == text.c_str() || value <= 0 || factor < 0) throw SceneError("--budget " + text + ": is no time; give 90s, 20min or 2h");
  return value * factor;
}

struct Rung {
  GridCase grid_case;
  double spacing = 0, wall_seconds = 0, steps = 0, pressure_iterations = 0, particles = 0;
  std::vector<Comparison> errors;
};

// Without [reference]: every probe's last value beside that of the last (finest) run.
std::vector<Comparison> against_finest(const sim::RunReader& run, const sim::RunReader& finest) {
  std::vector<Comparison> result;
  for (const std::string& name : run.header().columns) {
    if (name == "time") continue;
    if (name == "maximum_speed") break;  // the probes stand before the metrics
    Comparison one;
    one.quantity = name, one.source = "finest run";
    const std::vector<double> a = run.column(name), b = finest.column(name);
    if (a.empty() || b.empty()) continue;
    one.measured = a.back(), one.reference = b.back();
    one.error = std::abs(one.measured - one.reference) / (one.reference != 0 ? std::abs(one.reference) : 1);
    result.push_back(one);
  }
  return result;
}

// Slope of log error over log spacing where the errors fall monotonously, else nothing.
std::optional<double> observed_order(const std::vector<Rung>& rungs, std::size_t quantity) {
  std::vector<std::pair<double, double>> points;
  for (const Rung& rung : rungs)
    if (quantity < rung.errors.size() && rung.errors[quantity].error > 0)
      points.emplace_back(std::log(rung.spacing), std::log(rung.errors[quantity].error));
  std::sort(points.begin(), points.end());
  if (points.size() < 2 || points.front().first == points.back().first) return std::nullopt;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0 && points[k].second < points[k - 1].second) return std::nullopt;
    x += points[k].first, y += points[k].second, xx += points[k].first * points[k].first, xy += points[k].first * points[k].second;
  }
  const double n = static_cast<double>(points.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

std::string number(double value) {
  std::ostringstream text;
  text.precision(4);
  text << value;
  return text.str();
}

nlohmann::json results_json(const std::vector<Rung>& rungs) {
  nlohmann::json json;
  for (const Rung& rung : rungs) {
    nlohmann::json one{{"settings", rung.grid_case.settings},
                       {"spacing", rung.spacing},
                       {"wall_seconds", rung.wall_seconds},
                       {"steps", rung.steps},
                       {"particle_steps", rung.steps * rung.particles},
                       {"pressure_iterations", rung.pressure_iterations}};
    for (const Comparison& c : rung.errors) one["errors"].push_back(comparison_json(c));
    json["runs"].push_back(one);
  }
  if (!rungs.empty())
    for (std::size_t q = 0; q < rungs.front().errors.size(); ++q) {
      const auto order = observed_order(rungs, q);
      json["order"][rungs.front().errors[q].quantity] = order ? nlohmann::json(*order) : nlohmann::json("no order");
    }
  return json;
}

void write_tables(const std::vector<Rung>& rungs, const nlohmann::json& json, const std::filesystem::path& folder,
                  const std::string& title) {
  std::ofstream csv(folder / "accuracy.csv"), md(folder / "accuracy.md");
  csv << "settings,spacing,wall_seconds,steps,particle_steps,pressure_iterations,quantity,time,measured,reference,error,uncertainty\n";
  md << "# What accuracy costs: " << title
     << "\n\n| settings | time, s | particle-steps | quantity | measured | reference | error |\n|---|---|---|---|---|---|---|\n";
  for (const Rung& rung : rungs) {
    std::string settings;
    for (const std::string& setting : rung.grid_case.settings) settings += (settings.empty() ? "" : " ") + setting;
    for (const Comparison& c : rung.errors) {
      csv << "\"" << settings << "\"," << rung.spacing << "," << rung.wall_seconds << "," << rung.steps << ","
          << rung.steps * rung.particles << "," << rung.pressure_iterations << "," << c.quantity << "," << c.time << "," << c.measured
          << "," << c.reference << "," << c.error << "," << c.uncertainty << "\n";
      md << "| " << settings << " | " << number(rung.wall_seconds) << " | " << number(rung.steps * rung.particles) << " | " << c.quantity
         << " | " << number(c.measured) << " | " << number(c.reference) << " | " << number(100 * c.error) << " % |\n";
    }
  }
  md << "\nObserved order of the error in the spacing:";
  if (json.contains("order"))
    for (const auto& [quantity, order] : json["order"].items())
      md << " " << quantity << " " << (order.is_string() ? order.get<std::string>() : number(order.get<double>())) << ";";
  md << "\n";
  std::ofstream(folder / "accuracy.json") << json.dump(2) << "\n";
}

int measure(const Options& options) {
  const SceneFile scene = read_scene_file(options.scene, options.settings);
  if (scene.probes.empty())
    throw SceneError(options.scene + ": has no [[probe]], so there is nothing to compare; add one, and a [reference]");
  std::vector<Variation> variations;
  for (const std::string& text : options.vary) variations.push_back(parse_variation(text));
  if (variations.empty())
    variations.push_back({"spacing", {number(2 * scene.spacing), number(std::sqrt(2.0) * scene.spacing), number(scene.spacing)}});
  const std::filesystem::path path(options.scene);
  const std::filesystem::path folder =
      options.output.empty() ? path.parent_path() / ("accuracy-" + path.stem().string()) : std::filesystem::path(options.output);
  std::filesystem::create_directories(folder);
  const std::vector<GridCase> cases = grid_cases(variations, folder / "runs");
  GridOptions grid{
      path, options.settings, options.jobs, options.threads, options.quiet, options.budget.empty() ? 0 : read_budget(options.budget)};
  const std::vector<int> codes = run_grid(cases, grid);
  std::vector<Rung> rungs;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (codes[k] != 0) continue;
    const sim::RunReader run(cases[k].run());
    Rung rung{cases[k], run.header().spacing, run.wall_seconds(), static_cast<double>(run.steps()), 0, 0, {}};
    const std::vector<double> particles = run.column("particles"), iterations = run.column("pressure_iterations");
    if (!particles.empty()) rung.particles = particles.back();
    if (!iterations.empty()) rung.pressure_iterations = iterations.back();
    if (!scene.references.empty()) rung.errors = compare_with_references(scene, run);
    rungs.push_back(std::move(rung));
  }
  if (rungs.empty()) throw std::runtime_error("no run finished; see log.txt in " + (folder / "runs").string());
  if (scene.references.empty()) {
    const auto finest = std::min_element(rungs.begin(), rungs.end(), [](const Rung& a, const Rung& b) { return a.spacing < b.spacing; });
    const sim::RunReader best(finest->grid_case.run());
    const std::filesystem::path best_path = finest->grid_case.folder;
    for (Rung& rung : rungs)
      if (rung.grid_case.folder != best_path) rung.errors = against_finest(sim::RunReader(rung.grid_case.run()), best);
  }
  const nlohmann::json json = results_json(rungs);
  write_tables(rungs, json, folder, scene.title);
  if (options.json)
    std::printf("%s\n", json.dump(2).c_str());
  else
    std::printf("%s: %zu runs\n", (folder / "accuracy.md").string().c_str(), rungs.size());
  return std::all_of(codes.begin(), codes.end(), [](int code) { return code == 0; }) || !options.budget.empty() ? 0 : 1;
}

}  // namespace

void add_accuracy_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("accuracy", "what accuracy costs in time: a ladder of runs against [reference] or the finest");
  command->footer("Example: cusp accuracy scene.toml --vary spacing=0.02,0.014,0.01 --budget 20min");
  command->add_option("SCENE", options->scene, "scene file (.toml) with probes")->required();
  command->add_option("--vary", options->vary, "KEY=V1,V2,... (default: spacing at 2, 1.41 and 1 times the scene's)")
      ->allow_extra_args(false);
  command->add_option("--set", options->settings, "KEY=VALUE for all runs; may be repeated")->allow_extra_args(false);
  command->add_option("--budget", options->budget, "no run is started after this time: 90s, 20min, 2h");
  command->add_option("-o,--output", options->output, "folder (default: accuracy-SCENE beside the scene)");
  command->add_option("--jobs", options->jobs, "runs at a time")->check(CLI::Range(1, 4096));
  command->add_option("--threads", options->threads, "threads of each run")->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, &exit_code] { exit_code = measure(*options); });
}

}  // namespace app
