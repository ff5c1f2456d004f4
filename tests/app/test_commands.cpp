// Commands end to end on a small scene: exit codes, files, going on.
#include "app/commands.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "sim/run_file.h"

namespace {

namespace fs = std::filesystem;

const char* const scene_text =
    "title = \"drop\"\ndimension = 2\nspacing = 0.1\n[time]\nend = 0.1\noutput = 0.02\n[gravity]\nacceleration = [0, -10]\n"
    "[[body]]\nname = \"water\"\nkind = \"fluid\"\nshape = { type = \"box\", min = [0, 0], max = [0.6, 0.6] }\nmaterial = { density = 1000 "
    "}\n"
    "[[probe]]\nname = \"front\"\nquantity = \"front\"\naxis = \"y\"\n";

class Commands : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("cusp_commands_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "drop.toml") << scene_text;
  }
  int cusp(std::vector<std::string> words) {
    words.insert(words.begin(), "cusp");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    return app::run_program(static_cast<int>(arguments.size()), arguments.data());
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  fs::path folder_;
};

TEST_F(Commands, RunWritesItsFilesAndGoesOnFromAFinishedRun) {
  EXPECT_EQ(cusp({"run", path("drop.toml"), "-o", path("run.h5"), "--quiet"}), 0);
  for (const char* name : {"run.h5", "run.xmf", "run.csv"}) EXPECT_TRUE(fs::exists(path(name))) << name;
  EXPECT_EQ(cusp({"run", path("drop.toml"), "-o", path("run.h5"), "--quiet", "--continue"}), 0);
  std::ifstream csv(path("run.csv"));
  std::string heading;
  std::getline(csv, heading);
  EXPECT_EQ(heading.substr(0, 11), "time,front,");
  EXPECT_EQ(cusp({"info", path("run.h5"), "--json"}), 0);
  EXPECT_EQ(cusp({"export", path("run.h5"), "--csv", "-o", path("exported")}), 0);
  EXPECT_EQ(cusp({"replay", path("run.h5"), "--set", "gravity.acceleration=[0, -5]", "-o", path("slow.h5"), "--quiet"}), 0);
  EXPECT_GT(sim::RunReader(path("slow.h5")).column("front").back(), sim::RunReader(path("run.h5")).column("front").back());
}

TEST_F(Commands, BadInputExitsWith2) {
  EXPECT_EQ(cusp({"run", path("none.toml")}), 2);
  EXPECT_EQ(cusp({"run", path("drop.toml"), "--set", "spaceing=1", "-o", path("x.h5")}), 2);
  EXPECT_EQ(cusp({"run", path("drop.toml"), "-o", path("x.txt")}), 2);
  EXPECT_EQ(cusp({"run"}), 2);
  EXPECT_EQ(cusp({"fly"}), 2);
  EXPECT_EQ(cusp({"info", path("none.h5")}), 2);
  EXPECT_EQ(cusp({"export", path("drop.toml")}), 2);
  EXPECT_EQ(cusp({"validate", "no_such_case"}), 2);
  EXPECT_FALSE(fs::exists(path("x.h5")));
}

TEST_F(Commands, ExplainNamesOnlyTheStagesThatTheSceneAsksFor) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(cusp({"explain", path("drop.toml")}), 0);
  const std::string text = testing::internal::GetCapturedStdout();
  const std::size_t absent = text.find("not simulated");
  ASSERT_NE(absent, std::string::npos);
  EXPECT_LT(text.find("gravity on the fluid"), absent);
  EXPECT_GT(text.find("viscosity, implicit"), absent);
  EXPECT_GT(text.find("exchange through ports"), absent);
}

TEST_F(Commands, ValidateListsItsCasesAndEveryOneReads) { EXPECT_EQ(cusp({"validate", "--list"}), 0); }

}  // namespace
