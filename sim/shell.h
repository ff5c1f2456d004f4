// Shell particles: one-layer elastic sheets (3-D) and beams (2-D) of a given material thickness, total Lagrangian
// (numerics-elastic.md 3(ii) "Shell"). Every array has one entry per shell particle ("shell row": State row minus first_row).
//
// Each particle carries rest tangents t_a, normal N and, over its rest neighbours, a quadratic least-squares fit: with d_ij = x_j - x_i
//   a_a = sum_j g_a,ij d_ij (deformed tangents), H_ab = sum_j q_ab,ij d_ij (second derivatives), n = normal of the a_a,
//   C_ab = a_a . a_b (metric), kappa_ab = n . H_ab - kappa0_ab (change of curvature).
// Energy of a particle of area A, thickness h:
//   A h/2 [W(C - 2 z kappa) + W(C + 2 z kappa)], z = h_b / (2 sqrt 3): both through-thickness Gauss points (= h_b^2/24 C:kappa:kappa at
//   small strain), h_b = h for one solid sheet, less where the tissue's layers slide on one another; its faces are at +- h_b / 2
//   + A h s^2/24 sum_k gamma_k : C : gamma_k, gamma_k = (d_k C)/2, s^2 = A: strain varying within the cell (stops in-plane saw-tooth)
// Forces are its exact gradient up to the limiter; all terms are rotation invariant.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "sim/particles.h"
#include "sim/scene_description.h"
#include "sim/shell_law.h"

namespace sim {

template <int D>
struct Contact;

struct ShellBody {
  std::int32_t body = -1;             // index into SceneDescription::bodies
  std::int32_t first = 0, count = 0;  // shell rows
  double spacing = 0;                 // m, sqrt of the mean area (2-D: mean length)
  double thickness = 0;               // m
  double bending_thickness = 0;       // m: of the solid sheet that bends alike (ElasticMaterial::bending_thickness_ratio)
  double density = 0;                 // kg/m3
  double damping = 0;                 // 1/s
  SheetMaterial material;
};

template <int D>
struct ShellElasticity {
  static constexpr int tangents = D - 1;
  static constexpr int terms = tangents + tangents * (tangents + 1) / 2;  // 3-D: t1 t2 11 22 12; 2-D: t1 11
  std::int64_t first_row = 0;                                             // State row of shell row 0
  std::vector<ShellBody> bodies;
  // per shell row
  std::vector<std::int32_t> body;                       // index into `bodies`
  std::vector<Vector<D>> rest_position;                 // m
  std::vector<std::array<Vector<D>, D - 1>> tangent;    // rest, orthonormal
  std::vector<Vector<D>> normal;                        // rest, unit, + side
  std::vector<double> area, mass, stiffness_scale;      // m2 (2-D: m), kg (2-D: kg/m), -
  std::vector<std::uint8_t> fixed;                      // bit k: axis k held
  std::vector<Eigen::Vector2d> fibre;                   // unit against the rest tangents, or 0
  std::vector<SheetTensor> rest_curvature;              // 1/m
  std::vector<double> membrane_weight, bending_weight;  // energy factors at a clamp's face; else 1
  // rest neighbours, compressed rows
  std::vector<std::int32_t> start, neighbor;
  std::vector<double> fit;                                 // terms per pair: g (1/m), q (1/m2)
  std::vector<std::array<Padded<D>, D - 1>> held_tangent;  // per row: what a held row adds to its fitted tangents (else unused)
  std::vector<double> fit_sum;                             // per row: sum of its pairs' fits
  std::vector<std::int32_t> reverse_start, reverse_owner;  // pairs in which a row is the neighbour, and their fits
  std::vector<double> reverse_fit;
  // near pairs (both directions): dashpot and stretch limiter
  std::vector<std::int32_t> bond_start, bond;
  std::vector<double> bond_length, bond_mass;         // m, kg
  std::vector<std::array<std::int32_t, D>> elements;  // mesh over shell rows (may be empty)
  double bending_dashpot = 0;    // 1/s: rate at which the shortest bending wave dies out; resists the rate of curvature only
  double axial_dashpot = 0;      // 1/s: pair force mass * dashpot * closing speed; 5000 with blood
  double substep_factor = 0.35;  // of l0/c
  double rest_step = 0;          // s, stable step of the unloaded shells at substep_factor

  std::size_t size() const { return rest_position.size(); }
  bool empty() const { return rest_position.empty(); }
};

// Rest data of all shell rows. Throws std::invalid_argument (one line, with the body's name) on a shell without thickness, too few
// neighbours, impossible material.
template <int D>
ShellElasticity<D> build_shells(const SceneDescription<D>& description);

// Elastic forces in N (2-D: N/m), overwritten; includes the dashpot and the limiter, not loads. Returns the number of limited particles.
template <int D>
std::int64_t shell_forces(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<const Vector<D>> velocity,
                          std::span<Vector<D>> force);

// Stored energy, J (2-D: J/m).
template <int D>
double shell_energy(const ShellElasticity<D>& shells, std::span<const Vector<D>> position);

// Largest explicit step at these positions, s: substep_factor l0/c measured on the assembled shells, shrinking with the stiffest stretch.
template <int D>
double shell_time_step_limit(const ShellElasticity<D>& shells, std::span<const Vector<D>> position);

// Current unit normals (+ side) and areas (m2; 2-D: m).
template <int D>
void shell_normals_and_areas(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<Vector<D>> normal,
                             std::span<double> area);

// --- explicit sub-steps within one step of the blood (numerics-coupling.md 6.3) -------------------------------------------------------
template <int D>
struct ShellSubstepInput {
  std::span<const Vector<D>> external_force;          // N per row, constant over the sub-steps (blood F^n, gravity, loads); may be empty
  std::span<const double> added_mass;                 // m_e A, kg per row along the normal; empty = none
  std::span<const Vector<D>> added_normal;            // N of the added mass (current unit normals); with added_mass
  std::span<const Vector<D>> reference_acceleration;  // a^n, m/s2; with added_mass
  double duration = 0;                                // s
  double relaxation = 0;                              // s, of the motion along added_normal: forces K (x + relaxation v), Kelvin-Voigt
};
struct ShellSubstepReport {
  std::int64_t substeps = 0, limiter_hits = 0;
  double substep = 0;          // s
  std::int64_t contacts = 0;   // rows in contact at the last sub-step
  std::int64_t crossed = 0;    // of these, rows behind the other mid-surface
  double deepest_overlap = 0;  // m: largest contact distance minus gap
  double fastest = 0;          // m/s
};
// Advances position and velocity by `duration`: (m I + m_e A N N^T) dV = [f_el + f_contact + F + m_e A N (N . a^n)] dt in equal symplectic
// sub-steps of at most shell_time_step_limit. mean_force: time mean of f_el + f_contact, N. contact may be null.
template <int D>
ShellSubstepReport shell_substeps(const ShellElasticity<D>& shells, Contact<D>* contact, const ShellSubstepInput<D>& input,
                                  std::span<Vector<D>> position, std::span<Vector<D>> velocity, std::span<Vector<D>> mean_force);

// --- loads, statics, dry dynamics ------------------------------------------------------------------------------------------------------
// Adds the loads that act on shell rows at a time (force, acceleration, follower pressure against the + side), N.
template <int D>
void add_shell_loads(const ShellElasticity<D>& shells, const std::vector<Load<D>>& loads, double time, std::span<const Vector<D>> position,
                     std::span<Vector<D>> force);

template <int D>
using ShellLoad = std::function<void(std::span<const Vector<D>> position, std::span<Vector<D>> force)>;  // adds forces, N
struct ShellStaticReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0;  // largest force imbalance over the largest force
  std::string message;  // why not, or that the sheet is overloaded
};
// Equilibrium by Newton's method with line search (tangent by coloured differences), from the given positions.
template <int D>
ShellStaticReport solve_shell_equilibrium(const ShellElasticity<D>& shells, const ShellLoad<D>& load, std::span<Vector<D>> position,
                                          double tolerance = 1e-8, int iterations = 100);

// --- stress -----------------------------------------------------------------------------------------------------------------------------
enum class Face { minus, middle, plus };
// Cauchy stress, Pa, per row, at a face (the + face lies on the normal's side).
template <int D>
void shell_stress(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, Face face, std::span<Eigen::Matrix3d> stress);
// Largest in-plane principal stretch minus one, per row, over both faces, or of the mid-surface: for 'strain beyond the law's validity'.
enum class StrainOf { faces, middle };
template <int D>
void shell_largest_strain(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<double> strain,
                          StrainOf where = StrainOf::faces);

}  // namespace sim
