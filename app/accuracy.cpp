#include "app/accuracy.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>

#include "app/accuracy_errors.h"
#include "app/accuracy_plan.h"
#include "app/explain.h"
#include "app/progress.h"
#include "app/run_budget.h"
#include "sim/run_file.h"

namespace app {
namespace {

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// A run of an older state of the scene, or of other settings, is no result of this one.
void discard_stale(const GridCase& one, const SceneFile& scene, const std::vector<std::string>& common) {
  std::error_code error;
  if (!std::filesystem::exists(one.run(), error)) return;
  std::vector<std::string> settings = common;
  settings.insert(settings.end(), one.settings.begin(), one.settings.end());
  bool same = false;
  try {
    const sim::RunReader run(one.run());
    same = run.header().scene_text == scene.text && run.header().settings == settings;
  } catch (const std::exception&) {  // no run file: begin again
  }
  if (!same) std::filesystem::remove_all(one.folder, error);
}

std::string last_log_line(const GridCase& one) {
  std::ifstream log(one.folder / "log.txt");
  std::string last;
  for (std::string line; std::getline(log, line);)
    if (!line.empty()) last = line;
  return last;
}

// What is run, and how it ended.
struct Campaign {
  const AccuracyOptions& options;
  SceneFile scene;
  double started = now_seconds();
  std::vector<PlannedRun> runs{};
  std::vector<GridCase> cases{};
  std::vector<int> codes{};
  std::vector<std::string> left_out{};

  double left() const { return options.budget > 0 ? options.budget - (now_seconds() - started) : 1e300; }

  void run(const std::vector<PlannedRun>& batch) {
    GridOptions grid{options.scene,   options.settings, options.jobs,
                     options.threads, options.quiet,    options.budget > 0 ? std::max(1e-3, left()) : 0};
    std::vector<GridCase> wanted;
    for (const PlannedRun& one : batch) {
      std::vector<std::string> all = options.settings;
      all.insert(all.end(), one.settings.begin(), one.settings.end());
      const GridCase grid_case = grid_case_of(one, options.folder / "runs");
      try {
        read_scene_file(options.scene, all);
      } catch (const SceneError& error) {
        left_out.push_back(grid_case.folder.filename().string() + ": " + error.what());
        continue;
      }
      discard_stale(grid_case, scene, options.settings);
      wanted.push_back(grid_case), runs.push_back(one);
    }
    const std::vector<int> ended = run_grid(wanted, grid);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (ended[k] == -1) left_out.push_back(wanted[k].folder.filename().string() + ": not started, the time was up");
      if (ended[k] > 0) left_out.push_back(wanted[k].folder.filename().string() + ": failed: " + last_log_line(wanted[k]));
    }
    cases.insert(cases.end(), wanted.begin(), wanted.end()), codes.insert(codes.end(), ended.begin(), ended.end());
  }

  // Seconds that the ladder's first runs took, by spacing.
  std::pair<std::vector<double>, std::vector<double>> ladder_cost() const {
    std::pair<std::vector<double>, std::vector<double>> law;
    for (std::size_t k = 0; k < runs.size(); ++k)
      if (codes[k] == 0 && runs[k].curve == "spacing" && runs[k].repeat == 0)
        law.first.push_back(runs[k].spacing), law.second.push_back(std::max(1e-3, read_case_cost(cases[k]).elapsed));
    return law;
  }

  // Seconds that a run at `spacing` will take: the fitted law of the ladder so far; from one rung alone particles times steps.
  double expected(double spacing) const {
    const auto [at, cost] = ladder_cost();
    if (at.empty()) return 0;
    if (const auto fit = power_fit(at, cost); fit && fit->exponent < -1) return cost.back() * std::pow(spacing / at.back(), fit->exponent);
    return cost.back() * std::pow(at.back() / spacing, scene.dimension + 1);
  }

  // The rungs one after the other, coarse to fine, each only if it and half as much again for all the rest fits into what is left.
  void climb(const std::vector<double>& spacings) {
    for (double spacing : spacings) {
      const double cost = expected(spacing);
      if (!runs.empty() && 1.5 * cost > left()) {
        left_out.push_back(spacing_setting(spacing) + ": not started, it would take about " + duration_text(cost));
        continue;
      }
      run(ladder_runs(scene, {spacing}, 1));
      if (stop_on_signal().load()) return;
    }
  }

  // What of the batch fits into the time left, in its order.
  void run_what_fits(const std::vector<PlannedRun>& batch) {
    std::vector<PlannedRun> fits;
    double sum = 0;
    for (const PlannedRun& one : batch) {
      const double cost = expected(one.spacing) * one.cost_factor;
      if (sum + cost > options.jobs * left()) {
        left_out.push_back(grid_case_of(one, "").folder.filename().string() + ": not started, it would take about " + duration_text(cost));
        continue;
      }
      sum += cost, fits.push_back(one);
    }
    run(fits);
  }
};

// --vary spacing=… alone is the ladder; anything else a grid of its own.
std::vector<double> given_ladder(const std::vector<Variation>& variations) {
  std::vector<double> spacings;
  if (variations.size() == 1 && variations[0].key == "spacing")
    for (const std::string& value : variations[0].values) spacings.push_back(std::strtod(value.c_str(), nullptr));
  std::sort(spacings.rbegin(), spacings.rend());
  return spacings;
}

std::vector<PlannedRun> given_grid(const std::vector<Variation>& variations, const SceneFile& scene) {
  std::vector<PlannedRun> runs;
  for (const GridCase& one : grid_cases(variations, "")) {
    PlannedRun run;
    run.spacing = scene.spacing, run.settings = one.settings;
    bool spaced = false;
    std::string others, values;
    for (const std::string& setting : one.settings) {
      if (setting.rfind("spacing=", 0) == 0) {
        run.spacing = std::strtod(setting.c_str() + 8, nullptr), spaced = true;
        continue;
      }
      const std::size_t equals = setting.find('=');
      others += (others.empty() ? "" : ", ") + setting.substr(0, equals),
          values += (values.empty() ? "" : ", ") + setting.substr(equals + 1);
    }
    // With spacings in the grid each setting of the rest is a curve over them; without, the rest itself is the curve.
    run.curve = others.empty() ? "spacing" : spaced ? others + " = " + values : others;
    run.value = spaced || others.empty() ? std::to_string(run.spacing) : values;
    runs.push_back(std::move(run));
  }
  return runs;
}

double last_of(const sim::RunReader& run, const char* column) {
  const std::vector<double> values = run.column(column);
  return values.empty() ? 0 : values.back();
}

// Points from the finished runs; repeats of one setting are one point.
std::vector<std::size_t> gather(const Campaign& campaign, AccuracyStudy& study) {
  std::vector<std::size_t> first_run;  // of each point
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < campaign.runs.size(); ++k) {
    if (campaign.codes[k] != 0) continue;
    const PlannedRun& planned = campaign.runs[k];
    std::string key = std::to_string(planned.threads);
    for (const std::string& setting : planned.settings) key += "|" + setting;
    const CaseCost cost = read_case_cost(campaign.cases[k]);
    const sim::RunReader run(campaign.cases[k].run());
    const auto found = known.find(key);
    const std::size_t index = found == known.end() ? study.points.size() : found->second;
    if (found == known.end()) {
      known[key] = index, first_run.push_back(k);
      AccuracyPoint point;
      point.curve = planned.curve, point.value = planned.value, point.settings = planned.settings;
      point.threads = planned.threads > 0 ? planned.threads : study.threads;
      point.spacing = run.header().spacing, point.scene_itself = planned.scene_itself;
      point.steps = static_cast<double>(run.steps()), point.particles = last_of(run, "particles");
      point.pressure_products = last_of(run, "pressure_iterations"), point.elastic_substeps = last_of(run, "elastic_substeps");
      study.points.push_back(std::move(point));
    }
    AccuracyPoint& point = study.points[index];
    point.wall.push_back(run.wall_seconds());
    if (cost.processor > 0) point.processor.push_back(cost.processor);
    point.peak_memory = std::max(point.peak_memory, cost.peak_memory);
  }
  return first_run;
}

// Relative spread of the answers over jittered starts, a quantity at a time.
std::vector<double> spread_of(const std::vector<std::vector<Comparison>>& answers, std::size_t quantities) {
  std::vector<double> spread(quantities, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t q = 0; q < quantities && answers.size() > 1; ++q) spread[q] = relative_spread(answers, q);
  return spread;
}

}  // namespace

AccuracyStudy measure_accuracy(const AccuracyOptions& options) {
  Campaign campaign{options, read_scene_file(options.scene, options.settings)};
  const SceneFile& scene = campaign.scene;
  if (scene.probes.empty() && !scene.patient && !scene.valve)
    throw SceneError(options.scene.string() + ": has no [[probe]], so there is nothing to compare; add one, and a [reference]");
  const bool no_knobs = options.knobs.size() == 1 && options.knobs[0] == "none";
  if (!no_knobs) knob_runs(scene, scene.spacing, options.knobs);  // refuses a misspelt one before anything runs
  std::filesystem::create_directories(options.folder);
  std::vector<Variation> variations;
  for (const std::string& text : options.vary) variations.push_back(parse_variation(text));
  AccuracyStudy study;
  study.title = scene.title, study.scene = options.scene.filename().string(), study.signature = scene_signature(scene);
  study.dimension = scene.dimension, study.threads = options.threads, study.end = scene.time.end, study.clock = options.clock;
  study.patient = scene.patient.has_value(), study.statics = scene.time.mode == sim::TimeMode::static_equilibrium;
  std::vector<double> ladder = given_ladder(variations);
  if (!variations.empty() && ladder.empty()) {
    campaign.run(given_grid(variations, scene));
  } else {
    if (ladder.empty()) {
      const LadderPlan plan = spacing_ladder(scene, options.settings, options.budget > 0 ? 6 : 3);
      ladder = plan.spacings, campaign.left_out = plan.left_out;
    }
    if (ladder.empty()) throw SceneError(options.scene.string() + ": no spacing of the ladder can be run; give --vary spacing=…");
    study.calibration = calibrate(options.scene, options.settings, ladder.front(), options.threads);
    campaign.climb(ladder);
    const auto climbed = campaign.ladder_cost().first;
    if (!climbed.empty()) {
      const double middle = climbed[climbed.size() / 2];
      campaign.run_what_fits(jitter_runs(scene, middle, options.seeds));
      if (!no_knobs) campaign.run_what_fits(knob_runs(scene, middle, options.knobs));
      std::vector<PlannedRun> repeats;
      for (const PlannedRun& one : ladder_runs(scene, climbed, options.repeats))
        if (one.repeat > 0) repeats.push_back(one);
      campaign.run_what_fits(repeats);
    }
  }
  const std::vector<std::size_t> first_run = gather(campaign, study);
  study.left_out = campaign.left_out;
  if (study.points.empty()) throw std::runtime_error("no run finished; see log.txt in " + (options.folder / "runs").string());
  std::vector<std::filesystem::path> files;
  for (std::size_t k : first_run) files.push_back(campaign.cases[k].run());
  const std::vector<std::vector<Comparison>> answers = compare_all(scene, files, study);
  std::vector<std::vector<Comparison>> jittered;
  for (std::size_t k = 0; k < study.points.size(); ++k)
    if (study.points[k].curve == "seed") jittered.push_back(answers[k]);
  study.noise = spread_of(jittered, study.quantities.size());
  return study;
}

}  // namespace app
