// Which parts of a solid's boundary a pressure with a region pushes on.
#pragma once

#include <cstdint>
#include <vector>

#include "app/case_parts.h"
#include "geometry/shape.h"

namespace app {

// Pieces of boundary inside the region, each carried by a particle; one particle may carry several (at an edge: one a face).
struct LoadedSurface {
  std::vector<std::int64_t> row;        // relative to the body
  std::vector<Eigen::Vector3d> area;    // m² (2-D: m), outward
  std::vector<Eigen::Vector3d> offset;  // m, from the particle to the piece's middle
};

// Faces of lattice cells where the body lies on a lattice (its particles' areas are those of their cells' faces), elements of the true surface
// elsewhere. Empty where no boundary lies in the region.
LoadedSurface loaded_surface(const geometry::Shape& body, const BodyParticles& particles, const geometry::Shape& region, int dimension,
                             double spacing);

}  // namespace app
