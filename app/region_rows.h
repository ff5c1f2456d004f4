// Which particles of a body a region of the scene means: the rows of clamps, loads and stiffness maps.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "app/case_parts.h"
#include "geometry/shape.h"

namespace app {

// A region's shape; a box without thickness gets a little.
geometry::Shape region_shape(const ShapeSpec& region, int dimension, double spacing);

// Rows (relative to the body) whose centre lies in the region; where the region is thinner than a particle, those whose cell it cuts.
// Refuses a region that holds none.
std::vector<std::int64_t> rows_in_region(const ShapeSpec& region, const BodyParticles& body, int dimension, double spacing);

// A force on a region beyond the particles' centres (a face, a tip) acts there: each share f of a row at distance d from the region becomes
// f (1 + d/s) on the row and -f d/s on the one behind it at distance s, which has the same resultant and moment.
void move_shares_to_region(const ShapeSpec& region, const BodyParticles& body, int dimension, double spacing,
                           std::vector<std::int64_t>& rows, std::vector<double>& share);

// Rows of a body's surface that a pressure acts on: the surface point that the particle carries lies in the region.
std::vector<std::int64_t> surface_rows(const std::optional<ShapeSpec>& region, const BodyParticles& body, int dimension, double spacing);

}  // namespace app
