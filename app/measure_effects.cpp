#include "app/measure_effects.h"

#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "app/assets.h"
#include "app/explain.h"
#include "app/run_case.h"
#include "app/scene_table.h"
#include "sim/step.h"

namespace app {
namespace {

using nlohmann::json;

struct Variant {
  std::vector<std::string> stages;
  std::int64_t bytes = 0;
  double seconds_a_step = 0;
  std::vector<double> position, velocity;  // of all particles, one after the other
  double spacing = 1;
};

template <class Array>
std::int64_t bytes_of(const Array& array) {
  return static_cast<std::int64_t>(array.size() * sizeof(array[0]));
}
template <class... Arrays>
std::int64_t bytes_of_all(const Arrays&... arrays) {
  return (bytes_of(arrays) + ... + 0);
}

// Arrays that live between the stages of a step.
template <int D>
std::int64_t scratch_bytes(const sim::Workspace<D>& w) {
  return bytes_of_all(w.neighbors.start, w.neighbors.index, w.search, w.is_fluid, w.link_weight, w.boundary_normal, w.boundary_velocity,
                      w.number_density, w.surface, w.surface_outward, w.velocity_inverse, w.pressure_inverse, w.velocity_gradient,
                      w.viscosity, w.pair_viscosity, w.boundary_curvature, w.grip, w.acceleration, w.pressure_gradient, w.displacement,
                      w.velocity_old, w.unknown, w.unknown_row, w.matrix.diagonal, w.matrix.start, w.matrix.column, w.matrix.value,
                      w.source, w.solution, w.viscous_matrix.diagonal, w.viscous_matrix.start, w.viscous_matrix.column,
                      w.viscous_matrix.value, w.viscous_source, w.viscous_solution, w.solid_position, w.solid_velocity, w.solid_link_start,
                      w.solid_links, w.near_sheet, w.wet_start, w.wetting, w.wet_unknown, w.wet_unknown_start, w.wet_faces, w.support,
                      w.wet_share, w.coupling, w.side_memory, w.shell_position, w.shell_velocity, w.shell_normal, w.shell_mean_force,
                      w.shell_outer_force, w.shell_free_velocity, w.shell_area, w.shell_normal_mass, w.boundary_force);
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Variant run_variant(const std::string& text, const std::vector<std::string>& settings, int steps) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("cusp_effect_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << text;
  const SceneFile scene_file = read_scene_file(file, settings);
  std::filesystem::remove(file);
  Variant variant;
  variant.spacing = scene_file.spacing;
  with_scene(scene_file, [&](auto&, const auto& scene) {
    using SceneType = std::decay_t<decltype(scene)>;
    constexpr int D = std::is_same_v<SceneType, sim::Scene<2>> ? 2 : 3;
    for (const StageLine& line : stages_of(scene_file, scene.shell_count > 0, scene.elastic_count > 0))
      if (!line.because.empty()) variant.stages.push_back(line.stage);
    sim::State<D> state = sim::initial_state(scene);
    sim::Workspace<D> work;
    sim::step(scene, state, work, scene_file.time.end);  // allocates
    const double start = processor_seconds();
    for (int k = 1; k < steps; ++k) sim::step(scene, state, work, scene_file.time.end);
    variant.seconds_a_step = (processor_seconds() - start) / (steps - 1);
    sim::for_each_array(state, [&](const char*, auto& array) { variant.bytes += bytes_of(array); });
    variant.bytes += scratch_bytes(work);
    for (std::size_t i = 0; i < state.size(); ++i)
      for (int k = 0; k < D; ++k) variant.position.push_back(state.position[i][k]), variant.velocity.push_back(state.velocity[i][k]);
  });
  return variant;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return 1e300;
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

double largest(const std::vector<double>& a) {
  double most = 1e-300;
  for (double value : a) most = std::max(most, std::abs(value));
  return most;
}

json measured(const toml::table& scenes, const TableReader& effect, int steps) {
  const std::string scene = effect.text("scene"), add = effect.text("add", ""), zero_add = effect.text("zero_add", "");
  const auto texts = [&](const char* key) { return effect.has(key) ? effect.texts(key) : std::vector<std::string>{}; };
  const std::string base = scenes["scene"][scene].value_or(std::string());
  const Variant without = run_variant(base, texts("without"), steps);
  const Variant with = run_variant(base + add + "\n", texts("set"), steps);
  json row{{"effect", effect.text("name")},
           {"bytes_without", without.bytes},
           {"bytes_with", with.bytes},
           {"seconds_a_step_without", without.seconds_a_step},
           {"seconds_a_step_with", with.seconds_a_step},
           {"stages_gained", json::array()}};
  for (const std::string& stage : with.stages)
    if (std::find(without.stages.begin(), without.stages.end(), stage) == without.stages.end()) row["stages_gained"].push_back(stage);
  if (effect.has("zero_set") || !zero_add.empty()) {
    const Variant zero = run_variant(base + zero_add + "\n", texts("zero_set"), steps);
    row["zero_strength_position"] = largest_difference(zero.position, without.position) / without.spacing;
    row["zero_strength_velocity"] = largest_difference(zero.velocity, without.velocity) / largest(without.velocity);
  }
  return row;
}

}  // namespace

nlohmann::json measure_effects(int steps) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // processor time, not threads, is what a stage costs
  const toml::table table = toml::parse_file(asset("scenes/effects/effects.toml").string());
  const TableReader top(table, "", {"scene", "effect"});
  json rows = json::array();
  for (const toml::table* entry : top.tables("effect"))
    rows.push_back(
        measured(table, TableReader(*entry, "effect", {"name", "scene", "without", "set", "add", "zero_set", "zero_add"}), steps));
  omp_set_num_threads(threads);
  return {{"effects", rows}, {"steps", steps}};
}

}  // namespace app
