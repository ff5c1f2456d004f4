#include "sim/solid_surface.h"

#include <algorithm>
#include <cmath>

namespace sim {

namespace {

// Offset of the nearest clamp point within 0.75 l0 of a row, 0 where there is none.
template <int D>
Vector<D> nearest_clamp_face(const SolidElasticity<D>& solid, std::size_t row) {
  Vector<D> face = Vector<D>::Zero();
  double nearest = 0.75 * solid.spacing;
  for (std::int64_t fit = solid.fit_begin[row]; fit < solid.fit_begin[row + 1]; ++fit)
    for (std::int64_t l = solid.fits[fit].first; l < solid.fits[fit].first + solid.fits[fit].count; ++l)
      if (solid.neighbor[l] < 0 && solid.offset[l].norm() < nearest) nearest = solid.offset[l].norm(), face = solid.offset[l];
  return face;
}

}  // namespace

template <int D>
SurfacePieces<D> surface_pieces(const SolidElasticity<D>& solid, std::size_t row) {
  SurfacePieces<D> pieces;
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
  // Where a curved body ends at a clamp's face its particle carries a part of that face and a part of the surface that meets it: split
  // along the face's normal, which the links to the clamp's points give.
  const Vector<D> face = nearest_clamp_face(solid, row);
  const double across = face.squaredNorm() > 0 ? area.dot(face.normalized()) : 0;
  const Vector<D> rest = area - across * face.normalized();
  if (across > 0.3 * size && rest.norm() > 0.3 * size) {
    pieces.piece[0] = {face, across * face.normalized()};
    pieces.piece[1] = {rest * (depth / rest.norm()), rest};
    pieces.count = 2;
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
