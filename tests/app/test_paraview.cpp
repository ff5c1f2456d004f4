// ParaView reads RUN.xmf: the same number of steps, the fields by their names, the same largest stress.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/app/example_run.h"

namespace {

namespace fs = std::filesystem;

TEST(ParaView, ReadsStepsFieldsAndStress) {
  if (std::system("command -v pvpython >/dev/null 2>&1") != 0) GTEST_SKIP() << "pvpython (Debian: python3-paraview) is not installed";
  const fs::path folder = fs::temp_directory_path() / ("cusp_paraview_" + std::to_string(getpid()));
  fs::create_directories(folder);
  app::example::write_valve_run(folder / "run.h5", 5);
  const std::string command = "timeout 300 pvpython '" CUSP_SOURCE_DIR "/tests/paraview/peak_stress.py' '" + (folder / "run.xmf").string() +
                              "' > '" + (folder / "out.txt").string() + "' 2> '" + (folder / "err.txt").string() + "'";
  const int status = std::system(command.c_str());
  std::ifstream in(folder / "out.txt");
  std::map<std::string, std::string> found;
  for (std::string line; std::getline(in, line);) found[line.substr(0, line.find(' '))] = line.substr(line.find(' ') + 1);
  std::ifstream complaints(folder / "err.txt");
  std::stringstream said;
  said << complaints.rdbuf();
  ASSERT_EQ(status, 0) << said.str();
  EXPECT_EQ(found["steps"], "5");
  for (const char* name : {"velocity", "pressure", "von_mises_stress", "largest_principal_stress", "stress", "kind", "body", "id"})
    EXPECT_NE((" " + found["fields"] + " ").find(" " + std::string(name) + " "), std::string::npos) << name << " in " << found["fields"];
  const sim::RunReader run(folder / "run.h5");
  float peak = 0;
  for (std::size_t k = 0; k < run.frame_count(); ++k) {
    const sim::RunFrame frame = run.frame(k);
    peak = std::max(peak, *std::max_element(frame.von_mises.begin(), frame.von_mises.end()));
  }
  EXPECT_NEAR(std::atof(found["peak"].c_str()), peak, 1e-6 * peak);
  fs::remove_all(folder);
}

}  // namespace
