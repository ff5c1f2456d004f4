// A root's frame on a vessel that shows none: planes, commissures and nadirs by proportion to the bore, on the vessel's own wall.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "geometry/aortic_root.h"
#include "geometry/triangle_tree.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

RootPlane plane_at(const TriangleMesh& lumen, const Vector3d& point, const Vector3d& normal) {
  const Section section = section_around(lumen, point, normal);
  RootPlane plane;
  plane.normal = normal;
  plane.center = section.contour.empty() ? point : section.center;
  plane.largest_diameter = section.largest_width;
  plane.perpendicular_diameter = section.perpendicular_width;
  plane.mean_diameter = section.diameter();
  return plane;
}

Vector3d point_at(const Centreline& line, double arc) {
  const auto found = std::lower_bound(line.arc.begin(), line.arc.end(), arc);
  return line.points[std::min(std::size_t(found - line.arc.begin()), line.size() - 1)];
}

Vector3d tangent_at(const Centreline& line, double arc) {
  const auto found = std::lower_bound(line.arc.begin(), line.arc.end(), arc);
  return line.tangents[std::min(std::size_t(found - line.arc.begin()), line.size() - 1)];
}

}  // namespace

RootSearch build_aortic_root(const TriangleMesh& lumen, const Centreline& centreline, const BuiltRootMeasures& measures) {
  RootSearch search;
  search.centreline = centreline;
  if (centreline.size() < 4) {
    search.reason = "no root can be built: the vessel has no centreline";
    return search;
  }
  auto bore_at = [&](double arc) { return section_around(lumen, point_at(centreline, arc), tangent_at(centreline, arc)).diameter(); };
  double bore = 0;
  for (double share : {0.05, 0.1, 0.15, 0.2}) bore = std::max(bore, bore_at(share * centreline.arc.back()));
  const double annulus_arc = measures.distance > 0 ? measures.distance : bore;
  bore = bore_at(annulus_arc);
  // Thubrikar 1981: commissures 1.4 commissure radii above the base; the junction a tenth of that above them.
  const double height = measures.height > 0 ? measures.height : 1.54 * bore / 2;
  if (bore <= 0 || annulus_arc + 1.2 * height > centreline.arc.back()) {
    search.reason = "no root can be built: the vessel is too short for its bore; give a smaller built_root.height or distance";
    return search;
  }
  AorticRoot root;
  root.built = true;
  const Vector3d base = point_at(centreline, annulus_arc);
  Vector3d top = point_at(centreline, annulus_arc + height);
  const Vector3d axis = (top - base).normalized();
  root.annulus = plane_at(lumen, base, axis);
  top = root.annulus.center + height * axis;
  root.sinotubular_junction = plane_at(lumen, top, axis);
  root.sinuses = plane_at(lumen, root.annulus.center + 0.45 * height * axis, axis);
  if (root.annulus.mean_diameter <= 0 || root.sinotubular_junction.mean_diameter <= 0) {
    search.reason = "no root can be built: the straight axis of the root leaves the bent vessel; give built_root.distance farther along";
    return search;
  }
  const TriangleTree tree(lumen);
  const Vector3d x_axis = axis.unitOrthogonal(), y_axis = axis.cross(x_axis);
  const Vector3d straight = root.sinotubular_junction.center - root.annulus.center;
  auto wall_point = [&](double share, double angle) {
    const Vector3d from = root.annulus.center + share * straight, direction = std::cos(angle) * x_axis + std::sin(angle) * y_axis;
    const double r = tree.first_hit(from, direction);
    return Vector3d(from + (std::isinf(r) ? bore / 2 : r) * direction);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    root.commissures[i] = wall_point(1 / 1.1, 2 * std::numbers::pi * double(i) / 3);
    root.nadirs[i] = wall_point(0, 2 * std::numbers::pi * (double(i) + 0.5) / 3);
  }
  if (measures.annulus_diameter > 0 &&
      std::abs(measures.annulus_diameter - root.annulus.mean_diameter) > 0.05 * root.annulus.mean_diameter) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the vessel is %.1f mm wide where the annulus of %.1f mm was asked for; the valve is fitted to the vessel's own wall",
                  1e3 * root.annulus.mean_diameter, 1e3 * measures.annulus_diameter);
    search.warnings.push_back(text);
  }
  search.warnings.push_back("the root is built, not found: annulus, junction and commissures are proportions of the vessel's bore");
  search.root = root;
  return search;
}

}  // namespace geometry
