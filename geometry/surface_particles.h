// Particles along a surface, one layer: leaflets from their structured surface, or any triangle mesh. Metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "geometry/valve_template.h"

namespace geometry {

struct SurfaceParticles {
  std::vector<Eigen::Vector3d> position;               // m
  std::vector<double> area;                            // m²; the free part's sums to the surface's area
  std::vector<Eigen::Vector3d> normal;                 // unit; + side by the right-hand rule of `triangles` (a leaflet: the aortic side)
  std::vector<Eigen::Vector3d> fibre;                  // unit tangent; leaflets: circumferential; else along the longest extent
  std::vector<std::uint8_t> attached;                  // 1: held by the wall (the attachment row and the rows embedded in the wall)
  std::vector<std::uint8_t> embedded;                  // 1: lies in the wall, beyond the attachment row
  std::vector<std::array<std::int32_t, 3>> triangles;  // mesh over the particles
  std::size_t size() const { return position.size(); }
};

// `particle_spacing` m in the surface (0.8 l0 for leaflets). Rows on the free edge and the attachment, evenly spaced rows between;
// `embedded_rows` more rows continue the surface into the wall.
SurfaceParticles leaflet_particles(const LeafletSurface& leaflet, double particle_spacing, int embedded_rows = 2);

// Any open or closed, consistently oriented triangle mesh, remeshed to `particle_spacing`. Throws std::runtime_error where the mesh is
// not a manifold surface. Attached is 0 everywhere: the caller marks what is fixed.
SurfaceParticles mesh_particles(const TriangleMesh& mesh, double particle_spacing);

}  // namespace geometry
