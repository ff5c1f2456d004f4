// Errors against references, on a run file with known content.
#include "app/compare.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

namespace {

TEST(Compare, MeasuresScalarsCurvesAndProfiles) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("cusp_compare_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "curve.csv") << "0,0\n1,2\n2,4\n";
  std::ofstream(folder / "profile.csv") << "0,1\n0.5,1\n1,1\n";
  sim::RunHeader header;
  header.dimension = 2;
  header.columns = {"time", "tip.x", "tip.y", "speed"};
  header.units = {"s", "m", "m", "m/s"};
  header.lines.push_back({"along", "m/s", {{0, 0, 0}, {0, 1, 0}}, {"value.x", "value.y"}});
  {
    sim::RunWriter writer = sim::RunWriter::create(folder / "run.h5", header);
    for (int k = 0; k <= 2; ++k) writer.add_row({double(k), 3, 0.5 * k, 2.2 * k}, {{1.1, 0, 0.9, 0}});
    writer.finish();
  }
  const std::string scene_text =
      "dimension = 2\nspacing = 0.1\n[time]\nend = 2\n[[body]]\nname = \"w\"\nkind = \"fluid\"\nshape = { type = \"box\", min = [0, 0], "
      "max = [1, 1] }\n"
      "material = { density = 1 }\n[[probe]]\nname = \"tip\"\nquantity = \"velocity\"\nat = [0, 0]\n[[probe]]\nname = \"speed\"\nquantity "
      "= \"pressure\"\nat = [0, 0]\n"
      "[[probe]]\nname = \"along\"\nquantity = \"velocity\"\nline = { from = [0, 0], to = [0, 1], count = 2 }\n"
      "[reference]\ntip = { x = 4, y = 1, limit = 0.1 }\nspeed = { table = \"curve.csv\" }\nalong = { table = \"profile.csv\", component = "
      "\"x\" }\n";
  const app::SceneFile scene = app::parse_scene_text(scene_text, folder / "scene.toml");
  const auto results = app::compare_with_references(scene, sim::RunReader(folder / "run.h5"));
  ASSERT_EQ(results.size(), 4u);
  for (const app::Comparison& c : results) {
    if (c.quantity == "tip.x") {
      EXPECT_DOUBLE_EQ(c.error, 0.25);
      EXPECT_FALSE(c.passed());
    }
    if (c.quantity == "tip.y") {
      EXPECT_DOUBLE_EQ(c.error, 0);
      EXPECT_TRUE(c.passed());
    }
    if (c.quantity == "speed") EXPECT_NEAR(c.error, 0.1, 1e-12);
    if (c.quantity == "along") EXPECT_NEAR(c.error, std::sqrt(0.02 / 3), 1e-12);  // 0.1, 0 and -0.1 off at the table's points
  }
}

}  // namespace
