// Which body each cell of a placement lattice belongs to, and which cells' particles must be relaxed towards a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/place_particles.h"
#include "geometry/placement_lattice.h"

namespace geometry {

constexpr std::int32_t no_body = -1;

struct SharedCells {
  PlacementLattice lattice;
  std::vector<std::int32_t> owner;    // body of each cell, or no_body
  std::vector<float> distance;        // signed distance of the owner at the cell's centre, m; without owner: of the nearest member
  std::vector<std::uint8_t> blocked;  // 1: inside a body that is no member
};

// Shares out the cells among `members` by sign. Throws std::invalid_argument where two bodies overlap by more than touching.
SharedCells share_cells(const std::vector<PlacedBody>& bodies, const std::vector<int>& members, const PlacementOptions& options);

// Volume of a body as given (clipped to the periodic domain), m³.
double true_volume(const PlacedBody& body, const PlacementLattice& lattice, const PlacementOptions& options);

// Moves the boundary of `body` by at most a quarter of a spacing so that its cells add up to `volume`. Walls give or take.
void balance_volume(SharedCells& cells, const std::vector<PlacedBody>& bodies, const std::vector<int>& members, int body, double volume,
                    const PlacementOptions& options);

// Cells that a surface passes other than at a face between cells: 1 within three spacings of such a place, 2 (ghosts that stay) within
// six, else 0.
std::vector<std::uint8_t> cells_to_relax(const SharedCells& cells, const std::vector<PlacedBody>& bodies, const PlacementOptions& options);

// Throws std::invalid_argument, naming both bodies and a point, where bodies overlap; exact for rectilinear pairs.
void check_overlaps(const std::vector<PlacedBody>& bodies, const PlacementOptions& options);
[[noreturn]] void refuse_overlap(const PlacedBody& one, const PlacedBody& other, const Eigen::Vector3d& at, int dimension);

}  // namespace geometry
