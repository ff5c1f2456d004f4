#include "sim/solid_surface.h"

#include <algorithm>
#include <cmath>

namespace sim {

template <int D>
SurfacePieces<D> surface_pieces(const SolidElasticity<D>& solid, std::size_t row) {
  SurfacePieces<D> pieces;
  if (!solid.surface_begin.empty() && solid.surface_begin[row + 1] > solid.surface_begin[row]) {
    for (std::int64_t p = solid.surface_begin[row]; p < solid.surface_begin[row + 1] && pieces.count < pieces.most; ++p)
      pieces.piece[pieces.count++] = {solid.piece_offset[p], solid.piece_area[p]};
    return pieces;
  }
  const Vector<D>& area = solid.surface_area[row];
  const double size = area.norm(), depth = solid.depth[row];
  if (size < 1e-9 * std::pow(solid.spacing, D - 1)) return pieces;
  // A lattice cell's faces lie half a pitch away, the pitch being volume / face area; the particle's depth is the smallest of these.
  double nearest = 1e300;
  for (int k = 0; k < D; ++k)
    if (std::abs(area(k)) > 1e-6 * size) nearest = std::min(nearest, solid.volume[row] / (2 * std::abs(area(k))));
  if (std::abs(nearest - depth) < 1e-4 * depth) {
    for (int k = 0; k < D; ++k) {
      if (std::abs(area(k)) <= 1e-6 * size) continue;
      SurfacePiece<D>& piece = pieces.piece[pieces.count++];
      piece.offset = std::copysign(solid.volume[row] / (2 * std::abs(area(k))), area(k)) * Vector<D>::Unit(k);
      piece.area = area(k) * Vector<D>::Unit(k);
    }
    return pieces;
  }
  pieces.piece[0] = {area * (depth / size), area};
  pieces.count = 1;
  return pieces;
}

template <int D>
double extrapolation_weight(const SolidElasticity<D>& solid, std::int64_t link, const Vector<D>& offset) {
  return monomials<D>(offset).dot(solid.shape[link]);
}

template <int D>
void add_force_at(const SolidElasticity<D>& solid, std::size_t row, const Vector<D>& offset, const Vector<D>& f,
                  std::span<Vector<D>> force) {
  force[row] += f;
  for (std::int64_t fit = solid.fit_begin[row]; fit < solid.fit_begin[row + 1]; ++fit)
    for (std::int64_t l = solid.fits[fit].first; l < solid.fits[fit].first + solid.fits[fit].count; ++l) {
      const double weight = extrapolation_weight<D>(solid, l, offset);
      for (int k = 0; k < D; ++k) {
        if (!(solid.fits[fit].components >> k & 1)) continue;
        force[row](k) -= weight * f(k);
        if (solid.neighbor[l] >= 0) force[solid.neighbor[l]](k) += weight * f(k);
      }
    }
}

#define SIM_INSTANTIATE(D)                                                                            \
  template SurfacePieces<D> surface_pieces<D>(const SolidElasticity<D>&, std::size_t);                \
  template double extrapolation_weight<D>(const SolidElasticity<D>&, std::int64_t, const Vector<D>&); \
  template void add_force_at<D>(const SolidElasticity<D>&, std::size_t, const Vector<D>&, const Vector<D>&, std::span<Vector<D>>);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
