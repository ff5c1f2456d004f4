// A patient's mesh file -> a clean closed lumen, its ends, its aortic root, and all that was found on the way.
// `cusp import` prints this; import.json is these fields, lengths in mm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/aortic_root.h"
#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"
#include "geometry/openings.h"
#include "geometry/sections.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct EndOverride {
  std::string name;  // of an end as reported ("branch2")
  std::string role;  // see OpenEnd::role
};

struct ImportOptions {
  std::string units;        // "" = proposed from the size
  std::string part;         // "" = the whole file; else the name of one group or node
  bool build_root = false;  // where no root is found, put one on the bare vessel
  BuiltRootMeasures built_root;
  RootOptions root;  // planes, commissures... by the user, metres
  std::vector<EndOverride> ends;
  LoadLimits limits;
};

struct ImportResult {
  std::string file, format;
  std::string units;            // "mm", "cm", "m"...
  bool units_proposed = false;  // true: from the size, not from the user or the format
  double metres_per_unit = 1;
  std::size_t triangles_in = 0, triangles_out = 0;
  Eigen::Vector3d box_min, box_max;  // m, of what the file held
  std::vector<Defect> defects;
  std::vector<OpenEnd> open_ends;
  TriangleMesh lumen;                         // m; closed, capped, oriented outward
  std::vector<std::int32_t> cap_of_triangle;  // per lumen triangle: index into open_ends, or -1 = wall
  Centreline centreline;                      // ventricle (or inlet) -> aorta
  std::optional<AorticRoot> root;
  std::string root_reason;  // where there is none
  std::vector<std::string> warnings;
};

// Throws std::runtime_error, one line (file, what, mend), when the mesh cannot become a lumen: unreadable, units not known, double wall
// that cannot be closed. Deterministic. A mesh of 100 k triangles takes about ten seconds.
ImportResult import_mesh(const std::string& path, const ImportOptions& options = {});

}  // namespace geometry
