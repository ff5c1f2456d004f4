// Every example scene is understood and runs: the static ones to equilibrium, the others for a few steps.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <regex>

#include "app/assets.h"
#include "app/run_case.h"

namespace {

namespace fs = std::filesystem;

// Names, not paths: GoogleTest cannot print a path.
std::vector<std::string> examples() {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(app::asset("scenes/examples")))
    if (entry.path().extension() == ".toml") found.push_back(entry.path().stem().string());
  std::sort(found.begin(), found.end());
  return found;
}

class Example : public testing::TestWithParam<std::string> {};

TEST_P(Example, Runs) {
  const fs::path file = app::asset("scenes/examples/" + GetParam() + ".toml");
  app::SceneFile scene = app::read_scene_file(file);
  if (scene.time.mode == sim::TimeMode::dynamic)
    scene = app::read_scene_file(file, {scene.dimension == 2 ? "time.end=0.004" : "time.end=0.0004",
                                        scene.dimension == 2 ? "time.output=0.002" : "time.output=0.0002"});
  app::RunCaseOptions options;
  options.output = fs::temp_directory_path() / ("cusp_example_" + std::to_string(getpid()) + ".h5");
  options.quiet = true;
  const sim::RunResult result = app::run_case(scene, options);
  EXPECT_EQ(result.ending, sim::RunEnding::finished) << result.message;
  for (const char* ending : {".h5", ".csv", ".xmf"}) fs::remove(fs::path(options.output).replace_extension(ending));
}

TEST(Examples, AreTen) { EXPECT_EQ(examples().size(), 10u); }

INSTANTIATE_TEST_SUITE_P(Scenes, Example, testing::ValuesIn(examples()),
                         [](const auto& info) { return std::regex_replace(info.param, std::regex("[^A-Za-z0-9]"), "_"); });

}  // namespace
