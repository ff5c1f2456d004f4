#include "app/validation.h"

#include <chrono>
#include <cmath>

#include "app/assets.h"
#include "app/compare.h"
#include "app/run_case.h"
#include "app/scene_table.h"

namespace app {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct CaseRun {
  std::vector<Comparison> comparisons;
  sim::RunResult result;
  bool refused_steps = false;
};

CaseRun run_with(const ValidationCase& one, const std::vector<std::string>& settings, int threads, const std::filesystem::path& output) {
  const SceneFile scene = read_scene_file(one.scene, settings);
  RunCaseOptions run;
  run.output = output, run.quiet = true, run.threads = threads;
  CaseRun done;
  done.result = run_case(scene, run);
  const sim::RunReader reader(run.output);
  const std::vector<double> refused = reader.column("refused_steps");
  done.refused_steps = !refused.empty() && refused.back() > 0;
  if (done.result.ending == sim::RunEnding::finished) done.comparisons = compare_with_references(scene, reader);
  return done;
}

std::vector<PlotPanel> panels_of(const std::vector<Comparison>& comparisons) {
  std::vector<PlotPanel> panels;
  PlotPanel errors{"relative error (mark: limit)", "", "", {}, {}};
  for (const Comparison& c : comparisons) {
    errors.bars.push_back({c.quantity, c.error, c.limit.value_or(0)});
    if (c.at.size() < 2) continue;
    PlotPanel panel{c.quantity, "coordinate (m) or time (s)", "", {}, {}};
    panel.curves.push_back({"measured", c.at, c.measured_curve, false});
    panel.curves.push_back({"reference", c.at, c.reference_curve, true});
    panels.push_back(std::move(panel));
  }
  if (!errors.bars.empty()) panels.push_back(std::move(errors));
  return panels;
}

// Runs the ladder of spacings; per quantity the errors and their order.
nlohmann::json run_ladder(const ValidationCase& one, int threads, const std::filesystem::path& folder, std::vector<PlotPanel>& panels) {
  std::vector<double> spacing;
  std::vector<std::vector<double>> error;  // per quantity
  std::vector<std::string> quantity;
  for (const std::string& pitch : one.ladder) {
    std::vector<std::string> settings = one.fast;
    settings.push_back("spacing=" + pitch);
    const CaseRun run = run_with(one, settings, threads, folder / (one.name + "_ladder.h5"));
    if (run.comparisons.empty()) return {{"message", "the run with spacing " + pitch + " failed: " + run.result.message}};
    spacing.push_back(std::stod(pitch));
    error.resize(run.comparisons.size());
    quantity.resize(run.comparisons.size());
    for (std::size_t q = 0; q < run.comparisons.size(); ++q)
      error[q].push_back(run.comparisons[q].error), quantity[q] = run.comparisons[q].quantity;
  }
  nlohmann::json rows = nlohmann::json::array();
  PlotPanel panel{"convergence", "log10 spacing (m)", "log10 error", {}, {}};
  for (std::size_t q = 0; q < quantity.size(); ++q) {
    nlohmann::json row{{"quantity", quantity[q]}, {"spacings", spacing}, {"errors", error[q]}};
    if (const auto order = convergence_order(spacing, error[q])) row["order"] = *order;
    rows.push_back(row);
    PlotCurve curve{quantity[q], {}, {}, false};
    for (std::size_t k = 0; k < spacing.size(); ++k)
      if (error[q][k] > 0) curve.x.push_back(std::log10(spacing[k])), curve.y.push_back(std::log10(error[q][k]));
    panel.curves.push_back(std::move(curve));
  }
  panels.push_back(std::move(panel));
  return {{"rows", rows}};
}

}  // namespace

std::vector<ValidationCase> read_validation_cases() {
  const std::filesystem::path file = asset("scenes/validation/cases.toml");
  const toml::table table = toml::parse_file(file.string());
  const TableReader top(table, "", {"case"});
  std::vector<ValidationCase> cases;
  for (const toml::table* entry : top.tables("case")) {
    const TableReader reader(*entry, "case", {"name", "title", "scene", "priority", "fast", "full", "ladder"});
    ValidationCase one;
    one.name = reader.text("name"), one.title = reader.text("title", one.name), one.scene = file.parent_path() / reader.text("scene");
    one.priority = static_cast<int>(reader.integer("priority", any_number, 3));
    if (reader.has("fast")) one.fast = reader.texts("fast");
    if (reader.has("full")) one.full = reader.texts("full");
    if (reader.has("ladder")) one.ladder = reader.texts("ladder");
    cases.push_back(std::move(one));
  }
  return cases;
}

ValidationResult run_validation_case(const ValidationCase& one, bool full, int threads, const std::filesystem::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  ValidationResult result;
  nlohmann::json& json = result.json;
  json = {{"name", one.name}, {"title", one.title}, {"priority", one.priority}};
  try {
    const CaseRun run = run_with(one, full ? one.full : one.fast, threads, folder / (one.name + ".h5"));
    bool passed = run.result.ending == sim::RunEnding::finished;
    if (!passed) json["message"] = run.result.message;
    for (const Comparison& c : run.comparisons) {
      json["checks"].push_back(comparison_json(c));
      passed = passed && c.passed();
    }
    json["status"] = !passed ? "fail" : run.refused_steps ? "degraded" : "pass";
    json["steps"] = run.result.steps;
    result.panels = panels_of(run.comparisons);
    json["seconds"] = seconds_since(start);
    if (full && !one.ladder.empty()) json["order"] = run_ladder(one, threads, folder, result.panels);
  } catch (const SceneError& error) {
    json["status"] = "refused", json["message"] = error.what();
  } catch (const std::exception& error) {
    json["status"] = "fail", json["message"] = error.what();
  }
  if (!json.contains("seconds")) json["seconds"] = seconds_since(start);
  return result;
}

std::optional<double> convergence_order(const std::vector<double>& spacing, const std::vector<double>& error) {
  const auto n = static_cast<double>(spacing.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t k = 0; k < spacing.size(); ++k) {
    if (!(error[k] > 0) || (k > 0 && !(error[k] < error[k - 1]))) return {};
    const double a = std::log(spacing[k]), b = std::log(error[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  const double spread = n * xx - x * x;
  if (spacing.size() < 2 || !(spread > 0)) return {};
  return (n * xy - x * y) / spread;
}

}  // namespace app
