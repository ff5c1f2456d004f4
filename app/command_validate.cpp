// cusp validate [CASE…] [--full] [--list] [--json]: the built-in cases of assets/scenes/validation/cases.toml.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>

#include "app/assets.h"
#include "app/commands.h"
#include "app/compare.h"
#include "app/progress.h"
#include "app/run_case.h"
#include "app/scene_table.h"

namespace app {
namespace {

struct Options {
  std::vector<std::string> cases;
  std::string output;
  int threads = 0;
  bool full = false, list = false, quiet = false, json = false;
};

struct ValidationCase {
  std::string name, title;
  std::filesystem::path scene;
  int priority = 3;
  std::vector<std::string> fast, full;  // settings
};

std::vector<ValidationCase> read_cases() {
  const std::filesystem::path file = asset("scenes/validation/cases.toml");
  const toml::table table = toml::parse_file(file.string());
  const TableReader top(table, "", {"case"});
  std::vector<ValidationCase> cases;
  for (const toml::table* entry : top.tables("case")) {
    const TableReader reader(*entry, "case", {"name", "title", "scene", "priority", "fast", "full"});
    ValidationCase one;
    one.name = reader.text("name"), one.title = reader.text("title", one.name), one.scene = file.parent_path() / reader.text("scene");
    one.priority = static_cast<int>(reader.integer("priority", any_number, 3));
    if (reader.has("fast")) one.fast = reader.texts("fast");
    if (reader.has("full")) one.full = reader.texts("full");
    cases.push_back(std::move(one));
  }
  return cases;
}

// status: pass, degraded (passed, but steps were refused on the way), refused (bad input), fail.
nlohmann::json run_one(const ValidationCase& one, const Options& options, const std::filesystem::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  nlohmann::json json{{"name", one.name}, {"title", one.title}, {"priority", one.priority}};
  try {
    const SceneFile scene = read_scene_file(one.scene, options.full ? one.full : one.fast);
    RunCaseOptions run;
    run.output = folder / (one.name + ".h5"), run.quiet = true, run.threads = options.threads;
    const sim::RunResult result = run_case(scene, run);
    bool passed = result.ending == sim::RunEnding::finished;
    if (!passed) json["message"] = result.message;
    const sim::RunReader reader(run.output);
    for (const Comparison& c : compare_with_references(scene, reader)) {
      json["checks"].push_back(comparison_json(c));
      passed = passed && c.passed();
    }
    const std::vector<double> refused = reader.column("refused_steps");
    json["status"] = !passed ? "fail" : !refused.empty() && refused.back() > 0 ? "degraded" : "pass";
    json["steps"] = result.steps;
  } catch (const SceneError& error) {
    json["status"] = "refused", json["message"] = error.what();
  } catch (const std::exception& error) {
    json["status"] = "fail", json["message"] = error.what();
  }
  json["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return json;
}

void print_one(const nlohmann::json& one) {
  std::printf("%-9s %-28s %s\n", one["status"].get<std::string>().c_str(), one["name"].get<std::string>().c_str(),
              duration_text(one["seconds"].get<double>()).c_str());
  for (const auto& c : one.value("checks", nlohmann::json::array()))
    std::printf("          %-28s measured %.6g, reference %.6g (%s), error %.3g %%%s\n", c["quantity"].get<std::string>().c_str(),
                c["measured"].get<double>(), c["reference"].get<double>(), c["source"].get<std::string>().c_str(),
                100 * c["error"].get<double>(),
                c.contains("limit") ? (", limit " + std::to_string(100 * c["limit"].get<double>()).substr(0, 5) + " %").c_str() : "");
  if (one.contains("message")) std::printf("          %s\n", one["message"].get<std::string>().c_str());
  std::fflush(stdout);
}

void write_table(const nlohmann::json& all, const std::filesystem::path& folder) {
  std::ofstream(folder / "validation.json") << all.dump(2) << "\n";
  std::ofstream md(folder / "validation.md"), csv(folder / "validation.csv");
  md << "| case | status | quantity | measured | reference | source | error | limit | time |\n|---|---|---|---|---|---|---|---|---|\n";
  csv << "case,status,quantity,measured,reference,uncertainty,error,limit,seconds,source\n";
  for (const auto& one : all["cases"])
    for (const auto& c : one.value("checks", nlohmann::json::array({nlohmann::json::object()}))) {
      char line[512];
      std::snprintf(line, sizeof line, "| %s | %s | %s | %.6g | %.6g | %s | %.3g %% | %s | %.3g s |\n",
                    one["title"].get<std::string>().c_str(), one["status"].get<std::string>().c_str(), c.value("quantity", "").c_str(),
                    c.value("measured", 0.0), c.value("reference", 0.0), c.value("source", "").c_str(), 100 * c.value("error", 0.0),
                    c.contains("limit") ? (std::to_string(100 * c["limit"].get<double>()).substr(0, 5) + " %").c_str() : "",
                    one["seconds"].get<double>());
      md << line;
      csv << one["name"].get<std::string>() << "," << one["status"].get<std::string>() << "," << c.value("quantity", "") << ","
          << c.value("measured", 0.0) << "," << c.value("reference", 0.0) << "," << c.value("uncertainty", 0.0) << ","
          << c.value("error", 0.0) << "," << c.value("limit", 0.0) << "," << one["seconds"].get<double>() << ",\"" << c.value("source", "")
          << "\"\n";
    }
}

int validate(const Options& options) {
  std::vector<ValidationCase> cases = read_cases();
  std::vector<std::string> names;
  for (const ValidationCase& one : cases) names.push_back(one.name);
  for (const std::string& name : options.cases)
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      const std::string near = nearest_word(name, names);
      throw SceneError("cusp validate: no case \"" + name + "\"; " +
                       (near.empty() ? "--list shows them" : "did you mean \"" + near + "\"?"));
    }
  if (!options.cases.empty())
    cases.erase(std::remove_if(cases.begin(), cases.end(),
                               [&](const ValidationCase& one) {
                                 return std::find(options.cases.begin(), options.cases.end(), one.name) == options.cases.end();
                               }),
                cases.end());
  nlohmann::json all{{"cases", nlohmann::json::array()}, {"settings", options.full ? "full" : "fast"}};
  if (options.list) {
    for (const ValidationCase& one : cases) {
      all["cases"].push_back({{"name", one.name}, {"title", one.title}, {"priority", one.priority}});
      if (!options.json) std::printf("%d  %-28s %s\n", one.priority, one.name.c_str(), one.title.c_str());
    }
    if (options.json) std::printf("%s\n", all.dump(2).c_str());
    return 0;
  }
  const std::filesystem::path folder = options.output.empty() ? "validation" : options.output;
  std::filesystem::create_directories(folder);
  bool failed = false;
  for (const ValidationCase& one : cases) {
    all["cases"].push_back(run_one(one, options, folder));
    const std::string status = all["cases"].back()["status"];
    failed = failed || status == "fail" || status == "refused";
    if (!options.json) print_one(all["cases"].back());
  }
  write_table(all, folder);
  if (options.json) std::printf("%s\n", all.dump(2).c_str());
  return failed ? 1 : 0;
}

}  // namespace

void add_validate_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("validate", "run the built-in cases and compare each with its reference");
  command->footer("Example: cusp validate hydrostatic_2d --json");
  command->add_option("CASE", options->cases, "names of cases (default: all)");
  command->add_flag("--full", options->full, "full settings instead of fast ones");
  command->add_flag("--list", options->list, "only list the cases");
  command->add_option("-o,--output", options->output, "folder for runs and tables (default: validation)");
  command->add_option("--threads", options->threads, "processor threads")->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, &exit_code] { exit_code = validate(*options); });
}

}  // namespace app
