#include <stdexcept>

#include "sim/shell_kernel.h"

namespace sim {

// Forces shared over rows, accelerations times mass, and pressures that follow the surface: -p A n on each row (against the + side).
template <int D>
void add_shell_loads(const ShellElasticity<D>& shells, const std::vector<Load<D>>& loads, double time, std::span<const Vector<D>> position,
                     std::span<Vector<D>> force) {
  std::vector<Padded<D>> x;
  for (const Load<D>& load : loads) {
    const double factor = load_factor(load, time);
    for (std::size_t k = 0; k < load.rows.size(); ++k) {
      const std::int64_t row = load.rows[k] - shells.first_row;
      if (row < 0 || row >= static_cast<std::int64_t>(shells.size())) continue;
      const auto i = static_cast<std::int32_t>(row);
      if (load.force) force[i] += factor * load.share[k] * *load.force;
      if (load.acceleration) force[i] += factor * shells.mass[i] * load.acceleration(position[i], time);
      if (load.pressure) {
        if (x.empty())
          for (const auto& p : position) x.push_back(pad<D>(p));
        const auto kinematics = shell_kernel::kinematics(shells, x.data(), i);
        force[i] -= (factor * *load.pressure * shells.area[i] * kinematics.area_ratio) * kinematics.normal.template head<D>();
      }
    }
  }
}

template void add_shell_loads<2>(const ShellElasticity<2>&, const std::vector<Load<2>>&, double, std::span<const Vector<2>>,
                                 std::span<Vector<2>>);
template void add_shell_loads<3>(const ShellElasticity<3>&, const std::vector<Load<3>>&, double, std::span<const Vector<3>>,
                                 std::span<Vector<3>>);

}  // namespace sim
