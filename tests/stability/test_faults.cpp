// What a machine does to a run: full disk, read-only folder, too little memory, two writers, a scene that asks for too much or writes where
// it must not. Each ends with one clear line, the contract's exit code, and nothing lost that was written before.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "sim/run_file.h"
#include "stability/child.h"
#include "stability/small_scenes.h"

namespace {

using namespace stability;

class Faults : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder(std::string("faults_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    scene_ = write_scene(folder_, dam_scene).string();
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> words(const std::string& run, std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"run", scene_, "-o", run, "--quiet", "--checkpoint", "0", "--threads", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  // Last frame of both runs, bit for bit.
  static void expect_same_end(const std::string& first, const std::string& second) {
    const sim::RunReader a(first), b(second);
    ASSERT_EQ(a.frame_count(), b.frame_count());
    EXPECT_EQ(a.frame(a.frame_count() - 1).position, b.frame(b.frame_count() - 1).position);
    EXPECT_EQ(a.series(), b.series());
  }
  fs::path folder_;
  std::string scene_;
};

TEST_F(Faults, FullDiskKeepsEveryFinishedFrameAndTheRunGoesOn) {
  ASSERT_EQ(run_cusp(words(path("whole.h5")), path("log")).exit_code, 0);
  const std::uintmax_t size = fs::file_size(path("whole.h5"));
  std::size_t most = 0;
  for (int part = 3; part <= 9; part += 3) {  // the disk is full after some, half and most of the run
    fs::remove(path("full.h5"));
    ChildOptions options;
    options.largest_file = size * static_cast<std::uintmax_t>(part) / 10;
    const ChildResult result = run_cusp(words(path("full.h5")), path("log"), options);
    EXPECT_EQ(result.exit_code, 1) << "signal " << result.signal;
    EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
    EXPECT_NE(result.errors.find("can't be written"), std::string::npos) << result.errors;
    const std::size_t frames = sim::RunReader(path("full.h5")).frame_count();
    EXPECT_GE(frames, most);
    EXPECT_GT(frames, 1u);
    for (std::size_t k = 0; k < frames; ++k) EXPECT_GT(sim::RunReader(path("full.h5")).frame(k).size(), 0u);
    most = frames;
    EXPECT_EQ(run_cusp(words(path("full.h5"), {"--continue"}), path("log")).exit_code, 0);
    expect_same_end(path("whole.h5"), path("full.h5"));
  }
}

TEST_F(Faults, FullFileSystemToo) {
  const fs::path disk = folder_ / "disk";
  fs::create_directories(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=300k") != 0) GTEST_SKIP() << "no right to mount a small file system";
  const ChildResult result = run_cusp(words((disk / "run.h5").string()), path("log"));
  std::size_t frames = 0;
  std::string status;
  try {
    const sim::RunReader reader(disk / "run.h5");
    frames = reader.frame_count();
    for (std::size_t k = 0; k < frames; ++k) reader.frame(k);
  } catch (const std::runtime_error& error) {
    status = error.what();
  }
  umount(disk.c_str());
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
  EXPECT_NE(result.errors.find("can't be written"), std::string::npos) << result.errors;
  EXPECT_EQ(status, "");
  EXPECT_GT(frames, 0u);
}

TEST_F(Faults, ReadOnlyFolderIsSaidInOneLine) {
  const fs::path closed = folder_ / "closed";
  fs::create_directories(closed);
  fs::permissions(closed, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec);
  fs::permissions(folder_, fs::perms::others_all, fs::perm_options::add);  // the log and the scene
  ChildOptions options;
  if (geteuid() == 0) options.user = 65534;
  const ChildResult result = run_cusp(words((closed / "run.h5").string()), path("log"), options);
  fs::permissions(closed, fs::perms::owner_all);
  if (result.exit_code >= 126) GTEST_SKIP() << "the program can't be started as another user here";
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
  EXPECT_NE(result.errors.find("Permission denied"), std::string::npos) << result.errors;
  EXPECT_FALSE(fs::exists(closed / "run.h5"));
}

TEST_F(Faults, MissingParentThatIsAFileIsSaid) {
  std::ofstream(path("file")) << "x";
  const ChildResult result = run_cusp(words(path("file/run.h5")), path("log"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
}

TEST_F(Faults, MemoryLimitOfTheSceneIsRefusedBeforeWorkWithTheSpacingThatFits) {
  const ChildResult result = run_cusp(words(path("run.h5"), {"--set", "limits.memory=61000000", "--set", "spacing=0.01"}), path("log"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
  EXPECT_NE(result.errors.find("limits.memory"), std::string::npos) << result.errors;
  EXPECT_NE(result.errors.find("would fit"), std::string::npos) << result.errors;
  EXPECT_FALSE(fs::exists(path("run.h5")));
}

TEST_F(Faults, MemoryLimitOfTheSystemIsSaidInOneLine) {
  ASSERT_EQ(run_cusp(words(path("run.h5"), {"--set", "time.end=0.1"}), path("log")).exit_code, 0);
  for (const rlim_t megabytes : {700, 900, 1200}) {  // somewhere between loading and the first steps of half a million particles
    ChildOptions options;
    options.address_space = megabytes << 20;
    const ChildResult result = run_cusp(words(path("big.h5"), {"--set", "spacing=0.0008", "--set", "time.end=1e-9"}), path("log"), options);
    if (result.exit_code == 0) continue;  // enough after all
    EXPECT_EQ(result.signal, 0) << megabytes << " MB";
    EXPECT_EQ(result.exit_code, 1) << result.errors;
    EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
    EXPECT_NE(result.errors.find("memory"), std::string::npos) << result.errors;
  }
  EXPECT_EQ(sim::RunReader(path("run.h5")).status(), "finished");
}

TEST_F(Faults, TwoRunsOnOneFileLeaveTheFirstAlone) {
  const std::string slow = write_scene(folder_, valve_scene).string();
  const pid_t first = start_cusp({"run", slow, "-o", path("run.h5"), "--quiet", "--threads", "1", "--set", "time.end=10"}, path("first.log"));
  for (int k = 0; k < 2000 && !fs::exists(path("run.h5.journal")); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  for (const bool resume : {false, true}) {
    std::vector<std::string> second{"run", slow, "-o", path("run.h5"), "--quiet", "--set", "time.end=10"};
    if (resume) second.push_back("--continue");
    const ChildResult result = run_cusp(second, path("log"));
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.errors.find("another run is writing it"), std::string::npos) << result.errors;
  }
  kill(first, SIGINT);
  const ChildResult result = wait_for(first, path("first.log"));
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  const sim::RunReader reader(path("run.h5"));
  EXPECT_EQ(reader.status(), "stopped: interrupted");
  EXPECT_GE(reader.frame_count(), 1u);
}

TEST_F(Faults, NamesInASceneCannotLeaveTheRunsFolder) {
  for (const char* name : {"../../escaped", "/tmp/escaped", "a/b", "..", "a\\u0000b", "a,b"}) {
    const std::string text = std::string(dam_scene) + "[[probe]]\nname = \"" + name +
                             "\"\nquantity = \"pressure\"\nline = { from = [0.1, 0.1], to = [0.3, 0.1], count = 3 }\n";
    std::ofstream(path("evil.toml")) << text;
    const ChildResult result = run_cusp({"run", path("evil.toml"), "-o", path("evil.h5"), "--quiet"}, path("log"));
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
    EXPECT_FALSE(fs::exists(path("evil.h5")));
  }
}

TEST_F(Faults, TooManyParticlesAreRefusedWithTheCountAndASpacingThatFits) {
  for (const char* spacing : {"1e-5", "1e-9", "1e-12", "1e-100"}) {
    const ChildResult result = run_cusp(words(path("run.h5"), {"--set", std::string("spacing=") + spacing}), path("log"));
    EXPECT_EQ(result.exit_code, 2) << spacing << ": " << result.errors;
    EXPECT_EQ(lines_of(result.errors), 1u) << result.errors;
    EXPECT_NE(result.errors.find("limits.particles"), std::string::npos) << result.errors;
    const std::size_t at = result.errors.find("a spacing of ");
    ASSERT_NE(at, std::string::npos) << result.errors;
    const std::string fits = std::to_string(std::stod(result.errors.substr(at + 13)));
    if (std::string(spacing) != "1e-5") continue;
    const ChildResult again = run_cusp({"explain", scene_, "--set", "limits.particles=20000", "--set", "spacing=0.002"}, path("log"));
    EXPECT_EQ(again.exit_code, 2);  // and what it names for a smaller limit does fit
    const std::size_t there = again.errors.find("a spacing of ");
    ASSERT_NE(there, std::string::npos) << again.errors;
    const std::string named = again.errors.substr(there + 13, again.errors.find(" would") - there - 13);
    EXPECT_EQ(run_cusp({"explain", scene_, "--set", "limits.particles=20000", "--set", "spacing=" + named}, path("log")).exit_code, 0)
        << named;
  }
  const std::string thin = write_scene(folder_, sheet_scene).string();
  const ChildResult result = run_cusp({"run", thin, "-o", path("thin.h5"), "--quiet", "--set", "spacing=1e-4"}, path("log"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find("would fit"), std::string::npos) << result.errors;
}

TEST_F(Faults, ABookOverItsLimitEndsWithOneAndSaysWhich) {
  const ChildResult result = run_cusp(words(path("run.h5"), {"--set", "limits.density_error=1e-9"}), path("log"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.errors.find("limits.density_error"), std::string::npos) << result.errors;
  const sim::RunReader reader(path("run.h5"));
  EXPECT_EQ(reader.status(), "finished");
  ASSERT_FALSE(reader.warnings().empty());
  EXPECT_NE(reader.warnings().back().find("ledger: rms error of the density"), std::string::npos);
}

// The same computation with one and with two threads, and again: sums are in a fixed order.
TEST(Threads, CoupledRunIsTheSameWithOneAndTwoThreadsAndRunToRun) {
  const fs::path folder = fresh_folder("threads");
  const std::string scene = write_scene(folder, valve_scene).string();
  const auto run = [&](const char* name, const char* threads) {
    const std::string file = (folder / name).string();
    const ChildResult result =
        run_cusp({"run", scene, "-o", file, "--quiet", "--threads", threads, "--set", "time.end=0.003"}, folder / "log");
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return sim::RunReader(file);
  };
  const sim::RunReader one = run("one.h5", "1"), again = run("again.h5", "1"), two = run("two.h5", "2");
  ASSERT_GT(one.frame_count(), 2u);
  ASSERT_EQ(one.frame_count(), two.frame_count());
  const sim::RunFrame a = one.frame(one.frame_count() - 1), b = again.frame(one.frame_count() - 1), c = two.frame(one.frame_count() - 1);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(one.series(), again.series());
  ASSERT_EQ(a.id, c.id);
  double farthest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t axis = 0; axis < 2; ++axis) farthest = std::max(farthest, std::abs(a.position[i][axis] - c.position[i][axis]));
  std::printf("farthest apart with one and two threads: %.3g m\n", farthest);
  EXPECT_LE(farthest, 1e-12);  // of 1 mm spacing
}

}  // namespace
