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

// A dry preview knows the closed valve alone: of the beat beside it the median of its closed phase is compared, and nothing else.
TEST(Replay, compares_a_dry_preview_with_a_beat_by_the_closed_valve_alone) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "cusp_replay_dry";
  std::filesystem::create_directories(folder);
  example::write_valve_run(folder / "beat.h5", 81);
  sim::RunHeader header;
  header.title = "dry", header.scheme = "accurate", header.spacing = 1e-3, header.end = 0.01, header.output = 0.01;
  header.valve = sim::ValveFrame{};
  header.valve->ventricle_port = header.valve->aorta_port = -1;
  header.columns = {"time", "orifice_area", "leaflet_stress_p99"}, header.units = {"s", "m2", "Pa"};
  {
    sim::RunWriter writer = sim::RunWriter::create(folder / "dry.h5", header);
    writer.add_row({0, 4e-5, 0}, {});
    writer.add_row({0.01, 2e-6, 3e5}, {});
    writer.set_status("finished", 1, 2);
    writer.finish();
  }
  const sim::RunReader beat(folder / "beat.h5"), dry(folder / "dry.h5");
  const std::vector<ComparedFigure> figures = compare_runs({&beat, &dry});
  for (const ComparedFigure& figure : figures) {
    EXPECT_NE(figure.name, "largest orifice");
    EXPECT_NE(figure.name, "jet speed, largest");
    if (figure.name == "stress, valve closed") EXPECT_DOUBLE_EQ(figure.values[1], 300);
    if (figure.name == "orifice left when closed") {
      EXPECT_DOUBLE_EQ(figure.values[1], 0.02);
      // 4 cm2 sin^2 in the middle of 0.65 s (a quarter after closing at 0.6 s) to 0.8 s; moments are known to a row, 10 ms
      EXPECT_NEAR(figure.values[0], 4 * std::pow(std::sin(M_PI * 0.73 / 0.8), 2), 0.04);
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace app
