#include "sim/rheology.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

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

namespace {

// x^e for positive normal x and moderate |e log2 x| < 1000, without branches so that loops over it vectorise: 3 ns
// where Eigen's array pow takes 21. x = 2^k m with m around 1;
// log2 m by the series of artanh((m - 1)/(m + 1)), then 2^y by Taylor's series about the nearest whole y.
inline double power(double x, double e) {
  constexpr double ln2 = 0.693147180559945309417, to_whole = 0x1.8p52;
  constexpr std::int64_t root_half = 0x3fe6a09e667f3bcd;
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t k = (bits - root_half) >> 52;
  const double m = std::bit_cast<double>(bits - (k << 52)), s = (m - 1) / (m + 1), z = s * s;
  double series = 1.0 / 21;
  for (const double odd : {19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0}) series = series * z + 1 / odd;
  const double y = e * (static_cast<double>(k) + 2 / ln2 * s * series);
  const double shifted = y + to_whole, whole = shifted - to_whole, f = (y - whole) * ln2;
  double result = 1;
  for (const double order : {13.0, 12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0}) result = 1 + result * f * (1 / order);
  const std::int64_t exponent = std::bit_cast<std::int64_t>(shifted) - std::bit_cast<std::int64_t>(to_whole);
  return result * std::bit_cast<double>((exponent + 1023) << 52);
}

}  // namespace

void viscosities(const Rheology& rheology, std::span<double> rate, double limit) {
  const auto* blood = std::get_if<HerschelBulkley>(&rheology);
  if (!blood || std::abs(blood->index - 1) > 1) {
    for (double& value : rate) value = viscosity(rheology, value, limit);
    return;
  }
  const double at_rest = herschel_bulkley_viscosity(*blood, 0, limit), factor = blood->consistency, less = blood->index - 1,
               yield = blood->yield_stress;
  double* values = rate.data();
#pragma omp simd
  for (std::size_t k = 0; k < rate.size(); ++k) {
    const double moving = std::max(values[k], 1e-12), mu = std::min(limit, factor * power(moving, less) + yield / moving);
    values[k] = values[k] > 1e-12 ? mu : at_rest;
  }
}

bool shear_rate_matters(const Rheology& rheology) { return !std::holds_alternative<Newtonian>(rheology); }

bool is_inviscid(const Rheology& rheology) {
  const auto* newtonian = std::get_if<Newtonian>(&rheology);
  return newtonian && newtonian->viscosity == 0;
}

}  // namespace sim
