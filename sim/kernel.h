// The MPS weight and the constants of the undisturbed lattice (paper Eqs 14, 15, 19).
#pragma once

#include <algorithm>
#include <cmath>

namespace sim {

// Weight, Eq (14) in its usual form: w(r) = r_e/r - 1 for 0 < r < r_e, else 0; continuous at r_e. r, r_e: m. Result: -.
// Distances below `closest` count as `closest`, so that coincident particles give a large finite weight.
inline double weight(double distance, double radius, double closest) {
  return distance < radius ? radius / std::max(distance, closest) - 1.0 : 0.0;
}

// Weight as printed in Eq (14), w(r) = r_e/r: jumps by 1 at r_e. Kept as an exhibit (scheme.literal_weight).
inline double literal_weight(double distance, double radius, double closest) {
  return distance < radius ? radius / std::max(distance, closest) : 0.0;
}

// Sums over the undisturbed square or cubic lattice of spacing l0.
struct Lattice {
  int dimension = 3;
  double spacing = 0;           // l0, m
  double radius = 0;            // r_e, m
  double number_density = 0;    // n0, Eq (15), -
  double laplacian_lambda = 0;  // Eq (19), m²
  double closest() const { return 0.5 * spacing; }
  // d / n0: factor of the gradient and divergence, Eqs (16), (17)
  double gradient_factor() const { return dimension / number_density; }
  // 2 d / (lambda n0): factor of the Laplacian, Eq (18), 1/m²
  double laplacian_factor() const { return 2.0 * dimension / (laplacian_lambda * number_density); }
};

// Lattice constants for `dimension` 2 or 3, spacing l0 > 0 (m) and radius r_e (m).
Lattice make_lattice(int dimension, double spacing, double radius, bool literal = false);

}  // namespace sim
