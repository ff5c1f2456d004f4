// What is constant for a run: the description, the lattice, and the effects that the description calls for. An effect that nothing calls
// for is absent: no arrays, no stage, no cost.
#pragma once

#include <memory>
#include <optional>

#include "sim/contact.h"
#include "sim/gravity.h"
#include "sim/kernel.h"
#include "sim/neighbors.h"
#include "sim/scene_description.h"
#include "sim/shell.h"
#include "sim/solid.h"
#include "sim/viscosity.h"

namespace sim {

// Pressure of incompressible blood: the projection. Engaged where there is fluid.
struct Pressure {
  bool free_surface = false;  // the fluid starts with a free surface: zero pressure there
  bool anchored = false;      // some pressure is given (free surface or a pressure port); else the mean is set to zero
};

template <int D>
struct SheetGeometry;

template <int D>
struct Scene {
  SceneDescription<D> description;
  Lattice lattice;
  Periodicity<D> space;
  Vector<D> lower, upper;  // m: what leaves this box is out of the scene
  std::int64_t elastic_count = 0, shell_count = 0, wall_count = 0, first_fluid = 0;
  std::vector<double> measure;       // rows below first_fluid: share of a lattice cell that the particle fills (shell: area / l0^(D-1))
  std::vector<double> back_depth;    // rows below first_fluid: distance to the far face of a thin wall, m; 0 = none near
  std::vector<Tensor<D>> curvature;  // rows below first_fluid: of the wall's surface at the start, 1/m (walls.h); empty: all flat
  std::vector<double> density;       // per body, kg/m³
  double fluid_particle_volume = 0;  // m³ (2-D: m²): of the fluid's bodies over their particles, about l0^D
  double reference_speed = 0;        // m/s: initial, port and wall speeds; bounds the first steps

  std::optional<Gravity<D>> gravity;
  std::optional<Viscosity> viscosity;
  std::optional<Pressure> pressure;
  std::optional<SolidElasticity<D>> solids;
  std::vector<Vector<D>> solid_normal;  // where solids meet fluid: outward normal of the nearest face at rest, per elastic row
  std::optional<ShellElasticity<D>> shells;
  std::optional<Contact<D>> contact;
  std::shared_ptr<const SheetGeometry<D>> sheet;  // where there are shells in blood: their elements, for cutting links
};

// Throws std::invalid_argument with one line on what cannot be simulated.
template <int D>
Scene<D> make_scene(SceneDescription<D> description);
template <int D>
State<D> initial_state(const Scene<D>& scene);

}  // namespace sim
