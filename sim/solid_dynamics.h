// Motion of elastic solids over one step of the whole scene: explicit sub-steps where they are few, otherwise implicit steps.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/solid_loads.h"
#include "sim/solid_tangent.h"

namespace sim {

template <int D>
struct SolidStepInput {
  double time = 0, duration = 0;              // s: from time to time + duration
  std::span<const Vector<D>> external_force;  // N per row, constant over the step (blood); may be empty
  std::span<const Load<D>> loads;             // evaluated inside the step
  std::optional<Vector<D>> gravity;           // m/s^2
  // Inertia of blood that a row pushes along a direction (numerics-coupling.md 6.3): (m I + m_e N N^T) dv = [f + m_e N (N . a^n)] dt.
  std::span<const double> added_mass;                 // m_e, kg per row (0 = none); may be empty
  std::span<const Vector<D>> added_direction;         // unit N, with added_mass
  std::span<const Vector<D>> reference_acceleration;  // a^n, m/s^2, with added_mass
  double substep_factor = 0.35;                       // of l0/c (SchemeSettings::elastic_substep)
  int explicit_limit = 200;                           // SchemeSettings::elastic_explicit_limit; 0 = always implicit
  double tolerance = 1e-8;                            // of the implicit solve, relative to the step's largest displacement
};

struct SolidStepReport {
  std::int64_t substeps = 0;  // explicit sub-steps, or implicit steps
  bool implicit = false;
  int newton_iterations = 0, factorisations = 0;
  double load_work = 0;     // J done by loads and gravity (not by external_force)
  double damping_loss = 0;  // J
};

// What the solids' motion keeps between steps: scratch and the factorised matrix. A run continued from a checkpoint makes the factor again
// where it was made (work_memory.h). One per solver.
template <int D>
struct SolidMotion {
  SolidWork<D> work;
  std::vector<Vector<D>> force, other;
  std::optional<SolidPattern<D>> pattern;
  Eigen::SparseMatrix<double> matrix;
  SymmetricSolver solver;
  double factorised_for = 0;             // s, the d*h of the factor in `solver`; 0 = none
  std::vector<Vector<D>> factorised_at;  // m, positions it was made at
  bool factor_lost = false;              // factorised_for and factorised_at are known, the factor itself has to be made again
};

// Advances position and velocity (first n rows) by input.duration. mean_force: time mean of everything but external_force and the added
// mass's reference, such that m (v_end - v_start) balances exactly, N; may be empty. Held axes stay where they are, with zero velocity.
// Throws std::runtime_error where an implicit step does not converge even in pieces.
template <int D>
SolidStepReport advance_solids(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion,
                               std::span<Vector<D>> position, std::span<Vector<D>> velocity, std::span<Vector<D>> mean_force);

// The two ways, as advance_solids chooses between them.
template <int D>
SolidStepReport solid_substeps(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, std::int64_t substeps,
                               SolidMotion<D>& motion, std::span<Vector<D>> position, std::span<Vector<D>> velocity);
// TR-BDF2 (Bank et al. 1985; in structural dynamics Bathe 2007): a trapezoidal stage to t + (2 - sqrt 2) h, then second-order backward
// differences; second order, L-stable, no free parameter, no memory beyond position and velocity.
template <int D>
SolidStepReport solid_implicit_step(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion,
                                    std::span<Vector<D>> position, std::span<Vector<D>> velocity);

// The operator M + c K at given positions, factorised: for a projection that couples pressure and elasticity in one system
// (numerics-coupling.md, scheme B3; c = (theta dt)^2).
template <int D>
class SolidOperator {
 public:
  void factorise(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, double c);
  // rhs and solution per row (held axes 0 in the solution).
  void solve(std::span<const Vector<D>> rhs, std::span<Vector<D>> solution) const;
  // What the present factor was made of; empty and 0 before the first.
  const std::vector<Vector<D>>& factorised_at() const { return factorised_at_; }
  double factorised_for() const { return factorised_for_; }

 private:
  std::vector<Vector<D>> factorised_at_;  // m
  double factorised_for_ = 0;             // c
  std::optional<SolidPattern<D>> pattern_;
  Eigen::SparseMatrix<double> matrix_;
  SolidWork<D> work_;
  SymmetricSolver solver_;
};

}  // namespace sim
