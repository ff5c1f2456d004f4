// `cusp accuracy`: runs what accuracy_plan.h plans, compares each run with the scene's [reference] or with the finest run, and writes what
// it found: accuracy.csv, .json, .png, .md.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/work_precision.h"

namespace app {

struct AccuracyOptions {
  std::filesystem::path scene, folder;
  std::vector<std::string> settings, vary;  // vary: KEY=V1,V2,…; a grid instead of the built-in ladder and knobs, except spacing=… alone,
                                            // which is the ladder
  std::vector<std::string> knobs;  // names; empty: all; "none": none
  int jobs = 1, threads = 1, repeats = 3, seeds = 5;
  double budget = 0;  // s; 0: run the whole plan
  CostClock clock = CostClock::wall;
  bool quiet = false;
};

// Runs what is not there yet. Throws SceneError on a scene with nothing to compare, std::runtime_error where no run finished.
AccuracyStudy measure_accuracy(const AccuracyOptions& options);

nlohmann::json study_json(const AccuracyStudy& study);
AccuracyStudy study_from_json(const nlohmann::json& json);  // throws std::runtime_error on what is no study
// accuracy.csv, .json, .md, .png.
void write_study(const AccuracyStudy& study, const std::filesystem::path& folder);
// The text of accuracy.md, from the given level of headings.
std::string study_text(const AccuracyStudy& study, const std::string& picture, int heading = 1);

}  // namespace app
