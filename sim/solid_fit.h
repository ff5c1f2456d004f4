// Least-squares fits of the displacement around each particle of the rest configuration: the discretisation of solid.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/solid.h"
#include "sim/solid_clamp.h"

namespace sim {

// Weighted quadratic fit through a particle: the displacement difference at offset R is modelled as Y m(R), m = monomials. Returns the rows
// s_j with Y = sum_j d_j s_j^T. Quadratic directions that the points hardly see (two layers: eigenvalue of their part of the moment matrix
// below 2e-3 of the weight, lengths in l0) are left out of the fit.
template <int D>
struct QuadraticFit {
  std::vector<FitRow<D>> shape;
  bool flat = false;                     // the points lie in one sheet: no gradient across it
  bool deficient = false;                // a quadratic direction was left out
  Vector<D> across = Vector<D>::Zero();  // that direction's normal
  double smallest_eigenvalue = 0;        // of the quadratic part, relative to the weight
};
template <int D>
QuadraticFit<D> quadratic_fit(std::span<const Vector<D>> offsets, std::span<const double> weights, double spacing);

// Weight of the fit: r_e / r - 1 for r < r_e, else 0; capped at its value for 0.4 l0.
double fit_weight(double distance, double radius, double spacing);

// Fills fits, links, partners and incoming lists of a structure whose per-row data stand.
template <int D>
void build_fits(SolidElasticity<D>& solid, const std::vector<ClampPoint<D>>& clamps, double kernel_radius,
                const std::vector<std::string>& body_names);

}  // namespace sim
