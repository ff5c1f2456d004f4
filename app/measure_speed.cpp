#include "app/measure_speed.h"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "app/assets.h"
#include "app/child_process.h"
#include "app/run_case.h"
#include "app/work_precision.h"
#include "sim/stage.h"
#include "sim/step.h"

namespace app {
namespace {

using nlohmann::json;

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }  // all threads

// The most memory this program has held, bytes.
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return 1024 * std::strtod(line.c_str() + 6, nullptr);
  return 0;
}

struct DensityError {
  double mean = 0, square = 0, count = 0;
  double compression = 0, all = 0;
};

// |n/n0 - 1| of fluid away from free surfaces and open ends; max(n/n0 - 1, 0) of all.
template <int D>
void add_density_error(const sim::Scene<D>& scene, const sim::State<D>& state, sim::Workspace<D>& scratch, DensityError& sum) {
  sim::find_neighborhood(scene, state, scratch);
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < state.size(); ++i) {
    if (state.kind[i] != sim::Kind::fluid) continue;
    sum.compression += std::max(scratch.number_density[i] - 1, 0.0), sum.all += 1;
    if (scratch.surface[i] != 0) continue;
    const double error = std::abs(scratch.number_density[i] - 1);
    sum.mean += error, sum.square += error * error, sum.count += 1;
  }
}

template <int D>
json timed_steps(const sim::Scene<D>& scene, const SpeedOptions& options) {
  sim::State<D> state = sim::initial_state(scene);
  if (!scene.pressure && scene.elastic_count + scene.shell_count == 0) throw SceneError("cusp bench: the scene has nothing that moves");
  sim::Workspace<D> work, scratch;
  const double end = options.until > 0 ? options.until : scene.description.time.end;
  DensityError density;
  std::vector<double> wall;
  double processor = 0, simulated = 0;
  std::int64_t iterations = 0;
  if (options.until == 0) sim::step(scene, state, work, end);  // makes the arrays
  work.stage_times.seconds.clear();
  const double first_time = state.time;
  const std::int64_t first_iterations = state.ledger.pressure_iterations;
  double next_look = first_time;
  while (options.until > 0 ? state.time < options.until * (1 - 1e-12) : static_cast<int>(wall.size()) < options.steps && state.time < end) {
    const double started = now_seconds(), used = processor_seconds();
    sim::step(scene, state, work, end - state.time);
    wall.push_back(now_seconds() - started), processor += processor_seconds() - used;
    if (scene.pressure && state.time >= next_look)
      add_density_error(scene, state, scratch, density), next_look += 0.05 * (end - first_time);
  }
  if (wall.empty()) throw SceneError("cusp bench: no step fits before time.end; make it later");
  simulated = state.time - first_time, iterations = state.ledger.pressure_iterations - first_iterations;
  const auto steps = static_cast<double>(wall.size()), particles = static_cast<double>(state.size());
  double whole = 0;
  for (double one : wall) whole += one;
  json result{{"particles", state.size()},
              {"fluid_particles", std::count(state.kind.begin(), state.kind.end(), sim::Kind::fluid)},
              {"threads", options.threads},
              {"steps", wall.size()},
              {"simulated", simulated},
              {"processor_seconds", processor},
              {"wall_seconds", whole},
              {"seconds_a_step", median(wall)},
              {"processor_seconds_a_step", processor / steps},
              {"microseconds_a_particle_and_step", 1e6 * processor / (steps * particles)},
              {"processor_seconds_a_simulated_second", processor / simulated},
              {"pressure_iterations", static_cast<double>(iterations) / steps},
              {"peak_memory", peak_memory()}};
  if (density.count > 0) {
    result["density_error_mean"] = density.mean / density.count, result["density_error_rms"] = std::sqrt(density.square / density.count);
    result["compression_mean"] = density.compression / density.all;
  }
  for (std::size_t k = 0; k < work.stage_times.seconds.size(); ++k)
    if (work.stage_times.seconds[k] > 0) result["stage_seconds"][sim::stage_names[k]] = work.stage_times.seconds[k];
  return result;
}

// What a command prints, run by a shell.
std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) throw std::runtime_error("can't start " + command);
  std::string text;
  char part[4096];
  for (std::size_t got; (got = std::fread(part, 1, sizeof part, pipe.get())) > 0;) text.append(part, got);
  return text;
}

std::string number(double value, int digits = 3) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace

nlohmann::json measure_speed(const SceneFile& file, const SpeedOptions& options) {
  if (file.time.mode == sim::TimeMode::static_equilibrium)
    throw SceneError(file.path.string() + ": a static scene has no steps to time; see cusp accuracy");
  omp_set_num_threads(options.threads);
  json result;
  with_scene(file, [&](auto&, const auto& scene) { result = timed_steps(scene, options); });
  result["title"] = file.title;
  return result;
}

double triad_bandwidth(int threads) {
  constexpr std::ptrdiff_t entries = 24'000'000;  // three arrays of 192 MB
  omp_set_num_threads(threads);
  const std::unique_ptr<double[]> a(new double[entries]), b(new double[entries]), c(new double[entries]);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < entries; ++i) a[i] = 0, b[i] = 1, c[i] = 2;
  double best = 1e300;
  for (int k = 0; k < 5; ++k) {
    const double started = now_seconds();
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t i = 0; i < entries; ++i) a[i] = b[i] + 3.0 * c[i];
    best = std::min(best, now_seconds() - started);
  }
  if (a[entries / 2] != 7) throw std::runtime_error("the triad computed nonsense");
  return 24.0 * static_cast<double>(entries) / best;
}

nlohmann::json measure_scaling(const std::vector<double>& sizes, const std::vector<int>& threads, int steps, bool quiet) {
  const std::string scene = asset("scenes/bench/resting_tank.toml").string();
  json all{{"rows", json::array()}, {"triad", json::array()}, {"fits", json::array()}};
  for (int count : threads) {
    all["triad"].push_back({{"threads", count}, {"bytes_a_second", triad_bandwidth(count)}});
    std::vector<double> particles, seconds, memory;
    for (double size : sizes) {
      // 1 m³ of water and walls three layers deep: particles = volume / h³ with the walls' volume in proportion to h.
      double spacing = std::cbrt(1 / size);
      for (int k = 0; k < 50; ++k) spacing = std::cbrt((1 + 3 * spacing * 6.4) / size);
      const std::string command = "'" + own_program() + "' bench '" + scene + "' --json --steps " + std::to_string(steps) + " --threads " +
                                  std::to_string(count) + " --set spacing=" + number(spacing, 8);
      const json row = json::parse(output_of(command), nullptr, false);
      if (!row.is_object()) throw std::runtime_error("this failed: " + command);
      if (!quiet)
        std::fprintf(stderr, "%.0f particles, %d threads: %.3g s a step\n", row["particles"].get<double>(), count,
                     row["seconds_a_step"].get<double>());
      particles.push_back(row["particles"]), seconds.push_back(row["processor_seconds_a_step"]), memory.push_back(row["peak_memory"]);
      all["rows"].push_back(row);
    }
    const auto time_fit = power_fit(particles, seconds), memory_fit = power_fit(particles, memory);
    if (time_fit && memory_fit)
      all["fits"].push_back({{"threads", count}, {"time_exponent", time_fit->exponent}, {"memory_exponent", memory_fit->exponent}});
  }
  return all;
}

std::string performance_text(const nlohmann::json& scaling, const std::vector<nlohmann::json>& scenes) {
  std::string md =
      "# Time and memory\n\nMade by `cusp bench --docs docs`. Processor times count all threads; wall times of a machine that does other "
      "things "
      "are upper bounds.\n\n## Against the number of particles\n\nWater at rest in an open tank, each row a process of its own; walls are "
      "counted.\n\n| particles | threads | processor time a step | wall time a step, median | microseconds a particle and step | pressure "
      "iterations a step | peak memory | bytes a particle |\n|---|---|---|---|---|---|---|---|\n";
  for (const json& row : scaling["rows"])
    md += "| " + number(row["particles"], 8) + " | " + number(row["threads"]) + " | " + number(row["processor_seconds_a_step"]) + " s | " +
          number(row["seconds_a_step"]) + " s | " + number(row["microseconds_a_particle_and_step"]) + " | " +
          number(row["pressure_iterations"]) + " | " + number(row["peak_memory"].get<double>() / 1048576) + " MiB | " +
          number(row["peak_memory"].get<double>() / row["particles"].get<double>()) + " |\n";
  md += "\n";
  for (const json& fit : scaling["fits"])
    md += "Fitted, " + number(fit["threads"]) + (fit["threads"] == 1 ? " thread" : " threads") + ": processor time of a step grows as N^" +
          number(fit["time_exponent"]) + ", memory as N^" + number(fit["memory_exponent"]) + ".\n";
  for (const json& triad : scaling["triad"])
    md += "Memory bandwidth of this machine (STREAM triad), " + number(triad["threads"]) +
          (triad["threads"] == 1 ? " thread: " : " threads: ") + number(triad["bytes_a_second"].get<double>() / 1e9) + " GB/s.\n";
  if (!scaling["rows"].empty()) {
    const json& last = scaling["rows"].back();
    md += "\n## Where a step's time goes\n\n" + number(last["particles"], 8) + " particles, " + number(last["threads"]) +
          " threads.\n\n| stage | share |\n|---|---|\n";
    double sum = 0;
    for (const auto& [stage, seconds] : last["stage_seconds"].items()) sum += seconds.get<double>();
    for (const auto& [stage, seconds] : last["stage_seconds"].items())
      md += "| " + stage + " | " + number(100 * seconds.get<double>() / sum) + " % |\n";
  }
  if (!scenes.empty())
    md +=
        "\n## Scenes that other codes can be timed on\n\n| scene | fluid particles | threads | simulated | steps | processor seconds a "
        "simulated "
        "second | density error, mean | rms | pressure iterations a step |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const json& one : scenes)
    md += "| " + one["title"].get<std::string>() + " | " + number(one["fluid_particles"], 8) + " | " + number(one["threads"]) + " | " +
          number(one["simulated"]) + " s | " + number(one["steps"], 8) + " | " + number(one["processor_seconds_a_simulated_second"]) +
          " | " + number(100 * one.value("density_error_mean", 0.0)) + " % | " + number(100 * one.value("density_error_rms", 0.0)) +
          " % | " + number(one["pressure_iterations"]) + " |\n";
  return md;
}

}  // namespace app
