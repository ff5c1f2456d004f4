// cusp explain SCENE [--measure]; cusp explain --measure
#include <cstdio>
#include <memory>

#include "app/commands.h"
#include "app/explain.h"
#include "app/measure_effects.h"
#include "app/measure_paper.h"
#include "app/progress.h"

namespace app {
namespace {

struct Options {
  std::string scene;
  std::vector<std::string> settings;
  bool measure = false, paper = false, json = false;
};

void print_plain(const nlohmann::json& about) {
  const auto text = [](const nlohmann::json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); };
  std::printf("%s: %s, %s-D, spacing %s m\n\nbodies\n", text(about["scene"]).c_str(), text(about["title"]).c_str(),
              text(about["dimension"]).c_str(), text(about["spacing"]).c_str());
  for (const auto& body : about["bodies"])
    std::printf("  %-16s %-8s %9s particles  %s\n", text(body["name"]).c_str(), text(body["kind"]).c_str(), text(body["particles"]).c_str(),
                text(body["material"]).c_str());
  std::printf("  %s particles in all\n\none time step, in order\n", text(about["particles"]).c_str());
  int number = 0;
  for (const auto& stage : about.value("stages", nlohmann::json::array()))
    std::printf("  %2d. %-48s because of %s\n", ++number, text(stage["stage"]).c_str(), text(stage["because"]).c_str());
  std::printf("\nnot simulated (no key asks for it)\n");
  for (const auto& stage : about.value("not_simulated", nlohmann::json::array())) std::printf("  %s\n", text(stage).c_str());
  std::printf("\nmemory about %.0f MB (state %.1f MB)\n", about["memory_bytes_about"].get<double>() / 1e6,
              about["state_bytes"].get<double>() / 1e6);
  if (about.contains("measured"))
    std::printf("measured: %.3g s a step of %.3g s (%.3g microseconds a particle)\n", about["measured"]["seconds_a_step"].get<double>(),
                about["measured"]["step"].get<double>(), about["measured"]["microseconds_a_particle_and_step"].get<double>());
  if (about.contains("estimated_seconds"))
    std::printf("time about %s%s\n", duration_text(about["estimated_seconds"].get<double>()).c_str(),
                about.contains("measured") ? "" : " (a guess; --measure runs a few steps)");
  for (const auto& warning : about["warnings"]) std::printf("warning: %s\n", text(warning).c_str());
}

// One line an effect, as a Markdown table.
void print_effects(const nlohmann::json& all) {
  std::printf(
      "| effect | stages it adds | bytes without | bytes with | microseconds a step without | with | at zero strength: positions (l0) | "
      "speeds |\n"
      "|---|---|---|---|---|---|---|---|\n");
  for (const auto& row : all["effects"]) {
    std::string stages;
    for (const auto& stage : row["stages_gained"]) stages += (stages.empty() ? "" : "; ") + stage.get<std::string>();
    const auto zero = [&](const char* key) {
      char text[32] = "-";
      if (row.contains(key)) std::snprintf(text, sizeof text, "%.1e", row[key].get<double>());
      return std::string(text);
    };
    std::printf("| %s | %s | %lld | %lld | %.0f | %.0f | %s | %s |\n", row["effect"].get<std::string>().c_str(),
                stages.empty() ? "none: within a stage" : stages.c_str(), row["bytes_without"].get<long long>(),
                row["bytes_with"].get<long long>(), 1e6 * row["seconds_a_step_without"].get<double>(),
                1e6 * row["seconds_a_step_with"].get<double>(), zero("zero_strength_position").c_str(),
                zero("zero_strength_velocity").c_str());
  }
}

void print_paper(const nlohmann::json& all) {
  std::printf(
      "| nu | G / E | lambda / E | G_eff / E: derived | operator | lambda_eff / E: derived | operator | E_eff / E: derived | bar | "
      "von Mises inside / (F/A): derived | bar |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  const double e = all["youngs_modulus"];
  for (const auto& row : all["rows"]) {
    const auto value = [&](const char* key) { return row[key].get<double>(); };
    std::printf("| %.2f | %.3f | %.3f | %.3f | %.3f | %.3f | %.3f | %.2f | %.2f | %.3f | %.3f |\n", value("poisson_ratio"),
                value("shear_modulus") / e, value("lame_lambda") / e, value("shear_modulus_derived") / e,
                value("shear_modulus_measured") / e, value("lame_lambda_derived") / e, value("lame_lambda_measured") / e,
                value("youngs_modulus_ratio_derived"), value("bar_stiffness_ratio_measured"), value("von_mises_ratio_derived"),
                value("von_mises_ratio_measured"));
  }
}

void say(const nlohmann::json& about, void (*in_words)(const nlohmann::json&), bool as_json) {
  if (as_json)
    std::printf("%s\n", about.dump(2).c_str());
  else
    in_words(about);
}

}  // namespace

void add_explain_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("explain", "say what would be simulated, what not, and what it costs");
  command->footer("Example: cusp explain scene.toml --measure");
  command->add_option("SCENE", options->scene, "scene file (.toml); with --measure alone: what each effect costs");
  command->add_option("--set", options->settings, "KEY=VALUE; may be repeated")->allow_extra_args(false);
  command->add_flag("--measure", options->measure, "run a few steps and say what they cost");
  command->add_flag("--paper", options->paper, "without a scene: what the published elastic operators simulate");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &exit_code] {
    if (!options->scene.empty())
      say(explain_scene(read_scene_file(options->scene, options->settings), options->measure ? 5 : 0), print_plain, options->json);
    else if (options->paper)
      say(measure_paper(), print_paper, options->json);
    else if (options->measure)
      say(measure_effects(), print_effects, options->json);
    else
      throw CLI::RequiredError("SCENE");
    exit_code = 0;
  });
}

}  // namespace app
