#include "app/explain.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/run_case.h"
#include "sim/time_step.h"

namespace app {
namespace {

using nlohmann::json;

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// "body.water" of the first body that fulfils the condition, else "".
template <class Condition>
std::string first_body(const SceneFile& scene, Condition&& condition) {
  for (const BodySpec& body : scene.bodies)
    if (condition(body)) return "body." + body.name;
  return "";
}

bool viscous(const BodySpec& body) {
  const auto* newtonian = std::get_if<sim::Newtonian>(&body.fluid.rheology);
  return body.kind == sim::Kind::fluid && !(newtonian && newtonian->viscosity == 0);
}

template <int D>
std::int64_t state_bytes(sim::State<D>& state) {
  std::int64_t bytes = 0;
  sim::for_each_array(state, [&](const char*, auto& array) { bytes += static_cast<std::int64_t>(array.size() * sizeof(array[0])); });
  return bytes;
}

}  // namespace

std::vector<StageLine> stages_of(const SceneFile& scene, bool shells, bool solids) {
  const std::string fluid = first_body(scene, [](const BodySpec& body) { return body.kind == sim::Kind::fluid; });
  const std::string rheology = first_body(scene, viscous);
  const std::string elastic = first_body(scene, [](const BodySpec& body) { return body.kind == sim::Kind::elastic; });
  const auto where = [](const std::string& body, const char* key) { return body.empty() ? std::string() : body + key; };
  if (scene.time.mode == sim::TimeMode::static_equilibrium)
    return {{"equilibrium of the elastic bodies under their loads (Newton)", "time.mode"},
            {"gravity", scene.gravity ? "gravity.acceleration" : ""},
            {"loads", scene.loads.empty() ? "" : "load"}};
  const bool fluid_loads =
      std::any_of(scene.loads.begin(), scene.loads.end(), [&](const LoadSpec& l) { return scene.bodies[l.body].kind == sim::Kind::fluid; });
  return {{"walls moved", scene.motions.empty() ? "" : where("body." + scene.bodies[scene.motions.front().body].name, ".motion")},
          {"ports prescribed", scene.ports.empty() ? "" : "port"},
          {"neighbours, density, free surface", fluid},
          {"gravity on the fluid", scene.gravity && !fluid.empty() ? "gravity.acceleration" : ""},
          {"loads on the fluid", fluid_loads ? "load" : ""},
          {"dissipation of unresolved scales",
           !fluid.empty() && scene.scheme.subparticle_dissipation != 0 ? "scheme.subparticle_dissipation (default)" : ""},
          {"viscosity, implicit", where(rheology, ".material")},
          {"elastic shells, explicit sub-steps", shells ? where(elastic, "") : ""},
          {"contact of shells", shells ? where(elastic, "") : ""},
          {"elastic solids", solids ? where(elastic, "") : ""},
          {"pressure of fluid and leaflets in one equation", fluid},
          {"particle shifting", !fluid.empty() && scene.scheme.shifting > 0 ? "scheme.shifting (default)" : ""},
          {"exchange through ports", scene.ports.empty() ? "" : "port"}};
}

nlohmann::json explain_scene(const SceneFile& file, int measured_steps) {
  json result{{"scene", file.path.string()}, {"title", file.title}, {"dimension", file.dimension}, {"spacing", file.spacing}};
  with_scene(file, [&](auto& built, const auto& scene) {
    using SceneType = std::decay_t<decltype(scene)>;
    constexpr int D = std::is_same_v<SceneType, sim::Scene<2>> ? 2 : 3;
    static const char* const kinds[] = {"elastic", "shell", "wall", "fluid", "port"};
    for (const sim::Body& body : scene.description.bodies)
      result["bodies"].push_back({{"name", body.name},
                                  {"kind", kinds[static_cast<int>(body.kind)]},
                                  {"particles", body.count},
                                  {"material", sim::body_info(body).material}});
    sim::State<D> state = sim::initial_state(scene);
    result["particles"] = state.size();
    for (const StageLine& line : stages_of(file, scene.shell_count > 0, scene.elastic_count > 0)) {
      if (line.because.empty())
        result["not_simulated"].push_back(line.stage);
      else
        result["stages"].push_back({{"stage", line.stage}, {"because", line.because}});
    }
    result["state_bytes"] = state_bytes(state);
    result["memory_bytes_about"] = estimated_memory(static_cast<std::int64_t>(state.size()), D);
    result["warnings"] = built.warnings;
    result["placement_seconds"] = built.placement_seconds;
    if (file.time.mode == sim::TimeMode::static_equilibrium) return;
    const double first = sim::time_step_limit(scene, state, file.time.end).step;
    result["first_step"] = first;
    if (measured_steps > 0) {
      sim::Workspace<D> work;
      const double start = now_seconds();
      for (int k = 0; k < measured_steps; ++k) sim::step(scene, state, work, file.time.end);
      const double a_step = (now_seconds() - start) / measured_steps;
      result["measured"] = {{"steps", measured_steps},
                            {"seconds_a_step", a_step},
                            {"step", state.last_step},
                            {"microseconds_a_particle_and_step", 1e6 * a_step / static_cast<double>(state.size())}};
      if (!work.stage_times.seconds.empty()) result["measured"]["stage_seconds"] = work.stage_times.seconds;
      result["estimated_seconds"] = a_step * file.time.end / state.last_step;
    } else {
      result["estimated_seconds"] = 4e-6 * static_cast<double>(state.size()) * file.time.end / first;
    }
  });
  return result;
}

}  // namespace app
