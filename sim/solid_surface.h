// Where the surface that an elastic particle carries lies, and forces that act there.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "sim/solid.h"

namespace sim {

// A piece of the body's surface at a fixed offset from its particle.
template <int D>
struct SurfacePiece {
  Vector<D> offset;  // m, from the particle's centre, at rest
  Vector<D> area;    // m^2 (2-D: m), outward
};
template <int D>
struct SurfacePieces {
  static constexpr int most = 6;
  std::array<SurfacePiece<D>, most> piece;
  int count = 0;
  const SurfacePiece<D>* begin() const { return piece.data(); }
  const SurfacePiece<D>* end() const { return piece.data() + count; }
};

// The pieces given with the particles; without them a cell of a lattice has a piece for each of its open faces (a corner has D), any other
// particle one, `depth` away along the normal.
template <int D>
SurfacePieces<D> surface_pieces(const SolidElasticity<D>& solid, std::size_t row);

// Weight of a link's displacement difference in the fitted displacement at an offset: u(offset) = u_i + sum_l weight_l (u_l - u_i).
template <int D>
double extrapolation_weight(const SolidElasticity<D>& solid, std::int64_t link, const Vector<D>& offset);

// Adds a force that acts at an offset from particle `row`: the work is that of the fitted displacement there.
template <int D>
void add_force_at(const SolidElasticity<D>& solid, std::size_t row, const Vector<D>& offset, const Vector<D>& f,
                  std::span<Vector<D>> force);

// Whether a clamp's point holds the fit's components on a piece of the surface: within 0.3 l0 of its plane and 0.6 l0 of its middle. The
// displacement is 0 there, and what pushes is taken up by the reaction.
template <int D>
bool held_there(const SolidElasticity<D>& solid, const SolidFit& fit, const SurfacePiece<D>& piece) {
  const Vector<D> normal = piece.area.normalized();
  for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
    if (solid.neighbor[l] >= 0) continue;
    const Vector<D> away = solid.offset[l] - piece.offset;
    if (std::abs(away.dot(normal)) < 0.3 * solid.spacing && away.norm() < 0.6 * solid.spacing) return true;
  }
  return false;
}

}  // namespace sim
