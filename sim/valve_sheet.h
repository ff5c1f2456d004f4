// The leaflets as the clinical figures see them: rows, mesh, free edges, tips and regions at rest. Built once a run from the scene, or
// from a run file alone. 3-D.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/run_file.h"
#include "sim/scene.h"

namespace sim {

// Where on a leaflet a row lies at rest, nearest thing first. `clamp`: nearer than max(thickness, 2 l0) to where it is held; its stress is
// that of a singularity and is never reported.
enum class LeafletRegion : std::uint8_t { clamp, commissure, attachment, free_edge, belly };
inline constexpr std::array<LeafletRegion, 4> reported_regions{LeafletRegion::belly, LeafletRegion::free_edge, LeafletRegion::commissure,
                                                               LeafletRegion::attachment};
const char* region_name(LeafletRegion region);  // "belly", "free_edge", ...

struct ValveSheet {
  ValveFrame frame;
  double spacing = 0, thickness = 0;                  // m
  std::vector<std::int64_t> row;                      // State (and frame) row of each sheet row
  std::vector<std::int32_t> leaflet;                  // per sheet row: 0 ... leaflets.size() - 1
  std::vector<Eigen::Vector3d> rest;                  // m
  std::vector<std::uint8_t> held;                     // does not move
  std::vector<LeafletRegion> region;                  // per sheet row
  std::vector<std::array<std::int32_t, 3>> elements;  // over sheet rows
  struct Leaflet {
    std::vector<std::int32_t> free_edge;                // sheet rows from commissure to commissure; empty where the mesh has none
    std::int32_t tip = -1;                              // the middle of the free edge, by length; -1 without a free edge
    Eigen::Vector3d outward = Eigen::Vector3d::Zero();  // unit, across the axis towards the leaflet's middle
  };
  std::vector<Leaflet> leaflets;
  // m between mid-surfaces; nearer leaflets are closed: they touch at half a spacing, and no blood fits between.
  double contact_distance() const { return 0.8 * spacing; }
  std::size_t size() const { return rest.size(); }
};

// From parts: one entry of `body_rows` a leaflet (its rows' rest positions and held flags concatenated in the same order), elements over
// the concatenated rows. Throws std::invalid_argument where a leaflet has no triangles.
ValveSheet make_valve_sheet(const ValveFrame& frame, double spacing, double thickness, const std::vector<std::int32_t>& leaflet,
                            std::vector<Eigen::Vector3d> rest, std::vector<std::uint8_t> held,
                            std::vector<std::array<std::int32_t, 3>> elements);
// Of a scene that has a valve with shells.
ValveSheet make_valve_sheet(const Scene<3>& scene);
// Of a run file with a valve; rows that never move are the held ones. Throws std::runtime_error where it has no valve or no frame.
ValveSheet make_valve_sheet(const RunReader& run);

// Unit normals (right-hand rule over the elements; towards the aorta on leaflets of the template) and areas (a third of the triangles
// around, m2) of sheet rows at these positions.
void sheet_normals_and_areas(const ValveSheet& sheet, std::span<const Eigen::Vector3d> position, std::vector<Eigen::Vector3d>& normal,
                             std::vector<double>& area);

}  // namespace sim
