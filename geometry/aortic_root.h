// The aortic root: annulus, sinuses, sinotubular junction, commissures, found in a closed lumen or built on a bare vessel.
// Method: design note "geometry", section 1 (three lobes decide, three nadirs make the annulus).
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/sections.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct RootPlane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the ventricle towards the aorta
  double largest_diameter = 0;                        // m
  double perpendicular_diameter = 0;                  // m, at right angles to the largest
  double mean_diameter = 0;                           // m, of the circle of equal area
};

struct AorticRoot {
  RootPlane annulus, sinuses, sinotubular_junction;
  std::array<Eigen::Vector3d, 3> commissures;  // m, on the wall, counter-clockwise about the axis
  std::array<Eigen::Vector3d, 3> nadirs;       // m, on the wall; nadir i lies between commissures i and i+1 (mod 3)
  bool built = false;                          // true: not found in the mesh but put there on request
};

// A plane given by the user: metres, in the mesh's own coordinates.
struct PlaneOverride {
  Eigen::Vector3d center, normal;
};

struct RootOptions {
  std::optional<Eigen::Vector3d> ventricle_point;  // any point on the ventricle's side
  std::optional<PlaneOverride> annulus, sinotubular_junction;
  std::optional<std::array<Eigen::Vector3d, 3>> commissures, nadirs;
};

// What a built root measures; 0 = from the vessel's own bore by the proportions of Thubrikar / Labrosse.
struct BuiltRootMeasures {
  double annulus_diameter = 0;  // m
  double height = 0;            // m, annulus to sinotubular junction
  double distance = 0;          // m, of the annulus from the inlet end; 0 = one bore
};

struct RootSearch {
  std::optional<AorticRoot> root;
  std::string reason;  // why there is none; names what is unresolved and how the user can settle it
  std::vector<std::string> warnings;
  std::optional<PlaneOverride> likely_annulus;  // sinuses found but no outflow tract: a guess to build on, not a finding
  Centreline centreline;                        // ventricle -> aorta through the root, where one was found
};

// The mesh is closed and oriented outward, metres. `centreline` candidates run between the lumen's ends.
RootSearch find_aortic_root(const TriangleMesh& lumen, const std::vector<Centreline>& centrelines, const RootOptions& options = {});

// Puts a root's planes and commissures on a bare vessel along `centreline` (inlet first).
RootSearch build_aortic_root(const TriangleMesh& lumen, const Centreline& centreline, const BuiltRootMeasures& measures = {});

}  // namespace geometry
