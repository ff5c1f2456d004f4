#include "app/replay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/app/example_run.h"

namespace app {
namespace {

TEST(Replay, knows_what_leaves_the_particles_where_they_are) {
  for (const char* setting : {"body.leaflets.material.youngs_modulus=2e6", "body.leaflets.stiffness_map=[]", "patient.heart_rate=80",
                              "patient.aortic_pressure={ systolic = 18000, diastolic = 11000 }", "time.end=0.4", "scheme.cfl=0.1"})
    EXPECT_FALSE(moves_particles(setting)) << setting;
  for (const char* setting : {"spacing=1e-3", "body.leaflets.material.thickness=1e-3", "patient.valve.thickness=1e-3",
                              "patient.root.annulus.diameter=0.02", "body.plate.shape.min=[0, 0]", "something.new=1"})
    EXPECT_TRUE(moves_particles(setting)) << setting;
}

TEST(Replay, spells_values_out) {
  EXPECT_EQ(spelt_out_settings("a.b=1,2e6"), (std::vector<std::string>{"a.b=1", "a.b=2e6"}));
  for (const char* text : {"a.b", "a.b=", "=1"}) EXPECT_THROW(spelt_out_settings(text), SceneError) << text;
}

// The made-up beat: its orifice is 4 cm2 sin^2, so half of it is passed at a quarter and three quarters of the beat; flow 400 mL/s sin.
TEST(Replay, compares_two_beats_figure_by_figure) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "cusp_replay";
  std::filesystem::create_directories(folder);
  example::write_valve_run(folder / "a.h5", 81);
  example::write_valve_run(folder / "b.h5", 81, 6e5);
  const sim::RunReader a(folder / "a.h5"), b(folder / "b.h5");
  const std::vector<ComparedFigure> figures = compare_runs({&a, &b});
  const auto value = [&](const std::string& name) {
    for (const ComparedFigure& figure : figures)
      if (figure.name == name) return figure.values;
    return std::vector<double>{NAN, NAN};
  };
  for (const std::size_t run : {0u, 1u}) {
    EXPECT_NEAR(value("largest orifice")[run], 4, 0.02);
    EXPECT_NEAR(value("opens (half of it) at")[run], 200, 11);
    EXPECT_NEAR(value("closes (half of it) at")[run], 600, 11);
    EXPECT_NEAR(value("time spent")[run], 1, 1e-9);
  }
  const std::string text = comparison_text(figures, {"before", "after"});
  EXPECT_NE(text.find("largest orifice"), std::string::npos);
  EXPECT_NE(text.find("+0.0%"), std::string::npos);
  const nlohmann::json json = comparison_json(figures, {"before", "after"});
  EXPECT_EQ(json["runs"].size(), 2u);
  EXPECT_EQ(json["figures"].size(), figures.size());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace app
