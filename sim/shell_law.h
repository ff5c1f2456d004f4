// Plane-stress laws of a thin sheet in terms of its metric C (2 x 2, in the orthonormal rest tangents): the sheet is free to change its
// thickness. Pure functions. A 2-D beam in plane strain is the sheet whose second direction is not stretched: C = diag(C11, 1).
#pragma once

#include <Eigen/Core>

#include "sim/scene_description.h"

namespace sim {

// Symmetric 2 x 2 tensor in the sheet's rest tangents.
struct SheetTensor {
  double xx = 0, yy = 0, xy = 0;
  SheetTensor operator+(const SheetTensor& o) const { return {xx + o.xx, yy + o.yy, xy + o.xy}; }
  SheetTensor operator-(const SheetTensor& o) const { return {xx - o.xx, yy - o.yy, xy - o.xy}; }
  SheetTensor operator*(double f) const { return {xx * f, yy * f, xy * f}; }
  double trace() const { return xx + yy; }
  double determinant() const { return xx * yy - xy * xy; }
  // this : other
  double dot(const SheetTensor& o) const { return xx * o.xx + yy * o.yy + 2 * xy * o.xy; }
};

// Constants of a sheet's material.
struct SheetMaterial {
  ElasticLaw law = ElasticLaw::neo_hookean;
  double youngs_modulus = 0, poisson_ratio = 0;                     // Pa, -
  double shear_modulus = 0, lame_lambda = 0;                        // Pa
  double sheet_lambda = 0;                                          // nu E / (1 - nu^2), Pa: lambda of small strains in plane stress
  double fibre_modulus = 0, fibre_stiffening = 0, fibre_limit = 0;  // k1 Pa, k2, largest I4 - 1 of the exponential
  bool narrow = false;                                              // 2-D beam in plane stress: free to contract sideways
};
// Throws std::invalid_argument on impossible constants.
SheetMaterial sheet_material(const ElasticMaterial& material);

// Second Piola-Kirchhoff stress S = 2 dW/dC, Pa, with dS/dC bounded: where an eigenvalue of C falls below 0.16 (stretch 0.4) the law goes
// on with constant stiffness E; `limited` is set there. fibre = (cos, sin) of the fibre against the rest tangents, (0, 0) for none. Laws
// (numerics-elastic.md 3(ii), numerics-closure.md): st_venant_kirchhoff, corotated and linear (= corotated: a sheet turns), neo_hookean W =
// G/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2 with C33 from S33 = 0, fibre_reinforced = neo_hookean + k1/(2 k2) (exp(k2 x^2) - 1), x = I4 - 1
// > 0, stress going on linearly in x beyond fibre_limit.
SheetTensor sheet_stress(const SheetMaterial& material, const SheetTensor& metric, const Eigen::Vector2d& fibre, bool* limited = nullptr);
// W, J/m^3.
double sheet_energy(const SheetMaterial& material, const SheetTensor& metric, const Eigen::Vector2d& fibre);
// C33 at S33 = 0, > 0: the square of the thickness stretch.
double thickness_metric(const SheetMaterial& material, const SheetTensor& metric);
// Second fibre stress S_f(x) = 2 k1 x exp(k2 x^2) and its slope dS_f/dx, Pa.
double fibre_stress(const SheetMaterial& material, double x);
double fibre_stress_slope(const SheetMaterial& material, double x);
// Largest stiffness d(first Piola stress)/d(stretch) near the metric, Pa: what the time step must resolve.
double largest_tangent(const SheetMaterial& material, const SheetTensor& metric, const Eigen::Vector2d& fibre);

// Pressure beyond which a cylinder of this sheet has no equilibrium: G h / R for an isotropic neo-Hookean sheet (its hoop stress
// saturates), infinite for laws that stiffen. thickness and radius m. Pa.
double limit_pressure(const SheetMaterial& material, double thickness, double radius);

}  // namespace sim
