// Where a wall's particles meet the fluid: the nearest point of the walls' surface that fluid can reach.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/placement_lattice.h"
#include "geometry/shape.h"

namespace geometry {

// Cells of the lattice that fluid can get to: no solid, and joined to a cell of `fluid` through such cells. Without any fluid cell, all
// that are no solid. `solid` and `fluid` are flags a cell.
std::vector<std::uint8_t> reachable_cells(const PlacementLattice& lattice, const std::vector<std::uint8_t>& solid,
                                          const std::vector<std::uint8_t>& fluid);

struct SurfaceFoot {
  double depth;            // m, >= 0
  Eigen::Vector3d normal;  // unit, out of the wall
};

// For each point inside the union of `solids`: depth below, and normal of, the nearest surface point towards a cell of `fluid`; where none
// is within `reach` (m), towards a `reachable` cell; where there is none either, of the nearest surface of `own`.
std::vector<SurfaceFoot> exposed_surface(const std::vector<Eigen::Vector3d>& points, const std::vector<const Shape*>& solids,
                                         const Shape& own, const PlacementLattice& lattice, const std::vector<std::uint8_t>& fluid,
                                         const std::vector<std::uint8_t>& reachable, double reach, double spacing);

}  // namespace geometry
