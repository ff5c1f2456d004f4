// Small scenes of seconds, as a user would write them: each effect that has a memory is in one of them.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace stability {

// Water falls and splashes: free surface, walls, adaptive steps.
inline const char* const dam_scene = R"(title = "Dam"
dimension = 2
spacing = 0.05
[time]
end = 0.3
output = 0.02
[gravity]
acceleration = [0, -9.81]
[[body]]
name = "water"
kind = "fluid"
shape = { type = "box", min = [0, 0], max = [0.4, 0.6] }
material = { density = 1000, rheology = "newtonian", viscosity = 1e-3 }
[[body]]
name = "tank"
kind = "wall"
shape = { type = "box", min = [-0.2, -0.2], max = [1, 1], subtract = [ { type = "box", min = [0, 0], max = [0.8, 1.2] } ] }
[[probe]]
name = "front"
quantity = "front"
axis = "x"
)";

// Water on a soft plate of four layers: the projection's factor of the solid, which is kept over several steps, and its implicit steps.
inline const char* const solid_scene = R"(title = "Water on a plate"
dimension = 2
spacing = 0.02
[time]
end = 0.04
output = 0.002
[gravity]
acceleration = [0, -9.81]
[[body]]
name = "water"
kind = "fluid"
shape = { type = "box", min = [0, 0], max = [0.4, 0.2] }
material = { density = 1000, rheology = "newtonian", viscosity = 1e-3 }
[[body]]
name = "tank"
kind = "wall"
shape = { type = "box", min = [-0.08, 0], max = [0.48, 0.3], subtract = [ { type = "box", min = [0, 0], max = [0.4, 0.3] } ] }
[[body]]
name = "plate"
kind = "elastic"
shape = { type = "box", min = [-0.08, -0.08], max = [0.48, 0] }
material = { density = 2700, law = "linear", youngs_modulus = 1e6, poisson_ratio = 0.34 }
fixed = [ { type = "box", min = [-0.08, -0.08], max = [0, 0] }, { type = "box", min = [0.4, -0.08], max = [0.48, 0] } ]
[[probe]]
name = "middle"
quantity = "displacement"
body = "plate"
at = [0.2, -0.04]
)";

// A stiff plate that swings under its own weight: implicit steps with a factor that is kept while it serves.
inline const char* const beam_scene = R"(title = "Beam"
dimension = 2
spacing = 0.05
[time]
end = 0.4
output = 0.01
[gravity]
acceleration = [0, -9.81]
[[body]]
name = "beam"
kind = "elastic"
shape = { type = "box", min = [0, 0], max = [1, 0.2] }
material = { density = 2700, law = "neo-hookean", youngs_modulus = 1e10, poisson_ratio = 0.3 }
fixed = [ { type = "box", min = [-0.1, -0.1], max = [0, 0.3] } ]
[[probe]]
name = "tip"
quantity = "displacement"
body = "beam"
at = [1, 0.1]
)";

// Two flaps in a channel between a pressure wave and a Windkessel: a valve in two dimensions, with ports, shells, contact and
// shear-thinning blood.
inline const char* const valve_scene = R"(title = "Flat valve"
dimension = 2
spacing = 0.001
[time]
end = 0.02
output = 0.001
[[body]]
name = "blood"
kind = "fluid"
shape = { type = "box", min = [-0.02, -0.01], max = [0.02, 0.01], subtract = [
  { type = "box", min = [-0.00025, 0.002], max = [0.00025, 0.01] }, { type = "box", min = [-0.00025, -0.01], max = [0.00025, -0.002] } ] }
material = { density = 1060, rheology = "blood", hematocrit = 45 }
[[body]]
name = "wall"
kind = "wall"
shape = { type = "box", min = [-0.024, -0.014], max = [0.024, 0.014], subtract = [ { type = "box", min = [-0.025, -0.01], max = [0.025, 0.01] } ] }
[[body]]
name = "upper"
kind = "elastic"
shape = { type = "box", min = [-0.00025, 0.002], max = [0.00025, 0.01] }
material = { density = 1060, law = "neo-hookean", youngs_modulus = 1e6, poisson_ratio = 0.45 }
fixed = [ { type = "box", min = [-0.001, 0.0085], max = [0.001, 0.011] } ]
[[body]]
name = "lower"
kind = "elastic"
shape = { type = "box", min = [-0.00025, -0.01], max = [0.00025, -0.002] }
material = { density = 1060, law = "neo-hookean", youngs_modulus = 1e6, poisson_ratio = 0.45 }
fixed = [ { type = "box", min = [-0.001, -0.011], max = [0.001, -0.0085] } ]
[[port]]
name = "inlet"
plane = { point = [-0.02, 0], normal = [-1, 0], radius = 0.01 }
pressure = "wave.csv"
[[port]]
name = "outlet"
plane = { point = [0.02, 0], normal = [1, 0], radius = 0.01 }
windkessel = { proximal_resistance = 1e5, distal_resistance = 1e6, compliance = 1e-7, initial_pressure = 0 }
[[probe]]
name = "tip"
quantity = "displacement"
body = "upper"
at = [0, 0.0025]
)";

// A square sheet in space, held at one edge.
inline const char* const sheet_scene = R"(title = "Sheet"
dimension = 3
spacing = 0.05
[time]
end = 0.01
output = 0.005
[gravity]
acceleration = [0, 0, -9.81]
[[body]]
name = "sheet"
kind = "elastic"
shape = { type = "box", min = [0, 0, -5e-5], max = [1, 1, 5e-5] }
material = { density = 1000, law = "neo-hookean", youngs_modulus = 1e6, poisson_ratio = 0.3 }
fixed = [ { type = "box", min = [-0.1, -0.1, -0.1], max = [0.1, 1.1, 0.1] } ]
)";

// Writes the scene and its wave; returns the scene's path.
inline std::filesystem::path write_scene(const std::filesystem::path& folder, const char* text) {
  std::ofstream(folder / "scene.toml") << text;
  std::ofstream(folder / "wave.csv") << "time,pressure\n0,0\n0.005,1500\n0.012,-500\n0.02,0\n";
  return folder / "scene.toml";
}

}  // namespace stability
