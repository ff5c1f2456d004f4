#include "sim/solid_loads.h"

#include "sim/solid_cell.h"
#include "sim/solid_surface.h"

namespace sim {

namespace {

template <int D>
void add_pressure(const SolidElasticity<D>& solid, std::size_t i, double pressure, const SolidWork<D>& work, std::span<Vector<D>> force) {
  for (const SurfacePiece<D>& piece : surface_pieces<D>(solid, i)) {
    const Tensor<D> f = deformation_gradient<D>(work.derivatives[i], piece.offset);
    add_force_at<D>(solid, i, piece.offset, -pressure * (cofactor<D>(f) * piece.area), force);
  }
}

}  // namespace

template <int D>
bool follows_surface(const Load<D>& load) {
  return load.pressure.has_value();
}

template <int D>
void external_loads(const SolidElasticity<D>& solid, std::span<const Load<D>> loads, const std::optional<Vector<D>>& gravity, double time,
                    std::span<const Vector<D>> position, const SolidWork<D>& work, std::span<Vector<D>> force, double proportional) {
  const std::size_t n = solid.size();
  if (gravity)
    for (std::size_t i = 0; i < n; ++i) force[i] += proportional * solid.mass[i] * *gravity;
  for (const Load<D>& load : loads) {
    const double factor = load_factor(load, time) * (load.ramp > 0 || load.factor ? 1 : proportional);
    if (load.acceleration && load.rows.empty())
      for (std::size_t i = 0; i < n; ++i)
        if (solid.body[i] == load.body) force[i] += factor * solid.mass[i] * load.acceleration(position[i], time);
    for (std::size_t r = 0; r < load.rows.size(); ++r) {
      const auto i = static_cast<std::size_t>(load.rows[r]);
      if (i >= n) continue;  // a shell's row
      if (load.force) force[i] += factor * load.share[r] * *load.force;
      if (load.acceleration) force[i] += factor * solid.mass[i] * load.acceleration(position[i], time);
      if (load.pressure) add_pressure(solid, i, factor * *load.pressure, work, force);
    }
  }
}

#define SIM_INSTANTIATE(D)                                                                                                      \
  template bool follows_surface<D>(const Load<D>&);                                                                             \
  template void external_loads<D>(const SolidElasticity<D>&, std::span<const Load<D>>, const std::optional<Vector<D>>&, double, \
                                  std::span<const Vector<D>>, const SolidWork<D>&, std::span<Vector<D>>, double);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
