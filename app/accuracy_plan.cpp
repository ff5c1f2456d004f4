#include "app/accuracy_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

namespace app {
namespace {

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

void add_extents(const ShapeSpec& shape, int dimension, std::vector<double>& extents) {
  if (shape.type == ShapeType::box)
    for (int axis = 0; axis < dimension; ++axis) extents.push_back(shape.max[axis] - shape.min[axis]);
  if (shape.type == ShapeType::sphere) extents.push_back(2 * shape.radius);
  if (shape.type == ShapeType::cylinder) extents.push_back(shape.inner_radius > 0 ? shape.radius - shape.inner_radius : 2 * shape.radius);
}

// Smallest extent of a body that holds several particles across; 0 where the scene has none.
double smallest_extent(const SceneFile& scene) {
  std::vector<double> extents;
  for (const BodySpec& body : scene.bodies)
    if (body.kind != sim::Kind::wall) add_extents(body.shape, scene.dimension, extents);
  double smallest = 0;
  for (double extent : extents)
    if (extent >= 1.5 * scene.spacing && (smallest == 0 || extent < smallest)) smallest = extent;
  return smallest;
}

bool is_sheet(const BodySpec& body, const SceneFile& scene) {
  if (body.kind != sim::Kind::elastic) return false;
  if (body.shape.type == ShapeType::shell || (body.shape.type == ShapeType::patient && body.shape.part == "leaflets")) return true;
  if (body.shape.type != ShapeType::box) return false;
  int thin = 0;
  for (int axis = 0; axis < scene.dimension; ++axis) thin += body.shape.max[axis] - body.shape.min[axis] < 1.5 * scene.spacing;
  return thin == 1;
}

struct Knob {
  std::string key;
  std::vector<double> values;
  double cost_of_step = 0;  // cost grows as value^-this
};

std::vector<Knob> knobs_of(const SceneFile& scene, double spacing) {
  bool fluid = false, sheets = false, solids = false;
  for (const BodySpec& body : scene.bodies) {
    fluid = fluid || body.kind == sim::Kind::fluid;
    sheets = sheets || is_sheet(body, scene);
    solids = solids || (body.kind == sim::Kind::elastic && !is_sheet(body, scene));
  }
  const bool statics = scene.time.mode == sim::TimeMode::static_equilibrium;
  const sim::SchemeSettings& scheme = scene.scheme;
  std::vector<Knob> knobs;
  if (!statics && scene.time.step > 0) {
    knobs.push_back({"time.step", {2 * scene.time.step, 0.5 * scene.time.step}, 1});
  } else if (!statics && fluid && sheets) {
    const double step = scheme.maximum_step > 0 ? scheme.maximum_step : 0.1 * spacing;
    knobs.push_back({"scheme.maximum_step", {2 * step, 0.5 * step}, 1});
  } else if (!statics && fluid) {
    knobs.push_back({"scheme.cfl", {2 * scheme.cfl, 0.5 * scheme.cfl}, 1});
  } else if (!statics) {
    knobs.push_back({"scheme.elastic_substep", {0.5, 0.5 * scheme.elastic_substep}, 1});
  }
  if (fluid && !statics) {
    const double radius = scheme.kernel_radius > 0 ? scheme.kernel_radius : scene.dimension == 2 && !sheets ? 3.1 : 2.1;
    Knob kernel{"scheme.kernel_radius", {}, scene.dimension == 2 ? -2.0 : -3.0};
    for (double value : {2.1, 2.6, 3.1, 4.1})
      if (std::abs(value - radius) > 0.05) kernel.values.push_back(value);
    knobs.push_back(kernel);
    knobs.push_back({"scheme.pressure_tolerance", {1e-2, 1e-3, 1e-7}, 0.1});
  }
  if (solids) {
    Knob kernel{"scheme.elastic_kernel_radius", {}, -static_cast<double>(scene.dimension)};
    for (double value : {2.1, 2.6, 3.1})
      if (std::abs(value - scheme.elastic_kernel_radius) > 0.05) kernel.values.push_back(value);
    knobs.push_back(kernel);
    knobs.push_back({"scheme.elastic_tolerance", {1e-3, 1e-5}, 0.1});
  }
  if (scheme.name == sim::Scheme::paper) knobs.push_back({"scheme.outer_iterations", {1, 10, 1000}, 0});
  return knobs;
}

PlannedRun run_at(double spacing) {
  PlannedRun run;
  run.spacing = spacing, run.settings = {spacing_setting(spacing)};
  return run;
}

bool same_spacing(double a, double b) { return std::abs(a - b) <= 1e-9 * b; }

}  // namespace

std::string spacing_setting(double spacing) { return "spacing=" + number(spacing); }

double fitting_spacing(const SceneFile& scene, double wanted, bool coarser) {
  const double extent = smallest_extent(scene);
  if (extent == 0 || extent < 1.5 * wanted) return wanted;
  const double count = coarser ? std::floor(extent / wanted * (1 + 1e-9)) : std::ceil(extent / wanted * (1 - 1e-9));
  return extent / count;
}

LadderPlan spacing_ladder(const SceneFile& scene, const std::vector<std::string>& settings, std::size_t most) {
  LadderPlan plan;
  for (int power = 2; power >= -4 && plan.spacings.size() < most; --power) {
    const double wanted = scene.spacing * std::pow(2.0, 0.5 * power);
    const double spacing = power == 0 ? scene.spacing : fitting_spacing(scene, wanted);
    if (!plan.spacings.empty() && spacing > 0.95 * plan.spacings.back()) continue;
    std::vector<std::string> all = settings;
    all.push_back(spacing_setting(spacing));
    try {
      read_scene_file(scene.path, all);
      plan.spacings.push_back(spacing);
    } catch (const SceneError& error) {
      plan.left_out.push_back(spacing_setting(spacing) + ": " + error.what());
    }
  }
  return plan;
}

std::vector<PlannedRun> ladder_runs(const SceneFile& scene, const std::vector<double>& spacings, int repeats) {
  std::vector<PlannedRun> runs;
  for (int repeat = 0; repeat < repeats; ++repeat)
    for (double spacing : spacings) {
      PlannedRun run = run_at(spacing);
      run.curve = "spacing", run.value = number(spacing), run.repeat = repeat, run.scene_itself = same_spacing(spacing, scene.spacing);
      runs.push_back(std::move(run));
    }
  return runs;
}

std::vector<PlannedRun> jitter_runs(const SceneFile& scene, double spacing, int seeds) {
  std::vector<PlannedRun> runs;
  if (scene.start.jitter > 0) return runs;  // the scene is jittered already
  for (int seed = 1; seed <= seeds; ++seed) {
    PlannedRun run = run_at(spacing);
    run.curve = "seed", run.value = std::to_string(seed);
    run.settings.insert(run.settings.end(), {"start.jitter=0.1", "start.seed=" + std::to_string(seed)});
    runs.push_back(std::move(run));
  }
  return runs;
}

std::vector<PlannedRun> knob_runs(const SceneFile& scene, double spacing, const std::vector<std::string>& only) {
  std::vector<PlannedRun> runs;
  const auto asked = [&](const std::string& name) { return only.empty() || std::find(only.begin(), only.end(), name) != only.end(); };
  std::vector<std::string> names{"threads", "scheme.name"};
  for (const Knob& knob : knobs_of(scene, spacing)) {
    names.push_back(knob.key);
    if (!asked(knob.key)) continue;
    const double middle = knob.key == "scheme.kernel_radius" ? (scene.dimension == 2 ? 3.1 : 2.1)
                          : knob.cost_of_step == 1           ? 0.5 * knob.values.front()
                          : knob.cost_of_step < 0            ? 2.1
                                                             : knob.values.front();
    for (double value : knob.values) {
      PlannedRun run = run_at(spacing);
      run.curve = knob.key, run.value = number(value), run.cost_factor = std::pow(value / middle, -knob.cost_of_step);
      run.settings.push_back(knob.key + "=" + number(value));
      runs.push_back(std::move(run));
    }
  }
  if (asked("scheme.name")) {
    PlannedRun run = run_at(spacing);
    run.curve = "scheme.name", run.value = scene.scheme.name == sim::Scheme::paper ? "accurate" : "paper";
    run.settings.push_back("scheme.name=" + run.value), run.cost_factor = 2;
    runs.push_back(std::move(run));
  }
  if (asked("threads"))
    for (int threads : {1, 2, 4, 8})
      if (threads <= static_cast<int>(std::thread::hardware_concurrency())) {
        PlannedRun run = run_at(spacing);
        run.curve = "threads", run.value = std::to_string(threads), run.threads = threads;
        runs.push_back(std::move(run));
      }
  for (const std::string& name : only)
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      std::string all;
      for (const std::string& one : names) all += (all.empty() ? "" : ", ") + one;
      throw SceneError("--knobs " + name + ": this scene has no such knob; it has " + all);
    }
  return runs;
}

GridCase grid_case_of(const PlannedRun& run, const std::filesystem::path& folder) {
  std::string name;
  for (const std::string& setting : run.settings) name += (name.empty() ? "" : "__") + setting;
  if (run.threads > 0) name += "__threads=" + std::to_string(run.threads);
  if (run.repeat > 0) name += "__repeat=" + std::to_string(run.repeat + 1);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_' && c != '=') c = '_';
  return {folder / name, run.settings, run.threads};
}

}  // namespace app
