#include "sim/rheology.h"

#include <algorithm>
#include <cmath>

namespace sim {

double herschel_bulkley_viscosity(const HerschelBulkley& blood, double shear_rate, double limit) {
  if (!(shear_rate > 1e-12))
    return blood.yield_stress > 0 || blood.index < 1 ? limit : std::min(limit, blood.index > 1 ? 0.0 : blood.consistency);
  return std::min(limit, blood.consistency * std::pow(shear_rate, blood.index - 1) + blood.yield_stress / shear_rate);
}

double casson_viscosity(const Casson& blood, double shear_rate, double limit) {
  if (!(shear_rate > 1e-12)) return blood.yield_stress > 0 ? limit : blood.viscosity;
  const double root = std::sqrt(blood.yield_stress / shear_rate) + std::sqrt(blood.viscosity);
  return std::min(limit, root * root);
}

double viscosity(const Rheology& rheology, double shear_rate, double limit) {
  if (const auto* newtonian = std::get_if<Newtonian>(&rheology)) return newtonian->viscosity;
  if (const auto* casson = std::get_if<Casson>(&rheology)) return casson_viscosity(*casson, shear_rate, limit);
  return herschel_bulkley_viscosity(std::get<HerschelBulkley>(rheology), shear_rate, limit);
}

bool shear_rate_matters(const Rheology& rheology) { return !std::holds_alternative<Newtonian>(rheology); }

bool is_inviscid(const Rheology& rheology) {
  const auto* newtonian = std::get_if<Newtonian>(&rheology);
  return newtonian && newtonian->viscosity == 0;
}

}  // namespace sim
