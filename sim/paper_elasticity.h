// The published elastic body, Eqs (16), (20)-(24), in the stable form of numerics-elastic.md 3(i). It is kept to show what the method does,
// with its known bias: to leading order Eqs (21), (22), (24) are the operators of another material,
//   G_eff = 0.7 G + 0.2 lambda,  lambda_eff = 0.2 (G + lambda)      (three dimensions),
// about ten times too stiff at nu = 0.49. Use the solids of solid.h where the answer matters.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/elastic_law.h"
#include "sim/particles.h"
#include "sim/scene_description.h"

namespace sim {

template <int D>
struct PaperElasticity {
  double spacing = 0, radius = 0;  // l0 and r_e, m
  double full_density = 0;         // n0 (Eq 15) of the full lattice
  double laplacian_lambda = 0;     // Lambda (Eq 19) of the full lattice, m^2
  std::vector<Vector<D>> rest;
  std::vector<double> density;  // kg/m^3
  std::vector<LameModuli> moduli;
  std::vector<std::uint8_t> fixed;
  std::vector<std::int64_t> begin;  // pairs of row i: [begin[i], begin[i+1]); within a body only
  std::vector<std::int32_t> neighbor;
  std::vector<Vector<D>> offset;  // r0_ij, m
  std::vector<double> weight;     // w(|r0_ij|)
  std::size_t size() const { return rest.size(); }
};

// Rows of elastic and shell bodies, in the order of State. Throws std::invalid_argument on impossible constants.
template <int D>
PaperElasticity<D> build_paper_elasticity(const SceneDescription<D>& scene);

// Rotation R_i of every row (Eq 24): polar decomposition of F_i = sum w r_ij (x) r0_ij (sum w r0 (x) r0)^-1; in a single layer the normal
// turns with the layer.
template <int D>
void paper_rotations(const PaperElasticity<D>& elasticity, std::span<const Vector<D>> position, std::span<Tensor<D>> rotation);

// (lambda + G) grad div u + G lap u of Eqs (21)-(23), with u_ij from Eq (24): force per volume, N/m^3.
template <int D>
void paper_elastic_force(const PaperElasticity<D>& elasticity, std::span<const Vector<D>> position, std::span<const Tensor<D>> rotation,
                         std::span<Vector<D>> force);

struct PaperStepReport {
  bool converged = false;
  int outer_iterations = 0, inner_iterations = 0;
  double change = 0;  // m, the last outer iteration's largest
};
// One step of Eq (20), implicit in u and r: outer iterations freeze directions and rotations and solve a symmetric positive definite system
// by conjugate gradients, until nothing moves by more than 1e-6 l0, at most `outer_limit` times. external: force per volume, N/m^3.
// position, velocity: in at t, out at t + dt; the velocity is the backward difference that Eq (20) needs next.
template <int D>
PaperStepReport paper_elastic_step(const PaperElasticity<D>& elasticity, std::span<const Vector<D>> external, double step, int outer_limit,
                                   std::span<Vector<D>> position, std::span<Vector<D>> velocity);

// Stress by Eqs (16), (4), (3), turned with the particle, Pa.
template <int D>
void paper_stress(const PaperElasticity<D>& elasticity, std::span<const Vector<D>> position, std::vector<Eigen::Matrix3d>& cauchy);

// The material that the scheme simulates to leading order (isotropic average): for D = 3 the numbers above; for D = 2
// G_eff = (3 G + lambda)/4, lambda_eff = (lambda + G)/4.
LameModuli paper_effective_moduli(const LameModuli& moduli, int dimension);

}  // namespace sim
