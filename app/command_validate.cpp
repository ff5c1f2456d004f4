// cusp validate [CASE…] [--full] [--list] [--docs DIR] [--json]: the built-in cases (validation.h).
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>

#include "app/command_stability.h"
#include "app/commands.h"
#include "app/progress.h"
#include "app/random_scenes.h"
#include "app/scene_table.h"
#include "app/validation.h"

namespace app {
namespace {

struct Options {
  std::vector<std::string> cases;
  std::string output, docs;
  int threads = 0, random = 0;
  std::uint64_t seed = 1;
  bool full = false, list = false, quiet = false, json = false, stability = false, fast = false;
};

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

void copy_to_docs(const std::vector<ValidationCase>& cases, const std::filesystem::path& folder, const std::filesystem::path& docs) {
  const auto replace = std::filesystem::copy_options::overwrite_existing;
  std::filesystem::create_directories(docs / "validation");
  std::filesystem::copy_file(folder / "validation.md", docs / "validation.md", replace);
  for (const ValidationCase& one : cases)
    std::filesystem::copy_file(folder / "validation" / (one.name + ".svg"), docs / "validation" / (one.name + ".svg"), replace);
}

// Random scenes, seed by seed: each runs or is refused in one line.
int validate_random(const Options& options) {
  nlohmann::json all{{"scenes", nlohmann::json::array()}};
  std::map<std::string, int> counts;
  if (options.threads > 0) omp_set_num_threads(options.threads);
  for (int k = 0; k < options.random; ++k) {
    all["scenes"].push_back(run_random_scene(options.seed + static_cast<std::uint64_t>(k)));
    const nlohmann::json& one = all["scenes"].back();
    const std::string outcome = one["outcome"];
    ++counts[outcome];
    if (!options.json && outcome != "ran")
      std::printf("seed %-6llu %-8s %s\n", static_cast<unsigned long long>(options.seed + static_cast<std::uint64_t>(k)), outcome.c_str(),
                  one.value("message", "").c_str());
    std::fflush(stdout);
  }
  all["counts"] = counts;
  if (options.json)
    std::printf("%s\n", all.dump(2).c_str());
  else
    for (const auto& [outcome, count] : counts) std::printf("%5d %s\n", count, outcome.c_str());
  return counts["broken"] + counts["slow"] > 0 ? 1 : 0;
}

int validate(const Options& options) {
  std::vector<ValidationCase> cases = read_validation_cases();
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
  std::filesystem::create_directories(folder / "validation");
  bool failed = false;
  for (const ValidationCase& one : cases) {
    const ValidationResult result = run_validation_case(one, options.full, options.threads, folder);
    std::ofstream(folder / "validation" / (one.name + ".svg")) << svg_plot(one.title, result.panels);
    all["cases"].push_back(result.json);
    const std::string status = all["cases"].back()["status"];
    failed = failed || status == "fail" || status == "refused";
    if (!options.json) print_one(all["cases"].back());
  }
  write_validation_tables(all, folder);
  if (!options.docs.empty()) copy_to_docs(cases, folder, options.docs);
  if (options.json) std::printf("%s\n", all.dump(2).c_str());
  return failed ? 1 : 0;
}

int stability(const Options& options) {
  StabilityOptions chosen;
  if (!options.output.empty()) chosen.output = options.output;
  chosen.cells = options.cases, chosen.fast = options.fast, chosen.list = options.list;
  chosen.quiet = options.quiet || options.json, chosen.jobs = options.threads;
  const nlohmann::json all = run_stability(chosen);
  if (options.json)
    std::printf("%s\n", all.dump(2).c_str());
  else if (options.list)
    for (const auto& one : all["cases"])
      std::printf("%-32s %s = %s\n", one["name"].get<std::string>().c_str(), one["vary"].get<std::string>().c_str(),
                  one["value"].get<std::string>().c_str());
  return all["counts"]["fail"].get<int>() > 0 ? 1 : 0;
}

}  // namespace

void add_validate_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("validate", "run the built-in cases and compare each with its reference");
  command->footer("Example: cusp validate hydrostatic_2d --json");
  command->add_option("CASE", options->cases, "names of cases (default: all)");
  command->add_flag("--full", options->full, "full settings instead of fast ones");
  command->add_flag("--stability", options->stability, "the stability matrix instead (CASE: names of its cells)");
  command->add_flag("--fast", options->fast, "of the stability matrix only the fast subset");
  command->add_flag("--list", options->list, "only list the cases");
  command->add_option("-o,--output", options->output, "folder for runs and tables (default: validation)");
  command->add_option("--random", options->random, "run this many random scenes instead: 50 steps each, or refused in one line");
  command->add_option("--seed", options->seed, "of the first random scene");
  command->add_option("--docs", options->docs, "also copy the table and the plots into this folder");
  command->add_option("--threads", options->threads, "processor threads")->check(CLI::Range(1, 4096));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->json, "print the result as JSON");
  command->callback([options, &exit_code] {
    exit_code = options->random > 0 ? validate_random(*options) : options->stability ? stability(*options) : validate(*options);
  });
}

}  // namespace app
