// Corrects the fits so that a uniform stress is in exact equilibrium with the tractions on the body's surface (and with a clamp's
// reaction).
#pragma once

#include "sim/solid.h"

namespace sim {

// Nodal integration of a least-squares gradient leaves forces in a uniformly stressed body within two layers of every boundary: the sum
// over particles of V_i d(grad u)_i/du_j is not the surface area that acts at j. The gradients' coefficients are changed as little as
// possible (least squares, weighted with the fit's own weights) so that
//   sum_i V_i dG_i/du_j = sum over surface pieces s of A_s (weight of u_j in the fitted displacement at s)      for every free j,
// while each fit stays exact for quadratic displacements. The change is g_l += V_i w_l e_l(mu), e_l the fit's residual of a multiplier
// field mu, which solves (sum_i V_i^2 E_i^T W E_i) mu = mismatch. (Summation by parts for meshfree gradients; compare the variational
// consistency of Chen, Hillman & Ruter 2013, here in symmetric form.) Returns the largest relative mismatch left.
template <int D>
double make_consistent(SolidElasticity<D>& solid);

}  // namespace sim
