// `cusp accuracy` and the budgets of `cusp run` from end to end, as a user types them, on a cantilever that takes seconds.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/run_file.h"
#include "stability/child.h"

namespace {

using namespace stability;
using nlohmann::json;

struct Folder {
  fs::path path = fresh_folder("accuracy"), log = path / "log.txt", scene = path / "cantilever_small.toml";
  Folder() {
    for (const char* file : {"cantilever_small.toml", "cantilever_small.csv"})
      fs::copy_file(fs::path(CUSP_SOURCE_DIR) / "assets/scenes/validation" / file, path / file);
  }
  ~Folder() { fs::remove_all(path); }
  json study() const { return json::parse(text_of(path / "accuracy-cantilever_small" / "accuracy.json")); }
};

TEST(AccuracyCommand, MeasuresOnceAndThenBudgetsChooseFromIt) {
  const Folder here;
  const std::string scene = here.scene.string();
  // Nothing measured yet: one line that names the command, and nothing is run.
  ChildResult refused = run_cusp({"run", scene, "--error-target", "5%", "-o", (here.path / "run.h5").string()}, here.log);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(lines_of(refused.errors), 1u) << refused.errors;
  EXPECT_NE(refused.errors.find("cusp accuracy " + scene), std::string::npos) << refused.errors;
  EXPECT_FALSE(fs::exists(here.path / "run.h5"));

  const std::vector<std::string> words{"accuracy",  scene,
                                       "--vary",    "spacing=0.005,0.0033333333,0.0025",
                                       "--knobs",   "scheme.elastic_tolerance",
                                       "--repeats", "2",
                                       "--seeds",   "2",
                                       "--threads", "1",
                                       "--quiet"};
  const ChildResult measured = run_cusp(words, here.log);
  ASSERT_EQ(measured.exit_code, 0) << measured.errors;
  const json study = here.study();
  ASSERT_GE(study["points"].size(), 4u);
  const json& rung = study["points"][0];
  EXPECT_EQ(rung["wall_seconds"].size(), 2u);
  EXPECT_GT(rung["processor_seconds"][0].get<double>(), 0);
  EXPECT_GT(rung["peak_memory"].get<double>(), 1e6);
  EXPECT_GT(rung["particle_steps"].get<double>(), 0);
  EXPECT_EQ(study["against"], "[reference]");
  for (const char* name : {"accuracy.csv", "accuracy.md", "accuracy.png"})
    EXPECT_GT(fs::file_size(here.path / "accuracy-cantilever_small" / name), 500u) << name;

  // Again: nothing is run a second time.
  fs::path some_run;
  for (const auto& entry : fs::recursive_directory_iterator(here.path))
    if (entry.path().filename() == "run.h5") some_run = entry.path();
  const auto before = fs::last_write_time(some_run);
  ASSERT_EQ(run_cusp(words, here.log).exit_code, 0);
  EXPECT_EQ(fs::last_write_time(some_run), before);

  // The error that the finest rung had is what a target just above it gets.
  double finest = 0;
  for (const json& error : study["points"][2]["error"])
    if (error.is_number()) finest = std::max(finest, error.get<double>());
  const fs::path run = here.path / "run.h5";
  const ChildResult chosen =
      run_cusp({"run", scene, "--error-target", std::to_string(1.02 * finest), "--threads", "1", "-o", run.string()}, here.log);
  ASSERT_EQ(chosen.exit_code, 0) << chosen.errors;
  EXPECT_NE(chosen.errors.find("--error-target"), std::string::npos) << chosen.errors;
  EXPECT_LE(sim::RunReader(run).header().spacing, 0.005);
  // A target that nothing reached is refused with what was reached.
  const ChildResult too_fine = run_cusp({"run", scene, "--error-target", "0.00001", "-o", run.string()}, here.log);
  EXPECT_EQ(too_fine.exit_code, 2) << too_fine.errors;
  EXPECT_NE(too_fine.errors.find("not reached"), std::string::npos) << too_fine.errors;
  // Physics that was not measured is not guessed at.
  EXPECT_EQ(run_cusp({"run", scene, "--time-budget", "1min", "--set", "body.0.material.youngs_modulus=3e6", "-o", run.string()}, here.log)
                .exit_code,
            2);
}

TEST(AccuracyCommand, RefusesWhatItCannotMeasureInOneLine) {
  const Folder here;
  for (const std::vector<std::string>& words : {std::vector<std::string>{"accuracy"},
                                                {"accuracy", here.scene.string(), "--knobs", "scheme.colour"},
                                                {"accuracy", here.scene.string(), "--budget", "soon"},
                                                {"accuracy", here.scene.string(), "--clock", "sun"}}) {
    std::vector<std::string> quick = words;
    if (words.size() > 1) quick.insert(quick.end(), {"--vary", "spacing=0.005", "--seeds", "0", "--repeats", "1", "--quiet"});
    const ChildResult result = run_cusp(quick, here.log);
    EXPECT_EQ(result.exit_code, 2) << words.back();
    EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
  }
}

}  // namespace
