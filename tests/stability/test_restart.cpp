// A run that is killed and continued equals the uninterrupted one to the last bit, whatever its effects remember. CUSP_KILLS=100 makes the
// long test: build/test_stability --gtest_filter='Kill.*'
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "sim/run_file.h"
#include "stability/child.h"
#include "stability/small_scenes.h"

namespace {

using namespace stability;

// Everything of the frames and the series, bit for bit.
void expect_equal_runs(const fs::path& first, const fs::path& second) {
  const sim::RunReader a(first), b(second);
  EXPECT_EQ(b.status(), "finished");
  ASSERT_EQ(a.frame_count(), b.frame_count());
  for (std::size_t k = 0; k < a.frame_count(); ++k) {
    const sim::RunFrame p = a.frame(k), q = b.frame(k);
    ASSERT_EQ(p.time, q.time) << "frame " << k;
    ASSERT_EQ(p.id, q.id) << "frame " << k;
    ASSERT_EQ(p.position, q.position) << "frame " << k;
    ASSERT_EQ(p.velocity, q.velocity) << "frame " << k;
    ASSERT_EQ(p.pressure, q.pressure) << "frame " << k;
    ASSERT_EQ(p.stress, q.stress) << "frame " << k;
  }
  EXPECT_EQ(a.series(), b.series());
  fs::path csv_a = first, csv_b = second;
  EXPECT_EQ(text_of(csv_a.replace_extension(".csv")), text_of(csv_b.replace_extension(".csv")));
}

struct Tally {
  int tried = 0, survived = 0;
};

// Kills a run again and again at random moments, continuing it each time, until it was killed `kills` times; then lets it finish. After
// each kill the file must open with all frames that were there before.
Tally kill_and_continue(const fs::path& folder, const std::string& scene, int kills, double duration, unsigned seed,
                        const std::vector<std::string>& settings) {
  Tally tally;
  std::mt19937 random(seed);
  std::vector<std::string> words{"run", scene,       "-o", (folder / "killed.h5").string(), "--quiet", "--continue", "--checkpoint",
                                 "0",   "--threads", "1"};
  words.insert(words.end(), settings.begin(), settings.end());
  std::size_t frames = 0;
  while (tally.tried < kills) {
    ChildOptions options;
    options.kill_after = std::uniform_real_distribution<double>(0.005, duration)(random);
    const ChildResult result = run_cusp(words, folder / "killed.log", options);
    if (result.signal != SIGKILL) {  // it was through: begin again
      EXPECT_EQ(result.exit_code, 0) << result.errors;
      fs::remove(folder / "killed.h5");
      frames = 0;
      continue;
    }
    ++tally.tried;
    if (!fs::exists(folder / "killed.h5")) {  // killed before it wrote anything
      EXPECT_EQ(frames, 0u) << "kill " << tally.tried;
      tally.survived += frames == 0;
      continue;
    }
    std::size_t now = 0;
    try {
      now = sim::RunReader(folder / "killed.h5").frame_count();
    } catch (const std::runtime_error& error) {
      if (frames > 0) ADD_FAILURE() << "kill " << tally.tried << ": " << error.what();
    }
    EXPECT_GE(now, frames) << "kill " << tally.tried;
    tally.survived += now >= frames;
    frames = now;
  }
  const ChildResult result = run_cusp(words, folder / "killed.log");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return tally;
}

// Seconds the uninterrupted run takes.
double run_whole(const fs::path& folder, const std::string& scene, const std::vector<std::string>& settings) {
  std::vector<std::string> words{"run", scene, "-o", (folder / "whole.h5").string(), "--quiet", "--threads", "1"};
  words.insert(words.end(), settings.begin(), settings.end());
  const auto start = std::chrono::steady_clock::now();
  const ChildResult result = run_cusp(words, folder / "whole.log");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void restart(const char* name, const char* text, int kills, const std::vector<std::string>& settings = {}) {
  if (const char* wanted = std::getenv("CUSP_KILLS")) kills = std::max(1, std::atoi(wanted));
  const fs::path folder = fresh_folder(std::string("restart_") + name);
  const std::string scene = write_scene(folder, text).string();
  const double duration = run_whole(folder, scene, settings);
  const Tally tally = kill_and_continue(folder, scene, kills, duration, 7, settings);
  std::printf("%s: kills survived %d of %d\n", name, tally.survived, tally.tried);
  expect_equal_runs(folder / "whole.h5", folder / "killed.h5");
}

TEST(Kill, FluidWithAFreeSurfaceGoesOnAsIfNothingHadHappened) { restart("dam", dam_scene, 5); }
TEST(Kill, SolidInAFluidGoesOnAsIfNothingHadHappened) { restart("solid", solid_scene, 4); }
TEST(Kill, StiffSolidAloneGoesOnAsIfNothingHadHappened) { restart("beam", beam_scene, 4); }
TEST(Kill, ValveInBloodWithPortsGoesOnAsIfNothingHadHappened) { restart("valve", valve_scene, 3, {"--set", "time.end=0.006"}); }

TEST(Kill, BetweenTheLastStepAndTheBooksTheEndIsMadeUp) {
  const fs::path folder = fresh_folder("restart_end");
  const std::string scene = write_scene(folder, beam_scene).string();
  const fs::path run = folder / "whole.h5";
  run_whole(folder, scene, {});
  {
    const sim::Checkpoint last = sim::RunReader(run).checkpoint<2>().second;
    sim::RunWriter writer = sim::RunWriter::resume(run, last);
    writer.set_status("running", last.wall_seconds, 1);
    writer.finish();
  }
  ASSERT_EQ(sim::RunReader(run).status(), "running");
  EXPECT_EQ(run_cusp({"run", scene, "-o", run.string(), "--quiet", "--continue"}, folder / "log").exit_code, 0);
  EXPECT_EQ(sim::RunReader(run).status(), "finished");
}

// Ctrl-C: the step is finished, the state saved, status and exit code say so, and the run goes on to the same result.
TEST(Interrupt, StopsCleanlyAndGoesOn) {
  const fs::path folder = fresh_folder("interrupt");
  const std::string scene = write_scene(folder, valve_scene).string(), run = (folder / "killed.h5").string();
  const std::vector<std::string> settings{"--set", "time.end=0.006"};
  run_whole(folder, scene, settings);
  std::vector<std::string> words{"run", scene, "-o", run, "--threads", "1", "--set", "time.end=0.006", "--continue"};
  ChildOptions options;
  options.kill_once_there = run, options.kill_with = SIGINT;  // while the scene is built, Ctrl-C ends the program at once
  const ChildResult stopped = run_cusp(words, folder / "log", options);
  ASSERT_EQ(stopped.exit_code, 1) << stopped.errors;
  EXPECT_NE(stopped.errors.find("interrupted; `--continue` goes on from here"), std::string::npos) << stopped.errors;
  EXPECT_EQ(sim::RunReader(run).status(), "stopped: interrupted");
  EXPECT_EQ(run_cusp(words, folder / "log").exit_code, 0);
  expect_equal_runs(folder / "whole.h5", run);
}

}  // namespace
