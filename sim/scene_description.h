// What the outside hands to the solver: plain data, SI units, no file formats and no shapes. `make_scene` (scene.h) turns it into a Scene,
// engaging only the effects it calls for.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sim/particles.h"

namespace sim {

// A value over time: linear between rows, constant before the first; after the last row repeated (periodic with the last row's time) or
// held. One row is a constant.
struct TimeTable {
  std::vector<double> time;  // s, increasing
  std::vector<double> value;
  bool repeat = true;
  double at(double t) const;
};
TimeTable constant_table(double value);

// --- materials -------------------------------------------------------------------------------------------------------------------
struct Newtonian {
  double viscosity = 0;
};  // Pa s, >= 0; 0 = inviscid
struct HerschelBulkley {
  double consistency = 0, index = 1, yield_stress = 0;
};  // Pa s^n, -, Pa (paper Eq 8)
struct Casson {
  double viscosity = 0, yield_stress = 0;
};  // Pa s, Pa
using Rheology = std::variant<Newtonian, HerschelBulkley, Casson>;

struct FluidMaterial {
  double density = 1000;  // kg/m³, > 0
  Rheology rheology = Newtonian{};
};

enum class ElasticLaw { linear, corotated, st_venant_kirchhoff, neo_hookean, fibre_reinforced };
struct ElasticMaterial {
  double density = 1000;  // kg/m³
  ElasticLaw law = ElasticLaw::neo_hookean;
  double youngs_modulus = 1e6;   // Pa, small-strain (of the matrix for fibre_reinforced)
  double poisson_ratio = 0.45;   // (-1, 0.5)
  double fibre_modulus = 0.8e6;  // k1, Pa
  double fibre_stiffening = 5;   // k2, -
  double fibre_limit = 0.35;     // I4 - 1 beyond which the fibre's energy goes on linearly in stress
  double damping = 0;            // 1/s, mass-proportional
  bool plane_stress = false;     // 2-D only
  double thickness = 0;          // m, shells only: the material thickness
  // Shells only, (0, 1]: thickness of the one solid sheet that bends as stiffly as the tissue, over its thickness. 1 = one solid sheet;
  // layers of shares f_k that slide freely on one another have sqrt(sum f_k^3).
  double bending_thickness_ratio = 1;
};

struct Body {
  std::string name;
  Kind kind = Kind::fluid;            // elastic, shell, wall or fluid
  FluidMaterial fluid;                // where kind == fluid
  ElasticMaterial elastic;            // where kind == elastic or shell
  std::int64_t first = 0, count = 0;  // rows in InitialParticles
};

// --- the particles at the start ---------------------------------------------------------------------------------------------------
// Same row order as State: elastic, shell, wall, fluid. All arrays have one row a particle.
template <int D>
struct InitialParticles {
  std::vector<Vector<D>> position, velocity;
  std::vector<Kind> kind;
  std::vector<std::int32_t> body;
  std::vector<double> volume;  // m³ (2-D: m²) that the particle stands for; a shell particle: its area (2-D: length), m²
  std::vector<Vector<D>>
      normal;  // wall: unit normal of the nearest true surface, pointing out of the wall; shell: unit normal (+ side); else 0
  std::vector<double> depth;  // wall, elastic: distance of the centre below the body's true surface, >= 0; else 0
  std::vector<Vector<D>>
      surface_area;  // elastic: outward area vector of the body's surface that this particle carries (0 inside), m² (2-D: m)
  // Optional (empty: a lattice cell's open faces, else one piece `depth` away along the normal): the surface pieces that an elastic
  // particle carries, particle by particle; row i has pieces [surface_begin[i], surface_begin[i + 1]). Where faces meet it has one on each.
  std::vector<std::int64_t> surface_begin;
  std::vector<Vector<D>> piece_area, piece_offset;  // outward, m² (2-D: m); from the particle's centre, m
  std::vector<std::uint8_t> fixed;                  // bit k set: displacement along axis k is held at 0
  std::vector<double> stiffness_scale;              // elastic, shell: factor on the body's stiffness (calcified spots); else 1
  std::vector<Vector<D>> fibre;                     // elastic, shell with fibre_reinforced: unit fibre direction, else 0
  // Optional (empty = half-way between fixed and free particles): for elastic particles outside a fixed region but within 1 l0 of its face,
  // the vector to the nearest point of that face, m, and the axes held there (bits as in `fixed`; 0 = no face near). The region may also
  // merely touch the body from outside. The clamp then acts at the face exactly, wherever it cuts the lattice.
  std::vector<Vector<D>> clamp_offset;
  std::vector<std::uint8_t> clamp_axes;
  std::size_t size() const { return position.size(); }
};

// Mesh of a shell body's mid-surface over its particles: triangles in 3-D, segments in 2-D; indices relative to the body's first row;
// oriented so that the right-hand normal (2-D: the direction turned by +90°) is the particles' `normal`.
template <int D>
struct ShellMesh {
  std::int32_t body = -1;
  std::vector<std::array<std::int32_t, D>> elements;
};

// --- loads, motions, ports, probes --------------------------------------------------------------------------------------------------
template <int D>
struct Load {
  std::string name;
  std::int32_t body = -1;
  std::vector<std::int64_t> rows;  // elastic/shell: particles the load acts on; empty for an acceleration of a whole fluid body
  std::vector<double> share;       // per row: fraction of the total force (sums to 1), for `force`
  std::optional<Vector<D>> force;  // N in total (2-D: N per metre)
  std::function<Vector<D>(const Vector<D>&, double)> acceleration;  // m/s² at position and time, or empty
  std::optional<double> pressure;   // Pa, pushing into the body through its boundary, following the deformed surface
  double ramp = 0;                  // s from zero to full, linear; 0 = at once
  std::optional<TimeTable> factor;  // instead of ramp
};
template <int D>
double load_factor(const Load<D>& load, double time);

template <int D>
struct Motion {  // of a wall body: rigid motion, or a surface that drags while it stands
  std::int32_t body = -1;
  std::array<TimeTable, D> velocity;  // m/s; empty tables = 0
  TimeTable angular_velocity;         // rad/s (about z in 2-D, about `axis` in 3-D); empty = 0
  Vector<D> center = Vector<D>::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  Vector<D> surface_velocity = Vector<D>::Zero();
};

struct Windkessel {
  double proximal_resistance = 0, distal_resistance = 0, compliance = 0, initial_pressure = 0;
};  // Pa s/m³, Pa s/m³, m³/Pa, Pa
enum class PortCondition { pressure, velocity, flow_rate, windkessel };
template <int D>
struct Port {
  std::string name;
  Vector<D> point, normal;  // m; unit, out of the fluid
  double radius = 0;        // m: the port acts on what is within radius of point in the plane
  PortCondition condition = PortCondition::pressure;
  TimeTable table;  // Pa, m/s (inward positive), m³/s (inward positive)
  Windkessel windkessel;
  double impedance = 0;    // Pa s/m: characteristic impedance rho c of the vessel beyond, against fast changes of flow only:
                           // pressure = table - impedance * (inflow speed - its mean over the last 0.03 s)
  double start_speed = 0;  // m/s inward, initial speed of the port's particles
};

enum class Quantity { displacement, position, velocity, pressure, stress, density, flow_rate, energy, volume, front };
template <int D>
struct Probe {
  std::string name;
  Quantity quantity = Quantity::pressure;
  std::int32_t body = -1;         // -1 = all
  std::vector<Vector<D>> points;  // `at`: one; `line`: many
  bool line = false;
  Vector<D> plane_point = Vector<D>::Zero(), plane_normal = Vector<D>::Zero();
  double plane_radius = std::numeric_limits<double>::infinity();
  int axis = 0;  // for front
};

// --- settings ------------------------------------------------------------------------------------------------------------------------
enum class Scheme { accurate, paper };
struct SchemeSettings {  // every numerical knob; lengths in units of the spacing l0
  Scheme name = Scheme::accurate;
  double kernel_radius = 0;  // r_e/l0; 0 = chosen by make_scene: 3.1 in 2-D without leaflets, else 2.1
  double elastic_kernel_radius = 2.1;
  double cfl = 0.2;                  // dt <= cfl l0 / u_max
  double maximum_step = 0;           // s; 0 = none beyond the physical limits; with leaflets in blood 0.1 s/m times l0
  double pressure_tolerance = 1e-5;  // relative residual
  int pressure_iterations = 500;
  double density_blend = 0.01;      // gamma of the density correction in the source of the pressure equation
  double density_tolerance = 7e-4;  // mean |n/n0 - 1| to which positions are mended after a step; free surfaces; 0 = off
  double shifting = 0.6;            // largest strength A of particle shifting; 0 = off
  double subparticle_dissipation =
      -1;  // C of the dissipation for unresolved scales; 0 = off; -1 = chosen by make_scene: 0.3 with leaflets, else 0.1
  double projection_filter = 0.05;   // share of what neighbours' gradients do not explain of a velocity, taken off a step; free surfaces
  double viscosity_limit = 0;        // Pa s, cap of the rheological viscosity; 0 = chosen by make_scene: 0.1 with leaflets, else 1000
  double added_mass = 2.0;           // factor on the blood's mass within a leaflet's own lattice layer, rho (l0 - h) per area
  double resolved_mass = 0.3;        // of the mass of blood in the layer: what the elastic sub-steps feel of the blood farther out
  double leaflet_relaxation = 0.2;   // of a step: Kelvin-Voigt time of leaflets in blood along their normal; damps what a step can't follow
  double bending_viscosity = 20;     // m/s: leaflets in blood: the shortest bending wave dies out at the rate of this over l0
  double film_resistance = 3000;     // Pa s/m: of the film of blood between leaflets that lie on each other (contact.h)
  double elastic_substep = 0.35;     // of l0/c; explicit elastic sub-steps; refused above 0.5
  int elastic_explicit_limit = 200;  // solids: more explicit sub-steps than this in a step, and they are advanced implicitly
  double elastic_tolerance = 1e-8;   // relative residual of implicit and static elastic solves
  int outer_iterations = 100;
  bool literal_weight = false;  // paper: w = r_e/r as printed, with the literal density source (an exhibit)
};

enum class TimeMode { dynamic, static_equilibrium };
struct TimeSettings {
  TimeMode mode = TimeMode::dynamic;
  double end = 1;        // s (static: load factor)
  double step = 0;       // s; 0 = adaptive
  double output = 0.01;  // s between frames
};

struct Limits {
  std::int64_t particles = 5'000'000;
  std::int64_t memory = 0;  // bytes; 0 = none
  double wall_time = 0;     // s; 0 = none
  // Of the ledger at the end of a run; over one of them the run counts as failed.
  std::int64_t lost = 0;        // particles neither inside nor accounted as out
  double penetration = 1;       // l0, deepest place of blood behind a leaflet or wall before it was put back
  double density_error = 0.25;  // rms of n/n0 - 1
};

template <int D>
struct Domain {
  bool present = false;
  Vector<D> min = Vector<D>::Zero(), max = Vector<D>::Zero();
  std::array<bool, D> periodic{};
};

// Frame of a valve: what the clinical metrics and the default views need. Absent where the scene is no valve.
struct ValveFrame {
  Eigen::Vector3d annulus_center, axis;                                     // m; unit, ventricle to aorta
  double annulus_radius = 0, commissure_height = 0, commissure_radius = 0;  // m
  std::vector<std::int32_t> leaflet_bodies;                                 // shell bodies
  std::int32_t ventricle_port = -1, aorta_port = -1;
};

template <int D>
struct SceneDescription {
  std::string title;
  double spacing = 0;  // l0, m
  Domain<D> domain;
  TimeSettings time;
  SchemeSettings scheme;
  Limits limits;
  std::optional<Vector<D>> gravity;  // m/s²
  std::vector<Body> bodies;
  InitialParticles<D> particles;
  std::vector<ShellMesh<D>> shell_meshes;
  std::vector<Load<D>> loads;
  std::vector<Motion<D>> motions;
  std::vector<Port<D>> ports;
  std::vector<Probe<D>> probes;
  std::optional<ValveFrame> valve;
};

}  // namespace sim
