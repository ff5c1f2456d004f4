// Mends a surface: duplicates, degenerate faces, orientation, specks, holes, self-intersections; says what it did and where.
#pragma once

#include <string>
#include <vector>

#include "geometry/check_mesh.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct RepairOptions {
  double movement = 0.01;       // no surface point goes farther than this times the box's diagonal
  double speck = 0.02;          // components with less than this share of the largest one's area are dropped
  double end_diameter = 0.002;  // m: narrower border loops are always holes
};

struct RepairReport {
  std::vector<Defect> defects;
  std::vector<std::string> warnings;
  double moved = 0;  // m, bound on how far the surface moved
};

// Works on a welded mesh in metres, in place. Vessel ends (see openings.h) stay open; every other loop is closed.
RepairReport repair_mesh(TriangleMesh& mesh, const RepairOptions& options = {});

}  // namespace geometry
