#include "sim/solid_loads.h"

#include "sim/solid_cell.h"
#include "sim/solid_surface.h"

namespace sim {

namespace {

// Pressure on a piece of the boundary; components that a clamp holds there go into its reaction.
template <int D>
void push_on_piece(const SolidElasticity<D>& solid, std::size_t i, const SurfacePiece<D>& piece, Vector<D> f, std::span<Vector<D>> force) {
  for (std::int64_t fit = solid.fit_begin[i]; fit < solid.fit_begin[i + 1]; ++fit)
    for (int k = 0; k < D; ++k)
      if ((solid.fits[fit].components >> k & 1) && held_there(solid, solid.fits[fit], piece)) f(k) = 0;
  add_force_at<D>(solid, i, piece.offset, f, force);
}

template <int D>
void add_pressure(const SolidElasticity<D>& solid, std::size_t i, double pressure, const SolidWork<D>& work, std::span<Vector<D>> force) {
  for (const SurfacePiece<D>& piece : surface_pieces<D>(solid, i)) {
    const Tensor<D> f = deformation_gradient<D>(work.derivatives[i], piece.offset);
    push_on_piece<D>(solid, i, piece, -pressure * (cofactor<D>(f) * piece.area), force);
  }
}

// A pressure load whose `share` holds 2 D numbers a row (area, m² (2-D: m), and offset from the particle, m, both at rest) pushes on these
// parts of the boundary alone; a row may come several times (at an edge: once a face).
template <int D>
void add_pressure_on_part(const SolidElasticity<D>& solid, const Load<D>& load, std::size_t r, double pressure, const SolidWork<D>& work,
                          std::span<Vector<D>> force) {
  const auto i = static_cast<std::size_t>(load.rows[r]);
  const Eigen::Map<const Vector<D>> area(load.share.data() + 2 * D * r), offset(load.share.data() + 2 * D * r + D);
  const Tensor<D> f = deformation_gradient<D>(work.derivatives[i], offset);
  push_on_piece<D>(solid, i, {offset, area}, -pressure * (cofactor<D>(f) * area), force);
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
      if (load.force && load.share.size() == (1 + D) * load.rows.size()) {
        const double* share = load.share.data() + (1 + D) * r;
        add_force_at<D>(solid, i, Eigen::Map<const Vector<D>>(share + 1), factor * *share * *load.force, force);
      } else if (load.force) {
        force[i] += factor * load.share[r] * *load.force;
      }
      if (load.acceleration) force[i] += factor * solid.mass[i] * load.acceleration(position[i], time);
      if (!load.pressure) continue;
      if (load.share.size() == 2 * D * load.rows.size())
        add_pressure_on_part(solid, load, r, factor * *load.pressure, work, force);
      else
        add_pressure(solid, i, factor * *load.pressure, work, force);
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
