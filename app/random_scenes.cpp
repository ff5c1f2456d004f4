#include "app/random_scenes.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "app/run_case.h"
#include "app/split_mix.h"
#include "sim/step.h"

namespace app {
namespace {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15ull + 1) {}
  double uniform() { return uniform_of(state_ += 0x9e3779b97f4a7c15ull); }
  bool chance(double p) { return uniform() < p; }
  double within(double low, double high) { return low + (high - low) * uniform(); }
  double decades(double low, double high) { return std::exp(within(std::log(low), std::log(high))); }
  template <std::size_t N>
  const char* one_of(const char* const (&words)[N]) {
    return words[static_cast<std::size_t>(uniform() * N) % N];
  }

 private:
  std::uint64_t state_;
};

std::string text(double value) {
  std::ostringstream out;
  out.precision(6);
  out << value;
  return out.str();
}

// A vector in the scene's dimension: x, then y (and z = depth in 3-D).
std::string vector_text(int dimension, double x, double y, double z = 0) {
  return "[" + text(x) + ", " + text(y) + (dimension == 3 ? ", " + text(z) : "") + "]";
}

std::string box_text(int dimension, double x0, double y0, double x1, double y1, double depth) {
  return "{ type = \"box\", min = " + vector_text(dimension, x0, y0, 0) + ", max = " + vector_text(dimension, x1, y1, depth);
}

std::string fluid_material(Dice& dice) {
  const std::string density = "density = " + text(dice.decades(500, 2000));
  static const char* const kinds[] = {"newtonian", "newtonian", "inviscid", "herschel-bulkley", "casson", "blood"};
  const std::string kind = dice.one_of(kinds);
  if (kind == "newtonian") return "{ " + density + ", viscosity = " + text(dice.decades(1e-4, 10)) + " }";
  if (kind == "inviscid") return "{ " + density + ", viscosity = 0 }";
  if (kind == "herschel-bulkley")
    return "{ " + density + ", rheology = \"herschel-bulkley\", consistency = " + text(dice.decades(1e-3, 1)) +
           ", index = " + text(dice.within(0.5, 1)) + ", yield_stress = " + text(dice.within(0, 0.1)) + " }";
  if (kind == "casson")
    return "{ " + density + ", rheology = \"casson\", viscosity = " + text(dice.decades(1e-3, 1)) +
           ", yield_stress = " + text(dice.within(0, 0.1)) + " }";
  return "{ " + density + ", rheology = \"blood\", hematocrit = " + text(dice.within(0, 70)) + " }";
}

std::string elastic_material(Dice& dice) {
  static const char* const laws[] = {"linear", "corotated", "st-venant-kirchhoff", "neo-hookean", "fibre-reinforced"};
  return "{ density = " + text(dice.decades(500, 3000)) + ", law = \"" + dice.one_of(laws) +
         "\", youngs_modulus = " + text(dice.decades(1e4, 1e8)) + ", poisson_ratio = " + text(dice.within(0, 0.49)) + " }";
}

// What a tank of width 1 and height 1.2 (and 0.6 deep) holds.
struct Layout {
  int dimension;
  double spacing, depth;
  bool fluid, solid, shell, tank, periodic, ports;
};

std::string tank_text(const Layout& s, Dice& dice) {
  const double t = 4 * s.spacing;
  const int d = s.dimension;
  std::string min, max, inner_min, inner_max;
  if (s.periodic || s.ports) {  // a channel along x
    min = vector_text(d, 0, -t, d == 3 ? -t : 0), max = vector_text(d, 1, 0.8 + t, s.depth + t);
    inner_min = vector_text(d, 0, 0, 0), inner_max = vector_text(d, 1, 0.8, s.depth);
  } else {
    min = vector_text(d, -t, -t, d == 3 ? -t : 0), max = vector_text(d, 1 + t, 1.2, s.depth + t);
    inner_min = vector_text(d, 0, 0, 0), inner_max = vector_text(d, 1, 1.2, s.depth);
  }
  std::string out = "[[body]]\nname = \"tank\"\nkind = \"wall\"\nshape = { type = \"box\", min = " + min + ", max = " + max +
                    ", subtract = [ { type = \"box\", min = " + inner_min + ", max = " + inner_max + " } ] }\n";
  if (dice.chance(0.25)) out += "motion = { surface_velocity = " + vector_text(d, dice.within(-1, 1), 0) + " }\n";
  return out;
}

std::string bodies_text(const Layout& s, Dice& dice) {
  const int d = s.dimension;
  const double x0 = std::floor(0.35 / s.spacing) * s.spacing, x1 = x0 + std::ceil(dice.within(2, 5)) * s.spacing;
  const double top = std::floor(dice.within(0.3, 0.6) / s.spacing) * s.spacing;
  const double leaf_x = std::floor(0.7 / s.spacing) * s.spacing;
  const bool overlap = dice.chance(0.05);  // must be refused
  std::string out;
  if (s.fluid) {
    out += "[[body]]\nname = \"fluid\"\nkind = \"fluid\"\nshape = " +
           box_text(d, 0, 0, 1, s.periodic || s.ports ? 0.8 : dice.within(0.3, 0.8), s.depth);
    const std::string solid = box_text(d, x0, 0, x1, top, s.depth) + " }";
    const std::string leaf = box_text(d, leaf_x - 0.1 * s.spacing, 0, leaf_x + 0.1 * s.spacing, top, s.depth) + " }";
    if ((s.solid || s.shell) && !overlap)
      out += ", subtract = [ " + (s.solid ? solid : "") + (s.solid && s.shell ? ", " : "") + (s.shell ? leaf : "") + " ]";
    out += " }\nmaterial = " + fluid_material(dice) + "\n";
    if (dice.chance(0.4)) out += "velocity = " + vector_text(d, dice.within(-1, 1), dice.within(-0.2, 0.2)) + "\n";
  }
  if (s.solid) {
    out += "[[body]]\nname = \"solid\"\nkind = \"elastic\"\nshape = " + box_text(d, x0, 0, x1, top, s.depth) +
           " }\nmaterial = " + elastic_material(dice) + "\n";
    if (dice.chance(0.8)) out += "fixed = [ " + box_text(d, x0, 0, x1, s.spacing, s.depth) + " } ]\n";
    if (dice.chance(0.3)) out += "damping = " + text(dice.decades(1, 1000)) + "\n";
    if (dice.chance(0.2))
      out += "stiffness_map = [ { region = " + box_text(d, x0, 0.5 * top, x1, top, s.depth) + " }, scale = " + text(dice.decades(0.1, 30)) +
             " } ]\n";
  }
  if (s.shell) {
    const double x = leaf_x;
    out +=
        "[[body]]\nname = \"leaf\"\nkind = \"elastic\"\nshape = " + box_text(d, x - 0.1 * s.spacing, 0, x + 0.1 * s.spacing, top, s.depth) +
        " }\nmaterial = " + elastic_material(dice) + "\nfixed = [ " +
        box_text(d, x - s.spacing, -s.spacing, x + s.spacing, s.spacing, s.depth) + " } ]\n";
  }
  return out;
}

std::string loads_text(const Layout& s, Dice& dice) {
  const int d = s.dimension;
  std::string out;
  if (dice.chance(0.6)) out += "[gravity]\nacceleration = " + vector_text(d, dice.chance(0.2) ? 3 : 0, -9.81) + "\n";
  if (s.solid && dice.chance(0.4))
    out += dice.chance(0.5) ? "[[load]]\nbody = \"solid\"\nforce = " + vector_text(d, dice.decades(0.01, 100), 0) + "\n"
                            : "[[load]]\nbody = \"solid\"\npressure = " + text(dice.decades(1, 1e4)) + "\n";
  if (s.shell && dice.chance(0.4)) out += "[[load]]\nbody = \"leaf\"\npressure = " + text(dice.decades(0.1, 1e3)) + "\nramp = 0.01\n";
  if (s.fluid && dice.chance(0.3)) out += "[[load]]\nbody = \"fluid\"\nacceleration = " + vector_text(d, dice.within(-5, 5), 0) + "\n";
  if (s.ports) {
    const std::string radius = text(d == 2 ? 0.4 : 0.7), z = d == 3 ? ", " + text(s.depth / 2) : "", n = d == 3 ? ", 0" : "";
    const std::string given = dice.chance(0.5) ? "velocity = " + text(dice.within(-0.5, 1)) : "pressure = " + text(dice.within(-100, 1000));
    out += "[[port]]\nname = \"in\"\nplane = { point = [0, 0.4" + z + "], normal = [-1, 0" + n + "], radius = " + radius + " }\n" + given +
           "\n";
    out += "[[port]]\nname = \"out\"\nplane = { point = [1, 0.4" + z + "], normal = [1, 0" + n + "], radius = " + radius + " }\n" +
           (dice.chance(0.7) ? std::string("pressure = 0")
                             : std::string("windkessel = { proximal_resistance = 10, distal_resistance = 100, compliance = "
                                           "1e-3, initial_pressure = 10 }")) +
           "\n";
  }
  return out;
}

std::string scheme_text(Dice& dice) {
  std::string out;
  if (dice.chance(0.2)) out += "kernel_radius = " + text(dice.chance(0.5) ? 2.1 : 3.1) + "\n";
  if (dice.chance(0.2)) out += "shifting = " + text(dice.chance(0.5) ? 0 : 0.3) + "\n";
  if (dice.chance(0.2)) out += "subparticle_dissipation = " + text(dice.chance(0.5) ? 0 : 0.3) + "\n";
  if (dice.chance(0.2)) out += "cfl = " + text(dice.within(0.1, 0.4)) + "\n";
  if (dice.chance(0.1)) out += "pressure_tolerance = 1e-8\n";
  return out.empty() ? "" : "[scheme]\n" + out;
}

template <int D>
bool all_finite(const sim::State<D>& state) {
  for (std::size_t i = 0; i < state.size(); ++i)
    if (!state.position[i].allFinite() || !state.velocity[i].allFinite() || !std::isfinite(state.pressure[i])) return false;
  return true;
}

}  // namespace

std::string random_scene(std::uint64_t seed) {
  Dice dice(seed);
  Layout s{};
  s.dimension = dice.chance(0.75) ? 2 : 3;
  s.spacing = s.dimension == 2 ? dice.within(0.025, 0.06) : dice.within(0.08, 0.11);
  s.depth = s.dimension == 3 ? 0.6 : 0;
  s.fluid = dice.chance(0.8);
  s.solid = dice.chance(s.fluid ? 0.4 : 0.7);
  s.shell = dice.chance(s.fluid ? 0.2 : 0.4) || (!s.fluid && !s.solid);
  s.periodic = s.fluid && dice.chance(0.15);
  s.ports = s.fluid && !s.periodic && dice.chance(0.2);
  s.tank = s.fluid ? dice.chance(0.85) || s.ports : dice.chance(0.1);
  std::string out = "title = \"random scene " + std::to_string(seed) + "\"\ndimension = " + std::to_string(s.dimension) +
                    "\nspacing = " + text(s.spacing) + "\n[time]\nend = 1\noutput = 0.01\n";
  if (s.periodic)
    out += "[domain]\nmin = " + vector_text(s.dimension, 0, -1, -1) + "\nmax = " + vector_text(s.dimension, 1, 2, 2) +
           "\nperiodic = [\"x\"]\n";
  out += scheme_text(dice);
  out += bodies_text(s, dice);
  if (s.tank) out += tank_text(s, dice);
  out += loads_text(s, dice);
  return out;
}

nlohmann::json run_random_scene(std::uint64_t seed, int steps, double limit_seconds) {
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  nlohmann::json result{{"seed", seed}, {"outcome", "ran"}, {"steps", 0}};
  const auto give_up = [&](const char* outcome, const std::string& message) {
    const bool one_line = !message.empty() && message.find('\n') == std::string::npos;
    result["outcome"] = one_line ? outcome : "broken", result["message"] = message;
  };
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("cusp_random_" + std::to_string(::getpid()) + "_" + std::to_string(seed) + ".toml");
  std::ofstream(file) << random_scene(seed);
  bool running = false;
  try {
    const SceneFile scene_file = read_scene_file(file, {});
    with_scene(scene_file, [&](auto&, const auto& scene) {
      using SceneType = std::decay_t<decltype(scene)>;
      constexpr int D = std::is_same_v<SceneType, sim::Scene<2>> ? 2 : 3;
      sim::State<D> state = sim::initial_state(scene);
      result["particles"] = state.size();
      sim::Workspace<D> work;
      running = true;
      for (int k = 1; k <= steps; ++k) {
        sim::step(scene, state, work, scene_file.time.end);
        result["steps"] = k;
        if (!all_finite(state)) return give_up("broken", "not finite after step " + std::to_string(k));
        if (seconds() > limit_seconds && k < steps)
          return give_up("slow", std::to_string(k) + " steps in " + std::to_string(seconds()) + " s");
      }
    });
  } catch (const std::exception& error) {
    give_up(running ? "stopped" : "refused", error.what());
  }
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  result["seconds"] = seconds();
  return result;
}

}  // namespace app
