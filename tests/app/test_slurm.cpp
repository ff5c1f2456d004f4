// cusp sweep --slurm on a real cluster of one node, started for the test by tests/slurm/one_node.sh.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// A membrane's bulge over stiffness and pressure: an array of four tasks, waited for, one table. It grows with pressure and shrinks with
// stiffness. Then --collect makes the same table without a cluster.
TEST(Slurm, RunsASweepAsAJobArray) {
  const fs::path folder = fs::temp_directory_path() / ("cusp_slurm_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const std::string sweep = "\"" CUSP_BINARY_DIR "/cusp\" sweep \"" CUSP_SOURCE_DIR
                            "/assets/scenes/examples/05_membrane.toml\" --vary body.membrane.material.youngs_modulus=1e6,2e6 "
                            "--vary load.0.pressure=-500,-1000 -o sweep";
  const std::string here = "cd \"" + folder.string() + "\" && ";
  const int status = std::system(
      (here + "timeout 600 \"" CUSP_SOURCE_DIR "/tests/slurm/one_node.sh\" " + sweep + " --slurm --wait > out.txt 2> err.txt").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) {
    const std::string why = text_of(folder / "err.txt");
    fs::remove_all(folder);
    GTEST_SKIP() << why;
  }
  ASSERT_EQ(WEXITSTATUS(status), 0) << text_of(folder / "out.txt") << text_of(folder / "err.txt");
  EXPECT_NE(text_of(folder / "out.txt").find("Submitted batch job"), std::string::npos);
  const nlohmann::json table = nlohmann::json::parse(text_of(folder / "sweep/sweep.json"));
  ASSERT_EQ(table["cases"].size(), 4u);
  std::vector<double> bulge;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(table["cases"][k]["status"], "finished");
    EXPECT_TRUE(fs::exists(folder / "sweep" / ("slurm-" + std::to_string(k) + ".log"))) << "task " << k << " was not Slurm's";
    bulge.push_back(table["cases"][k]["last"]["middle.z"]);
  }
  EXPECT_GT(bulge[0], 0);
  EXPECT_GT(bulge[1], bulge[0]);  // twice the pressure
  EXPECT_LT(bulge[2], bulge[0]);  // twice the stiffness
  fs::remove(folder / "sweep/sweep.json");
  ASSERT_EQ(std::system((here + sweep + " --collect > /dev/null").c_str()), 0);
  EXPECT_EQ(nlohmann::json::parse(text_of(folder / "sweep/sweep.json")), table);
  fs::remove_all(folder);
}

}  // namespace
