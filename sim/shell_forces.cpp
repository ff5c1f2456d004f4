#include <algorithm>

#include "sim/shell_kernel.h"

namespace sim {

using namespace shell_kernel;

namespace {
template <int D>
std::vector<Padded<D>> padded(std::span<const Vector<D>> values) {
  std::vector<Padded<D>> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[i] = pad<D>(values[i]);
  return result;
}
}  // namespace

template <int D>
std::int64_t shell_forces(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<const Vector<D>> velocity,
                          std::span<Vector<D>> force) {
  const auto rows = static_cast<std::int32_t>(shells.size());
  const std::vector<Padded<D>> x = padded<D>(position), v = padded<D>(velocity);
  std::vector<std::array<Padded<D>, terms<D>>> derivative(shells.size());
  std::vector<Padded<D>> own(shells.size());
  std::int64_t limited_rows = 0;
#pragma omp parallel reduction(+ : limited_rows) if (rows > 200)
  {
#pragma omp for schedule(static)
    for (std::int32_t i = 0; i < rows; ++i) {
      Padded<D> normal;
      limited_rows += differentiate_row(shells, x.data(), v.data(), i, derivative[i], own[i], normal);
    }
#pragma omp for schedule(static)
    for (std::int32_t j = 0; j < rows; ++j) force[j] = (own[j] + gather_force(shells, derivative.data(), j)).template head<D>();
  }
  return limited_rows;
}

template <int D>
double shell_energy(const ShellElasticity<D>& shells, std::span<const Vector<D>> position) {
  const std::vector<Padded<D>> x = padded<D>(position);
  double total = 0;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(shells.size()); ++i) {
    const bool held = is_clamped(shells, i);
    if (idle(shells, i)) continue;
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    const ShellBody& body = shells.bodies[shells.body[i]];
    const double volume = shells.area[i] * body.thickness * shells.stiffness_scale[i], z = body.bending_thickness / (2 * std::sqrt(3.0));
    const double both = 0.5 * (sheet_energy(body.material, k.metric - k.curvature * (2 * z), shells.fibre[i]) +
                               sheet_energy(body.material, k.metric + k.curvature * (2 * z), shells.fibre[i]));
    const double membrane = sheet_energy(body.material, k.metric, shells.fibre[i]);
    total += volume * (shells.membrane_weight[i] * membrane + shells.bending_weight[i] * (both - membrane));
    if (held) continue;
    const double cell = volume * (D == 3 ? shells.area[i] : shells.area[i] * shells.area[i]) / 24;
    for (int direction = 0; direction < D - 1; ++direction) {
      const SheetTensor gamma = strain_gradient(k, direction);
      total += cell * plane_stress_hooke(body.material, gamma).dot(gamma);
    }
  }
  return total;
}

template <int D>
double shell_time_step_limit(const ShellElasticity<D>& shells, std::span<const Vector<D>> position) {
  if (shells.empty()) return std::numeric_limits<double>::infinity();
  const std::vector<Padded<D>> x = padded<D>(position);
  double stiffest = 1;  // of the unloaded matrix
  const auto rows = static_cast<std::int32_t>(shells.size());
#pragma omp parallel for schedule(static) reduction(max : stiffest) if (rows > 200)
  for (std::int32_t i = 0; i < rows; ++i) {
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    const ShellBody& body = shells.bodies[shells.body[i]];
    const double small = body.material.sheet_lambda + 2 * body.material.shear_modulus, z = body.bending_thickness / (2 * std::sqrt(3.0));
    for (double side : {-1.0, 1.0})
      stiffest = std::max(stiffest, largest_tangent(body.material, k.metric + k.curvature * (2 * z * side), shells.fibre[i]) / small);
  }
  return shells.rest_step / std::sqrt(stiffest);
}

template <int D>
void shell_normals_and_areas(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, std::span<Vector<D>> normal,
                             std::span<double> area) {
  const std::vector<Padded<D>> x = padded<D>(position);
  const auto rows = static_cast<std::int32_t>(shells.size());
#pragma omp parallel for schedule(static) if (rows > 200)
  for (std::int32_t i = 0; i < rows; ++i) {
    const Kinematics<D> k = kinematics(shells, x.data(), i);
    normal[i] = k.normal.template head<D>();
    area[i] = shells.area[i] * k.area_ratio;
  }
}

#define CUSP_INSTANTIATE(D)                                                                                                \
  template std::int64_t shell_forces<D>(const ShellElasticity<D>&, std::span<const Vector<D>>, std::span<const Vector<D>>, \
                                        std::span<Vector<D>>);                                                             \
  template double shell_energy<D>(const ShellElasticity<D>&, std::span<const Vector<D>>);                                  \
  template double shell_time_step_limit<D>(const ShellElasticity<D>&, std::span<const Vector<D>>);                         \
  template void shell_normals_and_areas<D>(const ShellElasticity<D>&, std::span<const Vector<D>>, std::span<Vector<D>>, std::span<double>);
CUSP_INSTANTIATE(2)
CUSP_INSTANTIATE(3)
#undef CUSP_INSTANTIATE

}  // namespace sim
