// The corpus and deterministic mutations of it through every reader of foreign bytes, each input in a child process so that a crash is
// counted, not suffered. Seconds here (CUSP_FUZZ_SECONDS a target, default 4); minutes with libFuzzer by the preset `fuzz`
// (tests/fuzz/README).
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "fuzz/targets.h"
#include "sim/run_file.h"

namespace {

using Input = std::vector<std::uint8_t>;

std::vector<Input> corpus(const std::string& target) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(CUSP_SOURCE_DIR) + "/tests/fuzz/corpus/" + target))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Input> inputs;
  for (const auto& file : files) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    const std::string bytes = text.str();
    inputs.emplace_back(bytes.begin(), bytes.end());
  }
  return inputs;
}

// A few of libFuzzer's mutations: flipped bits, interesting numbers, pieces cut, doubled, moved from another input.
Input mutated(const std::vector<Input>& from, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n ? std::uniform_int_distribution<std::size_t>(0, n - 1)(random) : 0; };
  Input input = from[below(from.size())];
  for (std::size_t times = 1 + below(6); times > 0; --times) {
    const std::size_t at = below(input.size() + 1);
    const std::size_t length = std::min(input.size() - at, std::size_t(1) << below(8));
    switch (below(6)) {
      case 0:
        if (at < input.size()) input[at] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      case 1: {
        static const char* const words[] = {
            "-1", "0", "1e999", "nan", "99999999999999999999", "inf", "[", "]", "\"", "\xff\xff\xff\xff", "{", "1e-320"};
        const std::string word = words[below(12)];
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), word.begin(), word.end());
        break;
      }
      case 2:
        input.erase(input.begin() + static_cast<std::ptrdiff_t>(at), input.begin() + static_cast<std::ptrdiff_t>(at + length));
        break;
      case 3: {
        const Input piece(input.begin() + static_cast<std::ptrdiff_t>(at), input.begin() + static_cast<std::ptrdiff_t>(at + length));
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(below(input.size() + 1)), piece.begin(), piece.end());
        break;
      }
      case 4: {
        const Input& other = from[below(from.size())];
        const std::size_t there = below(other.size() + 1), size = std::min(other.size() - there, std::size_t(64));
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), other.begin() + static_cast<std::ptrdiff_t>(there),
                     other.begin() + static_cast<std::ptrdiff_t>(there + size));
        break;
      }
      default:
        for (std::size_t k = at; k < at + std::min<std::size_t>(length, 8); ++k) input[k] = static_cast<std::uint8_t>(below(256));
    }
    if (input.size() > 200000) input.resize(200000);
  }
  return input;
}

// Runs a batch in one child; returns the first input that did not end in peace, or -1.
int first_casualty(void (*target)(fuzz::Bytes), const std::vector<Input>& batch) {
  int ends[2];
  if (pipe(ends) != 0) return 0;
  const pid_t child = fork();
  if (child == 0) {
    const rlimit memory{rlim_t(4) << 30, rlim_t(4) << 30}, core{0, 0}, time{20, 21};
#if !defined(__SANITIZE_ADDRESS__)
    setrlimit(RLIMIT_AS, &memory);
#else
    (void)memory;
#endif
    setrlimit(RLIMIT_CORE, &core);
    setrlimit(RLIMIT_CPU, &time);
    for (int k = 0; k < static_cast<int>(batch.size()); ++k) {
      if (write(ends[1], &k, sizeof k) != sizeof k) _exit(2);
      target(batch[static_cast<std::size_t>(k)]);
    }
    _exit(0);
  }
  close(ends[1]);
  int last = 0;
  for (int k = 0; read(ends[0], &k, sizeof k) == sizeof k;) last = k;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? -1 : last;
}

void replay(const char* name, void (*target)(fuzz::Bytes), std::vector<Input> from) {
  const char* wanted = std::getenv("CUSP_FUZZ_SECONDS");
  const double seconds = wanted ? std::atof(wanted) : 4;
  ASSERT_FALSE(from.empty());
  std::mt19937 random(20240601);
  std::size_t tried = 0, crashes = 0;
  std::vector<Input> batch = from;
  const auto start = std::chrono::steady_clock::now();
  do {
    const int casualty = first_casualty(target, batch);
    if (casualty >= 0) {
      ++crashes;
      const std::string file =
          std::string(testing::TempDir()) + "cusp_crash_" + name + "_" + std::to_string(tried + static_cast<std::size_t>(casualty));
      const Input& bytes = batch[static_cast<std::size_t>(casualty)];
      std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      ADD_FAILURE() << name << ": an input of " << bytes.size() << " bytes brings the reader down; it is kept as " << file;
    }
    tried += casualty >= 0 ? static_cast<std::size_t>(casualty) + 1 : batch.size();
    batch.clear();
    for (int k = 0; k < 200; ++k) batch.push_back(mutated(from, random));
  } while (crashes < 5 && std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds);
  std::printf("%s: %zu inputs tried, %zu crashes\n", name, tried, crashes);
}

TEST(Fuzz, MeshReadersFront) { replay("mesh", fuzz::mesh, corpus("mesh")); }
TEST(Fuzz, SceneParser) { replay("scene", fuzz::scene, corpus("scene")); }
TEST(Fuzz, WaveTables) { replay("wave", fuzz::wave, corpus("wave")); }

// A run file is made here: two frames, a line, a checkpoint.
TEST(Fuzz, RunFileReader) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / ("cusp_fuzz_seed_" + std::to_string(getpid()) + ".h5");
  {
    sim::RunHeader header;
    header.title = "seed", header.dimension = 2, header.spacing = 1, header.scheme = "accurate";
    header.bodies.push_back({"water", sim::Kind::fluid, 0, 3, 1000, 0, 0, 0, "newtonian"});
    header.columns = {"time", "x"}, header.units = {"s", "m"};
    header.lines.push_back({"line", "m", {{0, 0, 0}, {1, 0, 0}}, {"value"}});
    sim::RunWriter writer = sim::RunWriter::create(file, header);
    for (int k = 0; k < 2; ++k) {
      sim::RunFrame frame;
      frame.id = {0, 1, 2}, frame.kind = {3, 3, 3}, frame.body = {0, 0, 0};
      frame.position.resize(3), frame.velocity.resize(3), frame.pressure.resize(3), frame.stress.resize(3), frame.von_mises.resize(3);
      frame.principal_stress.resize(3);
      writer.add_frame(frame);
      writer.add_row({double(k), 1}, {{1, 2}});
    }
    sim::State<2> state;
    state.position.resize(3), state.velocity.resize(3), state.id = {0, 1, 2};
    writer.set_checkpoint(state, {2, 2, 1, 1});
    writer.finish();
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  const std::string bytes = text.str();
  std::vector<Input> from = corpus("run");
  from.emplace_back(bytes.begin(), bytes.end());
  std::filesystem::remove(file);
  replay("run", fuzz::run, std::move(from));
}

}  // namespace
