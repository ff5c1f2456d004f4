// The stages of a step on the clock, at several sizes and thread counts: `ninja bench_stages` in the build folder where Google Benchmark is
// installed, then ./bench_stages --benchmark_filter=whole_step/127000
#include <benchmark/benchmark.h>
#include <omp.h>

#include <cmath>
#include <map>
#include <memory>

#include "app/assets.h"
#include "app/measure_speed.h"
#include "app/run_case.h"
#include "sim/number_density.h"
#include "sim/operators.h"
#include "sim/pressure.h"
#include "sim/step.h"
#include "sim/viscosity.h"

namespace {

// Water at rest of about `particles` rows, walls included, after two steps: every array made, the flow settled into its numbers.
struct Tank {
  sim::Scene<3> scene;
  sim::State<3> state;
  sim::Workspace<3> work;
  double dt = 0;
};

Tank& tank_of(std::int64_t particles) {
  static std::map<std::int64_t, std::unique_ptr<Tank>> tanks;
  std::unique_ptr<Tank>& tank = tanks[particles];
  if (tank) return *tank;
  tanks.clear();  // one at a time: memory
  double spacing = std::cbrt(1.0 / static_cast<double>(particles));
  for (int k = 0; k < 50; ++k) spacing = std::cbrt((1 + 19.2 * spacing) / static_cast<double>(particles));
  const app::SceneFile file = app::read_scene_file(app::asset("scenes/bench/resting_tank.toml"), {"spacing=" + std::to_string(spacing)});
  auto made = std::make_unique<Tank>();
  made->scene = sim::make_scene(app::build_case<3>(file, *app::place_case(file)).description);
  made->state = sim::initial_state(made->scene);
  for (int k = 0; k < 2; ++k) sim::step(made->scene, made->state, made->work, 1.0);
  made->dt = made->state.last_step;
  sim::find_neighborhood(made->scene, made->state, made->work);
  return *(tanks[particles] = std::move(made));
}

void count(benchmark::State& bench, const Tank& tank) {
  const auto rows = static_cast<double>(tank.state.size());
  bench.counters["particles"] = rows;
  bench.counters["ns_per_particle"] =
      benchmark::Counter(rows * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Runs `stage(tank)` on the clock with the case's size and threads.
template <class Stage>
void timed_stage(benchmark::State& bench, Stage&& stage) {
  omp_set_num_threads(static_cast<int>(bench.range(1)));
  Tank& tank = tank_of(bench.range(0));
  for (auto _ : bench) stage(tank);
  count(bench, tank);
}

void neighbours_and_density(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) { sim::find_neighborhood(t.scene, t.state, t.work); });
}
void density(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) { sim::particle_number_density(t.scene, t.state, t.work); });
}
void operators(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) { sim::velocity_gradients(t.scene, t.state, t.work); });
}
void viscosity(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) {
    sim::particle_viscosity(t.scene, t.state, t.work);
    if (t.scene.viscosity->corrected) sim::add_laplacian_correction(t.scene, t.state, t.work);
    t.work.boundary_force.clear();
    sim::solve_viscosity<3>(t.scene, t.state, t.work, t.dt, t.work.boundary_force);
  });
}
void pressure_assembly(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) {
    sim::number_unknowns(t.scene, t.state, t.work);
    sim::pressure_poisson(t.scene, t.state, t.work, t.dt);
  });
}

template <class T>
double bytes_of(const std::vector<T>& array) {
  return static_cast<double>(array.size() * sizeof(T));
}

// Bytes that one iteration has to move: the matrix and nine vectors of the conjugate gradients once, each multigrid level's matrix three
// times (a sweep down, a residual, a sweep up) with its vectors.
double bytes_an_iteration(const sim::Workspace<3>& work) {
  double bytes = bytes_of(work.matrix.value) + bytes_of(work.matrix.column) + bytes_of(work.matrix.start) + bytes_of(work.matrix.diagonal) +
                 9 * 8.0 * static_cast<double>(work.matrix.rows());
  for (const sim::MultigridLevel& level : work.multigrid.levels)
    bytes += 3 * (bytes_of(level.value) + bytes_of(level.column) + bytes_of(level.start) + bytes_of(level.inverse_diagonal)) +
             3 * (bytes_of(level.x) + bytes_of(level.b) + bytes_of(level.r));
  return bytes + bytes_of(work.multigrid.coarse_inverse);
}

// From a guess of zero, with its multigrid set-up; `times_bound`: measured over what its iterations must at least move through memory.
void pressure_solve(benchmark::State& bench) {
  const int threads = static_cast<int>(bench.range(1));
  const double bandwidth = app::triad_bandwidth(threads);
  Tank& tank = tank_of(bench.range(0));
  sim::number_unknowns(tank.scene, tank.state, tank.work);
  sim::pressure_poisson(tank.scene, tank.state, tank.work, tank.dt);
  omp_set_num_threads(threads);
  double iterations = 0, solves = 0;
  const std::vector<double> pressure = tank.state.pressure;
  tank.work.stage_times.seconds.clear();
  for (auto _ : bench) {
    tank.state.pressure.assign(pressure.size(), 0.0);
    iterations += sim::solve_pressure(tank.scene, tank.state, tank.work).iterations, solves += 1;
  }
  tank.state.pressure = pressure;
  count(bench, tank);
  const double solve_seconds = tank.work.stage_times.seconds[static_cast<std::size_t>(sim::Stage::pressure_solve)];
  bench.counters["unknowns"] = static_cast<double>(tank.work.matrix.rows());
  bench.counters["iterations"] = iterations / solves;
  bench.counters["triad_GB_per_s"] = bandwidth / 1e9;
  bench.counters["times_bound"] = solve_seconds / (iterations * bytes_an_iteration(tank.work) / bandwidth);
}

void whole_step(benchmark::State& bench) {
  timed_stage(bench, [](Tank& t) { sim::step(t.scene, t.state, t.work, 1.0); });
}

// Forces of a neo-Hookean block, bent a little so that nothing is zero.
void elastic_force(benchmark::State& bench) {
  omp_set_num_threads(static_cast<int>(bench.range(1)));
  const double spacing = std::cbrt(1.0 / static_cast<double>(bench.range(0)));
  const std::string text =
      "dimension = 3\n[time]\nend = 1\n[[body]]\nname = \"block\"\nkind = \"elastic\"\nshape = { type = \"box\", min = [0, 0, 0], max = "
      "[1, 1, 1] }\n"
      "material = { density = 1000, law = \"neo-hookean\", youngs_modulus = 1e6, poisson_ratio = 0.45 }\n"
      "fixed = [ { type = \"box\", min = [0, 0, 0], max = [0, 1, 1] } ]\n";
  const app::SceneFile file = app::parse_scene_text("spacing = " + std::to_string(spacing) + "\n" + text, "block.toml");
  const sim::SolidElasticity<3> solid = sim::build_solids(app::build_case<3>(file).description);
  std::vector<sim::Vector<3>> position = solid.rest, force(solid.size());
  for (auto& x : position) x.y() += 0.01 * x.x() * x.x();
  sim::SolidWork<3> work;
  for (auto _ : bench) sim::solid_forces<3>(solid, position, work, force);
  const auto rows = static_cast<double>(solid.size());
  bench.counters["particles"] = rows;
  bench.counters["ns_per_particle"] =
      benchmark::Counter(rows * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void memory_triad(benchmark::State& bench) {
  double bandwidth = 0;
  for (auto _ : bench) bandwidth = app::triad_bandwidth(static_cast<int>(bench.range(1)));
  bench.counters["GB_per_s"] = bandwidth / 1e9;
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime()->MinTime(0.5);
  for (std::int64_t particles : {20'000, 127'000, 500'000})
    for (std::int64_t threads : {1, 2}) bench->Args({particles, threads});
}
BENCHMARK(memory_triad)->Args({0, 1})->Args({0, 2})->Iterations(1);
BENCHMARK(neighbours_and_density)->Apply(sizes);
BENCHMARK(density)->Apply(sizes);
BENCHMARK(operators)->Apply(sizes);
BENCHMARK(viscosity)->Apply(sizes);
BENCHMARK(pressure_assembly)->Apply(sizes);
BENCHMARK(pressure_solve)->Apply(sizes);
BENCHMARK(elastic_force)->Apply(sizes);
BENCHMARK(whole_step)->Apply(sizes);

}  // namespace

BENCHMARK_MAIN();
