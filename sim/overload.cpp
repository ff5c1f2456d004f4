#include "sim/overload.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace sim {
namespace {

constexpr double largest_strain = 0.75;

// Radius of a dome of the body's area at rest, m: a half circle (2-D), a half sphere.
template <int D>
double dome_radius(const ShellBody& body) {
  const double area = body.count * std::pow(body.spacing, D - 1);
  return D == 2 ? area / std::numbers::pi : std::sqrt(area / (2 * std::numbers::pi));
}

}  // namespace

template <int D>
std::optional<Overload> overload(const Scene<D>& scene, const State<D>& state) {
  if (!scene.shells) return std::nullopt;
  const ShellElasticity<D>& shells = *scene.shells;
  const std::size_t first = static_cast<std::size_t>(scene.elastic_count);
  std::vector<double> strain(shells.size());
  shell_largest_strain<D>(shells, std::span(state.position).subspan(first, shells.size()), strain, StrainOf::middle);
  std::optional<Overload> worst;
  for (std::size_t b = 0; b < shells.bodies.size(); ++b) {
    const ShellBody& body = shells.bodies[b];
    std::vector<std::size_t> rows(static_cast<std::size_t>(body.count));
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::size_t>(body.first) + k;
    const std::size_t rank = rows.size() / 100;
    std::nth_element(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(rank), rows.end(),
                     [&](std::size_t p, std::size_t q) { return strain[p] != strain[q] ? strain[p] > strain[q] : p < q; });
    const std::size_t row = rows[rank];
    if (strain[row] <= largest_strain || (worst && strain[row] <= worst->strain)) continue;
    worst = Overload{strain[row], static_cast<std::int32_t>(b), Eigen::Vector3d::Zero(), state.time};
    worst->place.head<D>() = state.position[first + row];
  }
  return worst;
}

template <int D>
std::string overload_message(const Scene<D>& scene, const Overload& overload) {
  const ShellBody& body = scene.shells->bodies[static_cast<std::size_t>(overload.shell)];
  const double radius = dome_radius<D>(body);
  SheetMaterial matrix = body.material;
  const bool fibres = matrix.law == ElasticLaw::fibre_reinforced;
  if (fibres) matrix.law = ElasticLaw::neo_hookean;
  const double limit = limit_pressure(matrix, body.thickness, radius);
  char bears[160] = "";
  if (std::isfinite(limit))
    std::snprintf(bears, sizeof bears, "; %s its law bears at most G h / R = %.3g kPa on a dome of its size (R = %.3g mm)",
                  fibres ? "across the fibres" : "in every direction", 1e-3 * limit, 1e3 * radius);
  char text[480];
  std::snprintf(text, sizeof text,
                "overloaded: '%s' is stretched by %.0f %% at (%.4g, %.4g, %.4g) mm at t = %.4g s, more than tissue bears%s; "
                "make youngs_modulus or thickness larger, or the pressure smaller",
                scene.description.bodies[static_cast<std::size_t>(body.body)].name.c_str(), 100 * overload.strain, 1e3 * overload.place[0],
                1e3 * overload.place[1], 1e3 * overload.place[2], overload.time, bears);
  return text;
}

#define INSTANTIATE(D)                                                            \
  template std::optional<Overload> overload<D>(const Scene<D>&, const State<D>&); \
  template std::string overload_message<D>(const Scene<D>&, const Overload&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
