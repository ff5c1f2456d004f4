#include "geometry/import_units.h"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"
#include "geometry/openings.h"
#include "geometry/voxel_grid.h"

namespace geometry::detail {
namespace {

// Diameter of the widest open end or of the largest sphere inside the capped surface, file units.
double widest_bore(const TriangleMesh& mesh, double extent) {
  TriangleMesh capped = mesh;
  double widest = 0;
  for (const auto& loop : border_loops(mesh)) {
    std::vector<Eigen::Vector3d> rim;
    for (std::int32_t v : loop) rim.push_back(mesh.vertices[std::size_t(v)]);
    widest = std::max(widest, 2 * measure_loop(rim).radius);
    if (loop.size() < 3000) cap_loop(capped, loop);
  }
  const std::vector<double> distance = distance_transform(voxelize(capped, extent / 120));
  return std::max(widest, 2 * *std::max_element(distance.begin(), distance.end()));
}

}  // namespace

std::string propose_units(const TriangleMesh& mesh) {
  Eigen::Vector3d low, high;
  bounding_box(mesh, low, high);
  const double extent = (high - low).maxCoeff();
  if (!(extent > 0)) throw std::runtime_error("has no extent: all its vertices are at one place");
  const double bore = widest_bore(mesh, extent);
  for (const char* unit : {"mm", "cm", "m"}) {
    const double metres = metres_per_unit(unit);
    if (bore * metres >= 0.008 && bore * metres <= 0.075 && extent * metres >= 0.015 && extent * metres <= 0.8) return unit;
  }
  char text[260];
  std::snprintf(text, sizeof text,
                "has units that its size does not tell (box %.3g, widest bore %.3g; an aorta's bore is 10-35 mm)%s; give --units mm, cm, m "
                "or a number of them, as in --units \"120 mm\"",
                extent, bore, extent <= 2 && extent >= 0.3 ? ": it looks normalised" : "");
  throw std::runtime_error(text);
}

}  // namespace geometry::detail
