// The run loop: rows at their times whatever the step, results that do not depend on frames, restarts equal to the last bit, clean stops.
#include "sim/run.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

namespace {

namespace fs = std::filesystem;
using Vector2 = sim::Vector<2>;
constexpr double l0 = 0.1;

// A drop of water that falls: small, adaptive steps, exact trajectory of its middle.
sim::SceneDescription<2> falling_drop(double output) {
  sim::SceneDescription<2> scene;
  scene.title = "drop", scene.spacing = l0;
  scene.time.end = 0.2, scene.time.output = output;
  scene.gravity = Vector2(0, -10);
  sim::Body body;
  body.name = "water", body.kind = sim::Kind::fluid;
  auto& p = scene.particles;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 6; ++i) {
      p.position.emplace_back((i + 0.5) * l0, (j + 0.5) * l0);
      p.velocity.emplace_back(0.3, 0);
      p.kind.push_back(sim::Kind::fluid), p.body.push_back(0), p.volume.push_back(l0 * l0);
      p.normal.push_back(Vector2::Zero()), p.depth.push_back(0), p.surface_area.push_back(Vector2::Zero()), p.fixed.push_back(0);
      p.stiffness_scale.push_back(1), p.fibre.push_back(Vector2::Zero());
    }
  body.count = static_cast<std::int64_t>(p.size());
  scene.bodies.push_back(body);
  sim::Probe<2> probe;
  probe.name = "front", probe.quantity = sim::Quantity::front, probe.axis = 0;
  scene.probes.push_back(probe);
  return scene;
}

fs::path file_in_fresh_folder(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("cusp_run_" + name + "_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder / "run.h5";
}

sim::RunSetup setup_for(const fs::path& file) {
  sim::RunSetup setup;
  setup.file = file;
  setup.header.program_version = "test";
  setup.checkpoint_seconds = 0;
  return setup;
}

TEST(Run, WritesOneRowAnOutputTimeAtThatTime) {
  auto flight = falling_drop(0.03);
  flight.gravity.reset();      // uniform motion without shifting: the front's place is known at every row
  flight.scheme.shifting = 0;
  const auto scene = sim::make_scene(flight);
  const fs::path file = file_in_fresh_folder("rows");
  const sim::RunResult result = sim::run(scene, setup_for(file));
  EXPECT_EQ(result.ending, sim::RunEnding::finished);
  const sim::RunReader reader(file);
  const std::vector<double> time = reader.column("time"), front = reader.column("front");
  const std::vector<double> expected{0, 0.03, 0.06, 0.09, 0.12, 0.15, 0.18, 0.2};
  ASSERT_EQ(time.size(), expected.size());
  for (std::size_t k = 0; k < time.size(); ++k) {
    EXPECT_DOUBLE_EQ(time[k], expected[k]);
    EXPECT_NEAR(front[k], 0.6 + 0.3 * expected[k], 1e-6);  // free flight
  }
  EXPECT_EQ(reader.status(), "finished");
  EXPECT_GE(reader.frame_count(), 2u);
  EXPECT_DOUBLE_EQ(reader.frame_time(reader.frame_count() - 1), 0.2);
}

TEST(Run, DoesNotDependOnHowOftenFramesAreWritten) {
  std::vector<sim::State<2>> ends;
  for (double output : {0.2, 0.007}) {
    const fs::path file = file_in_fresh_folder("frames");
    sim::run(sim::make_scene(falling_drop(output)), setup_for(file));
    ends.push_back(sim::RunReader(file).checkpoint<2>().first);
  }
  EXPECT_EQ(ends[0].step, ends[1].step);
  EXPECT_EQ(ends[0].position, ends[1].position);
  EXPECT_EQ(ends[0].velocity, ends[1].velocity);
  EXPECT_EQ(ends[0].pressure, ends[1].pressure);
}

TEST(Run, InterruptedAndContinuedEqualsUninterruptedToTheLastBit) {
  const auto scene = sim::make_scene(falling_drop(0.05));
  const fs::path whole = file_in_fresh_folder("whole"), parts = file_in_fresh_folder("parts");
  sim::run(scene, setup_for(whole));
  std::atomic<bool> stop{false};
  sim::RunSetup setup = setup_for(parts);
  setup.stop = &stop;
  setup.progress = [&](const sim::RunProgress& progress) { stop = progress.time > 0.08; };
  const sim::RunResult first = sim::run(scene, setup);
  EXPECT_EQ(first.ending, sim::RunEnding::stopped);
  EXPECT_LT(first.time, 0.2);
  sim::RunSetup resumed = setup_for(parts);
  resumed.resume = true;
  EXPECT_EQ(sim::run(scene, resumed).ending, sim::RunEnding::finished);
  const sim::RunReader a(whole), b(parts);
  const auto end_a = a.checkpoint<2>().first, end_b = b.checkpoint<2>().first;
  EXPECT_EQ(end_a.step, end_b.step);
  EXPECT_EQ(end_a.position, end_b.position);
  EXPECT_EQ(end_a.velocity, end_b.velocity);
  EXPECT_EQ(end_a.pressure, end_b.pressure);
  EXPECT_EQ(a.column("front"), b.column("front"));
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (std::size_t k = 0; k < a.frame_count(); ++k) EXPECT_EQ(a.frame(k).position, b.frame(k).position);
  EXPECT_EQ(sim::run(scene, resumed).ending, sim::RunEnding::already_finished);
}

TEST(Run, RefusesToGoOnWithAnotherScene) {
  const fs::path file = file_in_fresh_folder("other");
  sim::run(sim::make_scene(falling_drop(0.1)), setup_for(file));
  sim::SceneDescription<2> other = falling_drop(0.1);
  other.probes.clear();
  sim::RunSetup setup = setup_for(file);
  setup.resume = true;
  EXPECT_THROW(sim::run(sim::make_scene(other), setup), std::runtime_error);
}

}  // namespace
