// Run files: everything comes back as it was written; a kill at any moment leaves a file with every finished frame.
#include "sim/run_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "sim/hdf5_io.h"
#include "sim/journal_file.h"

namespace {

namespace fs = std::filesystem;

fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("cusp_" + name + "_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

sim::RunHeader example_header() {
  sim::RunHeader header;
  header.program_version = "1.2", header.title = "A test", header.scene_name = "a.toml", header.scene_text = "spacing = 1\n# ü\n";
  header.settings = {"spacing=2"};
  header.scheme = "accurate", header.dimension = 2, header.spacing = 0.5, header.end = 3, header.output = 1;
  header.bodies.push_back({"water", sim::Kind::fluid, 0, 2, 1000, 0, 0, 0, "newtonian"});
  header.bodies.push_back({"leaf", sim::Kind::shell, 2, 1, 1100, 1e6, 0.45, 5e-4, "neo-hookean"});
  header.shells.push_back({1, {{0, 1, -1}}});
  header.ports = {"inlet"};
  header.lumen.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  header.lumen.triangles = {{0, 1, 2}};
  header.columns = {"time", "p.x", "p.y"}, header.units = {"s", "m", "m"};
  header.lines.push_back({"profile", "m/s", {{0, 0, 0}, {1, 0, 0}}, {"value.x", "value.y"}});
  return header;
}

sim::RunFrame example_frame(std::size_t rows, double time) {
  sim::RunFrame frame;
  frame.time = time, frame.step = static_cast<std::int64_t>(10 * time);
  for (std::size_t i = 0; i < rows; ++i) {
    const double v = static_cast<double>(i) + 0.1 * time;
    frame.id.push_back(static_cast<std::int64_t>(i) + 1000000000000);
    frame.kind.push_back(3), frame.body.push_back(0);
    frame.position.push_back({v, 2 * v, 0}), frame.velocity.push_back({float(v), 0, 1}), frame.pressure.push_back(float(3 * v));
    frame.stress.push_back({1, 2, 3, 4, 5, float(v)}), frame.von_mises.push_back(float(v)), frame.principal_stress.push_back(-float(v));
  }
  return frame;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

sim::State<2> example_state() {
  sim::State<2> state;
  state.time = 0.1 + 0.2, state.last_step = 1e-17, state.step = 7, state.next_id = 12;
  state.id = {4, 5}, state.kind = {sim::Kind::fluid, sim::Kind::port}, state.body = {0, 0}, state.port = {-1, 0};
  state.position = {{1.0 / 3, 2}, {3, 4}}, state.velocity = {{5, 6}, {-0.0, 1e-310}}, state.pressure = {0.1, 0.7};
  state.port_memory = {1e5};
  state.ledger.penetrations = 3, state.ledger.kinetic_energy = 1.0 / 7;
  return state;
}

TEST(RunFile, GivesBackHeaderFramesSeriesAndLines) {
  const fs::path file = fresh_folder("run_file") / "run.h5";
  {
    sim::RunWriter writer = sim::RunWriter::create(file, example_header());
    for (int k = 0; k < 3; ++k) {
      writer.add_row({double(k), 0.25 * k, -1.0}, {{1.0 * k, 2, 3, 4}});
      writer.add_frame(example_frame(300 + static_cast<std::size_t>(k), k));
      writer.finish();
    }
    writer.add_warning("thin");
    writer.set_status("finished", 12.5, 30);
    writer.finish();
  }
  const sim::RunReader reader(file);
  EXPECT_EQ(reader.header().scene_text, example_header().scene_text);
  EXPECT_EQ(reader.header().settings, example_header().settings);
  EXPECT_EQ(reader.header().bodies[1].name, "leaf");
  EXPECT_EQ(reader.header().bodies[1].thickness, 5e-4);
  EXPECT_EQ(reader.header().shells[0].elements[0][1], 1);
  EXPECT_EQ(reader.header().lumen.triangles.size(), 1u);
  EXPECT_EQ(reader.header().columns, example_header().columns);
  ASSERT_EQ(reader.frame_count(), 3u);
  EXPECT_EQ(reader.frame_time(2), 2);
  const sim::RunFrame frame = reader.frame(1), expected = example_frame(301, 1);
  EXPECT_EQ(frame.position, expected.position);
  EXPECT_EQ(frame.velocity, expected.velocity);
  EXPECT_EQ(frame.stress, expected.stress);
  EXPECT_EQ(frame.id, expected.id);
  EXPECT_EQ(reader.column("p.x"), (std::vector<double>{0, 0.25, 0.5}));
  EXPECT_EQ(reader.line("profile")[2], (std::vector<double>{2, 2, 3, 4}));
  EXPECT_EQ(reader.status(), "finished");
  EXPECT_EQ(reader.wall_seconds(), 12.5);
  EXPECT_EQ(reader.warnings(), std::vector<std::string>{"thin"});
  EXPECT_FALSE(fs::exists(file.string() + ".journal"));
}

TEST(RunFile, WritesCsvAndXdmfBeside) {
  const fs::path file = fresh_folder("run_csv") / "run.h5";
  sim::RunWriter writer = sim::RunWriter::create(file, example_header());
  writer.add_row({0, 0.5, 1.0 / 3}, {{1, 2, 3, 4}});
  writer.add_frame(example_frame(5, 0));
  writer.finish();
  fs::path beside = file;
  EXPECT_EQ(text_of(beside.replace_extension(".csv")), "time,p.x,p.y\n0,0.5,0.3333333333\n");
  EXPECT_EQ(text_of(beside.replace_extension(".profile.csv")), "time,x,y,z,value.x,value.y\n0,0,0,0,1,2\n0,1,0,0,3,4\n");
  const std::string xdmf = text_of(beside.parent_path() / "run.xmf");
  EXPECT_NE(xdmf.find("<Time Value=\"0\"/>"), std::string::npos);
  EXPECT_NE(xdmf.find("run.h5:/frames/000000/position"), std::string::npos);
  EXPECT_NE(xdmf.find("Name=\"von_mises_stress\""), std::string::npos);
  EXPECT_EQ(xdmf.substr(xdmf.size() - 8), "</Xdmf>\n");
}

TEST(RunFile, CheckpointIsExactToTheLastBit) {
  const fs::path file = fresh_folder("checkpoint") / "run.h5";
  const sim::State<2> state = example_state();
  {
    sim::RunWriter writer = sim::RunWriter::create(file, example_header());
    writer.set_checkpoint(example_state(), {0, 0, 1, 2});
    writer.finish();
    writer.set_checkpoint(state, {1, 2, 3.5, 0.25});  // replaced by one of another size
    writer.finish();
  }
  const sim::RunReader reader(file);
  ASSERT_TRUE(reader.has_checkpoint());
  const auto [back, book] = reader.checkpoint<2>();
  EXPECT_EQ(back.time, state.time);
  EXPECT_EQ(back.last_step, state.last_step);
  EXPECT_EQ(back.next_id, state.next_id);
  EXPECT_EQ(back.position, state.position);
  EXPECT_EQ(back.velocity, state.velocity);
  EXPECT_TRUE(std::signbit(back.velocity[1].x()));
  EXPECT_EQ(back.kind, state.kind);
  EXPECT_EQ(back.port, state.port);
  EXPECT_EQ(back.port_memory, state.port_memory);
  EXPECT_EQ(back.ledger.penetrations, 3);
  EXPECT_EQ(back.ledger.kinetic_energy, state.ledger.kinetic_energy);
  EXPECT_EQ(book.frames, 1);
  EXPECT_EQ(book.next_output, 0.25);
  EXPECT_THROW(reader.checkpoint<3>(), std::runtime_error);
}

TEST(RunFile, ResumeDropsWhatCameAfterTheCheckpoint) {
  const fs::path file = fresh_folder("resume") / "run.h5";
  {
    sim::RunWriter writer = sim::RunWriter::create(file, example_header());
    for (int k = 0; k < 4; ++k) {
      writer.add_row({double(k), 1, 1}, {{1, 2, 3, 4}});
      writer.add_frame(example_frame(4, k));
      if (k == 1) writer.set_checkpoint(example_state(), {2, 2, 1, 2});
      writer.finish();
    }
  }
  {
    sim::RunWriter writer = sim::RunWriter::resume(file, {2, 2, 1, 2});
    writer.add_row({20, 1, 1}, {{1, 2, 3, 4}});
    writer.add_frame(example_frame(4, 20));
    writer.finish();
  }
  const sim::RunReader reader(file);
  ASSERT_EQ(reader.frame_count(), 3u);
  EXPECT_EQ(reader.frame_time(2), 20);
  EXPECT_EQ(reader.column("time"), (std::vector<double>{0, 1, 20}));
  fs::path beside = file;
  EXPECT_EQ(text_of(beside.replace_extension(".csv")), "time,p.x,p.y\n0,1,1\n1,1,1\n20,1,1\n");
  std::size_t grids = 0;
  const std::string xdmf = text_of(beside.replace_extension(".xmf"));
  for (std::size_t at = xdmf.find("<Time"); at != std::string::npos; at = xdmf.find("<Time", at + 1)) ++grids;
  EXPECT_EQ(grids, 3u);
}

// A child writes frames and says after each which it finished; it is killed without warning at many different moments.
TEST(RunFile, KillAtAnyMomentKeepsEveryFinishedFrame) {
  const fs::path folder = fresh_folder("kill");
  int torn_journals = 0;
  for (int trial = 0; trial < 25; ++trial) {
    const fs::path file = folder / ("run" + std::to_string(trial) + ".h5");
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      sim::RunWriter writer = sim::RunWriter::create(file, example_header());
      for (int k = 0; k < 100000; ++k) {
        writer.add_row({double(k), 1, 1}, {{1, 2, 3, 4}});
        writer.add_frame(example_frame(400, k));
        writer.set_checkpoint(example_state(), {k + 1, k + 1, 1, 2});
        writer.finish();
        if (write(pipe_ends[1], &k, sizeof k) != sizeof k) _exit(1);
      }
      _exit(0);
    }
    close(pipe_ends[1]);
    int finished = -1;
    for (int k = 0; k <= trial % 7 && read(pipe_ends[0], &finished, sizeof finished) == sizeof finished; ++k) {
    }
    usleep(static_cast<useconds_t>(137 * trial));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    for (int k = 0; read(pipe_ends[0], &k, sizeof k) == sizeof k;) finished = k;
    close(pipe_ends[0]);
    torn_journals += fs::exists(file.string() + ".journal") && fs::file_size(file.string() + ".journal") > 0;
    const sim::RunReader reader(file);
    ASSERT_GE(reader.frame_count(), static_cast<std::size_t>(finished) + 1) << "trial " << trial;
    for (std::size_t k = 0; k < reader.frame_count(); ++k) ASSERT_EQ(reader.frame(k).position, example_frame(400, double(k)).position);
    EXPECT_EQ(reader.series().size(), reader.frame_count());
    EXPECT_EQ(reader.checkpoint<2>().second.frames, static_cast<std::int64_t>(reader.frame_count()));
  }
  RecordProperty("torn_journals", torn_journals);
}

TEST(RunFile, RefusesWhatIsNoRun) {
  const fs::path folder = fresh_folder("no_run");
  std::ofstream(folder / "text.h5") << "not HDF5";
  EXPECT_THROW(sim::RunReader(folder / "text.h5"), std::runtime_error);
  EXPECT_THROW(sim::RunReader(folder / "none.h5"), std::runtime_error);
  { sim::h5::Handle other(H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose, "other"); }
  EXPECT_THROW(sim::RunReader(folder / "other.h5"), std::runtime_error);
}

// The driver alone: between two flushes the bytes on disk before the last finished end do not change.
TEST(JournalFile, ChangesTheFinishedPartOnlyWhenFlushed) {
  const fs::path file = fresh_folder("journal") / "data.h5";
  sim::h5::Handle access(sim::journal_access(), H5Pclose, "access");
  sim::h5::Handle opened(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "file");
  sim::h5::write_array(opened, "a", std::vector<double>(1000, 1.0), 1, "", false);
  H5Fflush(opened, H5F_SCOPE_GLOBAL);
  const std::string before = text_of(file);
  sim::h5::write_array(opened, "a", std::vector<double>(1000, 2.0), 1, "", false);
  sim::h5::write_array(opened, "b", std::vector<double>(5000, 3.0), 1, "", false);
  EXPECT_EQ(text_of(file).substr(0, before.size()), before);
  EXPECT_EQ(sim::h5::read_array<double>(opened, "a")[7], 2.0);  // but the writer sees its own changes
  H5Fflush(opened, H5F_SCOPE_GLOBAL);
  EXPECT_NE(text_of(file).substr(0, before.size()), before);
  EXPECT_TRUE(sim::recover_journal(file));  // a live writer is left alone
}

}  // namespace
