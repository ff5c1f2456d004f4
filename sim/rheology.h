// Viscosity of blood as a function of its shear rate (paper Eqs 8-10, 12, 13).
#pragma once

#include <span>

#include "sim/scene_description.h"

namespace sim {

// Shear rate sqrt(2 D:D) of a velocity gradient (paper Eq 9), 1/s; D = (grad v + grad v^T)/2 (Eq 10).
template <int D>
double shear_rate(const Tensor<D>& velocity_gradient) {
  const Tensor<D> rate = 0.5 * (velocity_gradient + velocity_gradient.transpose());
  return std::sqrt(2.0 * rate.squaredNorm());
}

// mu = m g^(n-1) + tau0/g (Eq 8), Pa s. Both terms grow without bound as g -> 0: capped at `limit` (Pa s), where the blood moves as a
// plug (Eqs 12, 13).
double herschel_bulkley_viscosity(const HerschelBulkley& blood, double shear_rate, double limit);
// sqrt(tau) = sqrt(tau0) + sqrt(mu_inf g): mu = (sqrt(tau0/g) + sqrt(mu_inf))², Pa s, capped.
double casson_viscosity(const Casson& blood, double shear_rate, double limit);
double viscosity(const Rheology& rheology, double shear_rate, double limit);
// The same for many shear rates, which their viscosities replace; the power law to 1e-15.
void viscosities(const Rheology& rheology, std::span<double> shear_rate, double limit);
bool shear_rate_matters(const Rheology& rheology);
bool is_inviscid(const Rheology& rheology);

}  // namespace sim
