#include "sim/scene.h"

#include <cmath>
#include <stdexcept>

#include "sim/number_density.h"
#include "sim/paper_step.h"
#include "sim/port_walls.h"
#include "sim/ports.h"
#include "sim/sides.h"
#include "sim/solid_coupling.h"
#include "sim/step.h"
#include "sim/walls.h"
#include "sim/workspace.h"

namespace sim {
namespace {

template <int D>
void count_rows(Scene<D>& scene) {
  const auto& particles = scene.description.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Kind kind = particles.kind[i];
    scene.elastic_count += kind == Kind::elastic;
    scene.shell_count += kind == Kind::shell;
    scene.wall_count += kind == Kind::wall;
    if (i > 0 && particles.kind[i - 1] > kind) throw std::invalid_argument("particles are not grouped: elastic, shell, wall, fluid");
  }
  scene.first_fluid = scene.elastic_count + scene.shell_count + scene.wall_count;
  const double l0 = scene.description.spacing;
  scene.measure.resize(scene.first_fluid);
  for (std::int64_t i = 0; i < scene.first_fluid; ++i)
    scene.measure[i] = particles.kind[i] == Kind::shell ? std::min(1.0, particles.volume[i] / std::pow(l0, D - 1)) : 1.0;
}

// A fluid that the lattice fits with a pitch other than l0 (a length that l0 does not divide) has particles of another volume. Among
// leaflets, which swallow blood particle by particle: l0^D.
template <int D>
double fluid_particle_volume(const Scene<D>& scene, bool leaflets) {
  const auto& particles = scene.description.particles;
  double volume = 0, count = 0;
  for (std::size_t i = static_cast<std::size_t>(scene.first_fluid); i < particles.size(); ++i) volume += particles.volume[i], count += 1;
  return leaflets || !(volume > 0) ? std::pow(scene.description.spacing, D) : volume / count;
}

template <int D>
double reference_speed(const SceneDescription<D>& description) {
  double speed = 0;
  for (std::size_t i = 0; i < description.particles.size(); ++i)
    if (description.particles.kind[i] == Kind::fluid) speed = std::max(speed, description.particles.velocity[i].norm());
  double highest = -1e300, lowest = 1e300, density = 1000;
  for (const auto& body : description.bodies)
    if (body.kind == Kind::fluid) density = body.fluid.density;
  for (const auto& port : description.ports) {
    for (double v : port.table.value) {
      if (port.condition == PortCondition::velocity) speed = std::max(speed, std::abs(v));
      if (port.condition == PortCondition::flow_rate)
        speed = std::max(speed, std::abs(v) / (D == 3 ? M_PI * port.radius * port.radius : 2 * port.radius));
    }
    if (port.condition == PortCondition::pressure) {
      for (double p : port.table.value) highest = std::max(highest, p), lowest = std::min(lowest, p);
    }
    speed = std::max(speed, std::abs(port.start_speed));
  }
  // What pressures at ports can make is a bound, not an expectation: a fifth of it enters the first steps (time_step.cpp).
  if (highest > lowest) speed = std::max(speed, std::sqrt(2 * (highest - lowest) / density));
  for (const auto& motion : description.motions) {
    speed = std::max(speed, motion.surface_velocity.norm());
    for (const auto& table : motion.velocity)
      for (double v : table.value) speed = std::max(speed, std::abs(v));
  }
  return speed;
}

}  // namespace

template <int D>
Scene<D> make_scene(SceneDescription<D> description) {
  Scene<D> scene;
  if (!description.ports.empty()) continue_walls_beyond_ports(description, 3.5 * description.spacing);
  SchemeSettings& scheme = description.scheme;
  bool fluid = false, viscous = false, shear_dependent = false, shells = false, solids = false;
  for (const auto& body : description.bodies) {
    scene.density.push_back(body.kind == Kind::fluid ? body.fluid.density : body.elastic.density);
    if (body.kind == Kind::fluid && body.count > 0) {
      fluid = true;
      viscous = viscous || !is_inviscid(body.fluid.rheology);
      shear_dependent = shear_dependent || shear_rate_matters(body.fluid.rheology);
    }
    shells = shells || body.kind == Kind::shell;
    solids = solids || body.kind == Kind::elastic;
  }
  if (scheme.name == Scheme::paper) check_paper_scheme(description);
  if (!(description.spacing > 0)) throw std::invalid_argument("spacing must be positive");
  if (scheme.kernel_radius == 0) scheme.kernel_radius = D == 2 && !shells && !solids ? 3.1 : 2.1;
  if (scheme.subparticle_dissipation < 0) scheme.subparticle_dissipation = shells ? 0.3 : 0.1;
  if (scheme.maximum_step == 0 && shells && fluid) scheme.maximum_step = 0.1 * description.spacing;  // at 1 m/s a tenth of l0
  if (scheme.viscosity_limit == 0) scheme.viscosity_limit = shells ? 0.1 : 1000;
  scene.lattice = make_lattice(D, description.spacing, scheme.kernel_radius * description.spacing, scheme.literal_weight);
  scene.space = make_periodicity(description.domain);
  scene.description = std::move(description);
  count_rows(scene);
  scene.fluid_particle_volume = fluid_particle_volume(scene, shells);
  scene.back_depth = far_faces(scene);
  if (fluid) scene.curvature = wall_curvatures(scene);
  const SceneDescription<D>& d = scene.description;
  if (d.gravity && d.gravity->norm() > 0) scene.gravity = Gravity<D>{*d.gravity};
  if (fluid && viscous) scene.viscosity = Viscosity{shear_dependent, !shells};
  if (solids) {
    scene.solids = build_solids(d);
    if (fluid) scene.solid_normal = rest_surface_normals(d.particles, scene.elastic_count, d.spacing);
  }
  if (shells) {
    scene.shells = build_shells(d);
    if (fluid) {
      const ShellBody& first = scene.shells->bodies.front();
      double blood = 0;
      for (const auto& body : d.bodies)
        if (body.kind == Kind::fluid) blood = std::max(blood, body.fluid.density);
      const double own = first.density * first.thickness, layer = blood * std::max(d.spacing - first.thickness, 0.5 * d.spacing);
      scene.shells->axial_dashpot = 5000;
      scene.shells->bending_dashpot = d.scheme.bending_viscosity / d.spacing * (1 + d.scheme.added_mass * layer / own);
    }
    ContactSettings contact;
    if (fluid) contact.film = d.scheme.film_resistance;
    scene.contact = build_contact(d, *scene.shells, contact);
    if (fluid) scene.sheet = std::make_shared<const SheetGeometry<D>>(make_sheet_geometry(*scene.shells));
  }
  scene.reference_speed = reference_speed(d);
  Vector<D> low = Vector<D>::Constant(1e300), high = -low;
  for (const auto& x : d.particles.position) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const Vector<D> margin = Vector<D>::Constant(2 * (high - low).maxCoeff() + 10 * d.spacing);
  scene.lower = low - margin;
  scene.upper = high + margin;
  if (fluid || !d.ports.empty()) {
    scene.pressure = Pressure{};
    scene.pressure->free_surface = true;  // so that the neighbourhood looks for one
    State<D> state = initial_state(scene);
    Workspace<D> work;
    find_neighborhood(scene, state, work);
    const std::int64_t surface = count_open_surface(scene, state, work);
    const auto fluid_count = static_cast<double>(state.size() - static_cast<std::size_t>(scene.first_fluid));
    // A few gaps in a full vessel are no surface, unless they are half of the fluid.
    scene.pressure->free_surface = surface > std::min(std::max(4.0, 0.002 * fluid_count), 0.5 * fluid_count);
    // The undisturbed number density n0 ~ 1/V, which a full fluid must not be pulled away from. Below a free surface fluid arranges itself
    // anew, and would be pressed apart.
    if (!scene.pressure->free_surface) scene.lattice.number_density *= std::pow(d.spacing, D) / scene.fluid_particle_volume;
    for (const auto& port : d.ports)
      scene.pressure->anchored |= port.condition == PortCondition::pressure || port.condition == PortCondition::windkessel;
    scene.pressure->anchored |= scene.pressure->free_surface;
  }
  return scene;
}

template <int D>
State<D> initial_state(const Scene<D>& scene) {
  const InitialParticles<D>& particles = scene.description.particles;
  State<D> state;
  const std::size_t n = particles.size();
  state.position = particles.position;
  state.velocity = particles.velocity;
  state.kind = particles.kind;
  state.body = particles.body;
  state.port.assign(n, -1);
  state.pressure.assign(n, 0);
  state.id.resize(n);
  for (std::size_t i = 0; i < n; ++i) state.id[i] = static_cast<std::int64_t>(i);
  state.next_id = static_cast<std::int64_t>(n);
  const std::size_t solids = static_cast<std::size_t>(scene.elastic_count + scene.shell_count);
  state.fluid_force.assign(solids, Vector<D>::Zero());
  state.fluid_acceleration.assign(solids, Vector<D>::Zero());
  state.pressure_plus.assign(scene.shell_count, 0);
  state.pressure_minus.assign(scene.shell_count, 0);
  open_ports(scene, state);
  return state;
}

template Scene<2> make_scene(SceneDescription<2>);
template Scene<3> make_scene(SceneDescription<3>);
template State<2> initial_state(const Scene<2>&);
template State<3> initial_state(const Scene<3>&);

}  // namespace sim
