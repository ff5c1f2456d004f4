// Constitutive laws of elastic bodies: stored energy and first Piola-Kirchhoff stress as pure functions of the deformation gradient of
// one particle. D = 3, or D = 2 in plane strain or plane stress (the plane-stress form is also a shell's membrane law).
#pragma once

#include "sim/particles.h"
#include "sim/scene_description.h"

namespace sim {

// Lame's constants, Pa: lambda = nu E / ((1+nu)(1-2nu)), G = E / (2(1+nu))  (paper, after Eq 5).
struct LameModuli {
  double lame_lambda = 0, shear_modulus = 0;
};
// youngs_modulus > 0 (Pa), -1 < poisson_ratio < 0.5; throws std::invalid_argument outside.
LameModuli lame_moduli(double youngs_modulus, double poisson_ratio);

// The lambda that a sheet free to thin feels in its plane: 2 G lambda / (lambda + 2 G) = nu E / (1 - nu^2), Pa. At most 2 G, so it stays
// finite as nu -> 0.5; it is also the lambda of the strain's variation within a particle's cell (numerics-elastic.md 3(ii)).
double plane_stress_lambda(const LameModuli& moduli);

// A material point: the law with its constants there.
template <int D>
struct ElasticLawPoint {
  ElasticLaw law = ElasticLaw::neo_hookean;
  LameModuli moduli;                    // Pa, of the matrix for fibre_reinforced
  bool plane_stress = false;            // D = 2 only
  double fibre_modulus = 0;             // k1, Pa
  double fibre_stiffening = 0;          // k2, -
  double fibre_limit = 0.35;            // I4 - 1 where the fibre's stress goes on linearly
  Vector<D> fibre = Vector<D>::Zero();  // unit direction at rest; zero = no fibre here
};

// The point of a body's material; stiffness_scale multiplies every modulus (calcified spots). Throws std::invalid_argument on
// impossible constants.
template <int D>
ElasticLawPoint<D> law_point(const ElasticMaterial& material, double stiffness_scale, const Vector<D>& fibre);

// dP/dF with F and P flattened column by column: element (a + D b, c + D e) = dP_ab / dF_ce, Pa.
template <int D>
using ElasticTangent = Eigen::Matrix<double, D * D, D * D>;

// Stored energy per rest volume, J/m^3, zero at F = I. F = I + grad u, dimensionless. Laws (lambda, G of the point; F = R S):
//   linear              G eps:eps + lambda/2 tr^2 eps, eps = sym(F) - I   (paper Eqs 3-5; not rotation invariant)
//   corotated           G |S - I|^2 + lambda/2 tr^2(S - I)
//   st-venant-kirchhoff G E:E + lambda/2 tr^2 E, E = (F^T F - I)/2
//   neo-hookean         G/2 (I1 - 3 - 2 ln J) + lambda/2 (ln J)^2; for J < 0.05 ln J is continued by its second-order Taylor polynomial
//   fibre-reinforced    neo-hookean + k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1) for I4 = |F a|^2 > 1 (Holzapfel, Gasser & Ogden 2000)
template <int D>
double energy_density(const ElasticLawPoint<D>& point, const Tensor<D>& deformation_gradient);

// P = d(energy_density)/dF, Pa.
template <int D>
Tensor<D> first_piola_kirchhoff(const ElasticLawPoint<D>& point, const Tensor<D>& deformation_gradient);

template <int D>
ElasticTangent<D> elastic_tangent(const ElasticLawPoint<D>& point, const Tensor<D>& deformation_gradient);

// The volumetric strain theta of the law's term lambda/2 theta^2: tr eps, tr(S - I), tr E or ln J (plane strain and 3-D), and d theta/dF.
template <int D>
double volumetric_strain(ElasticLaw law, const Tensor<D>& deformation_gradient);
template <int D>
Tensor<D> volumetric_strain_gradient(ElasticLaw law, const Tensor<D>& deformation_gradient);
// d^2 theta / dF^2
template <int D>
ElasticTangent<D> volumetric_strain_hessian(ElasticLaw law, const Tensor<D>& deformation_gradient);

// Stretch across the plane (D = 2, plane stress): the lambda_3 at which the stress across vanishes, > 0; 1 in plane strain.
double thickness_stretch(const ElasticLawPoint<2>& point, const Tensor<2>& deformation_gradient);

// Rotation R of F = R S (polar decomposition); the nearest rotation where det F <= 0.
template <int D>
Tensor<D> polar_rotation(const Tensor<D>& deformation_gradient);

// J F^-T, without dividing by J.
template <int D>
Tensor<D> cofactor(const Tensor<D>& matrix);

// Speed of pressure waves in the undeformed body, m/s: sqrt((lambda + 2G) / rho), fibres included; plane stress: sqrt(E/((1-nu^2) rho)).
template <int D>
double wave_speed(const ElasticLawPoint<D>& point, double density);

}  // namespace sim
