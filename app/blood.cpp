#include "app/blood.h"

#include <algorithm>
#include <cmath>

namespace app {

// Anchored at a haematocrit of 45: tau0 = 0.0175 Pa (capillary-tube rheometer, healthy donors), m = 0.0089721 Pa s^n and n = 0.8601 of the
// same group. Away from it: tau0 grows as (Ht - 6)^3 (Merrill et al. 1963), 1 - n in proportion to Ht (Walburn and Schneck 1976), and the
// viscosity at 100 1/s as exp(0.0282 Ht) (Snyder 1971 at 37 C). At 0 this leaves plasma as a Newtonian fluid of 1.3 mPa s.
sim::HerschelBulkley blood_rheology(double hematocrit) {
  constexpr double anchor = 45, yield_at_anchor = 0.0175, consistency_at_anchor = 0.0089721, index_at_anchor = 0.8601;
  constexpr double yield_onset = 6, growth = 0.0322 - 1.08e-4 * 37, shear_rate = 100;
  const double excess = std::max(0.0, hematocrit - yield_onset) / (anchor - yield_onset);
  sim::HerschelBulkley result;
  result.yield_stress = yield_at_anchor * excess * excess * excess;
  result.index = 1 - (1 - index_at_anchor) * hematocrit / anchor;
  const double viscosity = consistency_at_anchor * std::pow(shear_rate, index_at_anchor - 1) * std::exp(growth * (hematocrit - anchor));
  result.consistency = viscosity * std::pow(shear_rate, 1 - result.index);
  return result;
}

double blood_density(double hematocrit) { return 1025 + (1100 - 1025) * hematocrit / 100; }

}  // namespace app
