// Which parts of a curved body's surface its particles carry.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "geometry/shape.h"

namespace geometry {

// A part of the surface on one side of a particle; where faces meet at an edge a particle has a share of each.
struct SurfaceShare {
  std::size_t particle = 0;
  Eigen::Vector3d area = Eigen::Vector3d::Zero();    // m² (2-D: m), outward
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, from the particle's centre to where the share acts: sum (c - x) (a . A) / A²
};

// As many faces as a cell has: of a particle with more the smallest join those nearest in direction.
inline constexpr std::size_t most_shares = 6;

// The shares of all of the surface, particle by particle: each element goes to the nearest particle, elements whose normals differ by less
// than 30 degrees form a share. The areas sum to 0; the offsets are moved along the normals, by the same length everywhere, so that the
// divergence theorem gives `volume`, sum A . (x + offset) = D V (0: they stay). With `inside`, of each share only the part whose elements
// it accepts.
std::vector<SurfaceShare> surface_shares(const Shape& shape, const std::vector<Eigen::Vector3d>& position, int dimension, double spacing,
                                         double volume, const std::function<bool(const Eigen::Vector3d&)>& inside = {});

}  // namespace geometry
