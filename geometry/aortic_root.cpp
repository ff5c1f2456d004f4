#include "geometry/aortic_root.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "geometry/root_profile.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
using namespace detail;
constexpr double pi = std::numbers::pi;

// What one candidate came to.
struct Attempt {
  std::optional<AorticRoot> root;
  Centreline line;           // ventricle -> aorta
  bool three_lobes = false;  // passed the deciding test
  double order = 0;          // D_annulus / D_junction: smaller is the better direction
  double sinus_diameter = 0, junction_diameter = 0, prominence = 0;
  Vector3d sinus_center = Vector3d::Zero();
  std::string why;
};

Centreline reversed(const Centreline& line) {
  Centreline out;
  for (std::size_t i = line.size(); i-- > 0;) {
    out.points.push_back(line.points[i]);
    out.tangents.push_back(-line.tangents[i]);
    out.arc.push_back(line.arc.back() - line.arc[i]);
  }
  return out;
}

BoreProfile reversed(const BoreProfile& bore, double length) {
  BoreProfile out;
  for (std::size_t i = bore.arc.size(); i-- > 0;) {
    out.arc.push_back(length - bore.arc[i]);
    out.diameter.push_back(bore.diameter[i]);
  }
  return out;
}

std::size_t station_at(const Centreline& line, double arc) {
  const auto found = std::lower_bound(line.arc.begin(), line.arc.end(), arc);
  return std::min(std::size_t(found - line.arc.begin()), line.size() - 1);
}

RootPlane measure_plane(const TriangleMesh& lumen, const Vector3d& inside, const Vector3d& normal) {
  RootPlane plane;
  plane.normal = normal.normalized();
  const Section section = section_around(lumen, inside, plane.normal);
  plane.center = section.contour.empty() ? inside : section.center;
  plane.largest_diameter = section.largest_width;
  plane.perpendicular_diameter = section.perpendicular_width;
  plane.mean_diameter = section.diameter();
  return plane;
}

Vector3d plane_normal(const std::array<Vector3d, 3>& points, const Vector3d& toward) {
  Vector3d normal = (points[1] - points[0]).cross(points[2] - points[0]).normalized();
  return normal.dot(toward) < 0 ? Vector3d(-normal) : normal;
}

double plane_height(const Axis& axis, const RootPlane& plane) { return (plane.center - axis.origin).dot(axis.direction); }

// z of the largest section perpendicular to the axis between two heights.
double widest_between(const TriangleMesh& lumen, const Axis& axis, double from, double to) {
  double best = (from + to) / 2, largest = 0;
  for (int i = 1; i < 30; ++i) {
    const double z = from + (to - from) * i / 30;
    const Section section = section_around(lumen, axis.at(0, 0, z), axis.direction);
    if (section.area > largest) {
      largest = section.area;
      best = z;
    }
  }
  return best;
}

std::string in_millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f mm", 1e3 * metres);
  return text;
}

// Commissures: at the valleys between the lobes, a little below the junction, on the wall.
void place_commissures(const TriangleTree& tree, const Axis& axis, const Lobes& lobes, double z_junction, double annulus_z,
                       AorticRoot& root) {
  const double z = z_junction - std::min(1.5e-3, 0.1 * (z_junction - annulus_z));
  for (std::size_t i = 0; i < 3; ++i) {
    const double theta = lobes.valley[i];
    const Vector3d direction = std::cos(theta) * axis.x_axis + std::sin(theta) * axis.y_axis;
    const double r = tree.first_hit(axis.at(0, 0, z), direction);
    root.commissures[i] = axis.at(std::isinf(r) ? root.sinotubular_junction.mean_diameter / 2 : r, theta, z);
  }
}

// Steps 5-7, repeated while the axis settles.
Attempt settle_root(const TriangleMesh& lumen, const TriangleTree& tree, const Centreline& line, const Candidate& candidate,
                    const RootOptions& options) {
  Attempt attempt;
  attempt.line = line;
  const Vector3d low = line.points[station_at(line, candidate.annulus_arc)], high = line.points[station_at(line, candidate.junction_arc)];
  const Vector3d middle = line.points[station_at(line, candidate.sinus_arc)];
  Axis axis = make_axis(low, high);
  if (candidate.inlet_missing) axis = make_axis(middle, high);
  double z_sinus = (middle - axis.origin).dot(axis.direction), diameter = candidate.sinus_diameter;
  AorticRoot root;
  Lobes lobes;
  double z_junction = 0;
  for (int round = 0; round < 4; ++round) {
    lobes = find_lobes(tree, axis, z_sinus, diameter);
    attempt.prominence = lobes.prominence;
    if (!lobes.found) {
      attempt.why = "the widening of " + in_millimetres(diameter) + " is not a root: " + lobes.why;
      return attempt;
    }
    attempt.three_lobes = true;
    attempt.sinus_center = axis.at(0, 0, z_sinus);
    const auto junction = find_junction(lumen, axis, z_sinus, diameter);
    if (options.sinotubular_junction) {
      root.sinotubular_junction = measure_plane(lumen, options.sinotubular_junction->center, options.sinotubular_junction->normal);
    } else if (junction) {
      root.sinotubular_junction = measure_plane(lumen, axis.at(0, 0, *junction), axis.direction);
    } else {
      attempt.why = "the sinotubular junction is unresolved: the vessel does not narrow above the sinuses; give its plane";
      return attempt;
    }
    if (root.sinotubular_junction.normal.dot(axis.direction) < 0) root.sinotubular_junction.normal *= -1;
    z_junction = plane_height(axis, root.sinotubular_junction);
    attempt.junction_diameter = root.sinotubular_junction.mean_diameter;
    attempt.sinus_diameter = section_around(lumen, axis.at(0, 0, z_sinus), axis.direction).diameter();
    int resolved = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto nadir = find_nadir(tree, axis, lobes.peak[i], z_sinus, diameter);
      if (!nadir) continue;
      root.nadirs[i] = *nadir;
      ++resolved;
    }
    if (options.nadirs) root.nadirs = *options.nadirs;
    if (options.annulus) {
      root.annulus = measure_plane(lumen, options.annulus->center, options.annulus->normal);
    } else {
      if (!options.nadirs && (resolved < 3 || candidate.inlet_missing)) {
        attempt.why = "the annulus is unresolved: no outflow tract below the sinuses";
        return attempt;
      }
      root.annulus =
          measure_plane(lumen, (root.nadirs[0] + root.nadirs[1] + root.nadirs[2]) / 3, plane_normal(root.nadirs, axis.direction));
    }
    if (root.annulus.normal.dot(axis.direction) < 0) root.annulus.normal *= -1;
    if (root.annulus.mean_diameter <= 0) {
      attempt.why = "the annulus is unresolved: no closed section of the lumen through the sinuses' nadirs";
      return attempt;
    }
    axis = make_axis(root.annulus.center, root.sinotubular_junction.center);
    z_junction = plane_height(axis, root.sinotubular_junction);
    z_sinus = widest_between(lumen, axis, 0, z_junction);
    root.sinuses = measure_plane(lumen, axis.at(0, 0, z_sinus), axis.direction);
    diameter = root.sinuses.mean_diameter;
  }
  if (options.annulus && !options.nadirs)  // below the lobes, in the plane the user gave
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d direction = std::cos(lobes.peak[i]) * axis.x_axis + std::sin(lobes.peak[i]) * axis.y_axis;
      const Vector3d in_plane = (direction - direction.dot(root.annulus.normal) * root.annulus.normal).normalized();
      const double r = tree.first_hit(root.annulus.center, in_plane);
      root.nadirs[i] = root.annulus.center + (std::isinf(r) ? root.annulus.mean_diameter / 2 : r) * in_plane;
    }
  place_commissures(tree, axis, lobes, z_junction, 0, root);
  if (options.commissures) root.commissures = *options.commissures;
  attempt.order = root.annulus.mean_diameter / root.sinotubular_junction.mean_diameter;
  const double share = root.annulus.mean_diameter / root.sinuses.mean_diameter;
  const double tilt = std::acos(std::clamp(root.annulus.normal.dot(axis.direction), -1.0, 1.0)) * 180 / pi;
  const double length = z_junction / root.sinuses.mean_diameter;
  char text[200];
  if (!options.annulus && !options.nadirs && (share < 0.55 || share > 0.95)) {
    std::snprintf(text, sizeof text,
                  "the annulus is unresolved: the plane through the sinuses' nadirs would be %.1f mm wide against %.1f mm at the sinuses",
                  1e3 * root.annulus.mean_diameter, 1e3 * root.sinuses.mean_diameter);
    attempt.why = text;
  } else if (!options.annulus && !options.nadirs && tilt > 35) {
    std::snprintf(text, sizeof text, "the annulus is unresolved: the plane through the sinuses' nadirs leans by %.0f degrees", tilt);
    attempt.why = text;
  } else if (!options.annulus && !options.sinotubular_junction && (length < 0.35 || length > 1.6)) {
    std::snprintf(text, sizeof text, "the annulus is unresolved: it would lie %.1f mm below the junction", 1e3 * z_junction);
    attempt.why = text;
  } else {
    attempt.root = root;
  }
  return attempt;
}

std::string mend_of_annulus(const std::string& why) {
  return why.find("unresolved") == std::string::npos ? why : why + "; give root.annulus in the scene, or import with --build-root";
}

}  // namespace

RootSearch find_aortic_root(const TriangleMesh& lumen, const std::vector<Centreline>& centrelines, const RootOptions& options) {
  RootSearch search;
  const TriangleTree tree(lumen);
  std::vector<Attempt> attempts;
  for (const Centreline& given : centrelines) {
    if (given.size() < 10) continue;
    const BoreProfile bore = measure_bore(lumen, given);
    for (const bool backward : {false, true}) {
      const Centreline line = backward ? reversed(given) : given;
      if (options.ventricle_point &&
          (line.points.front() - *options.ventricle_point).norm() > (line.points.back() - *options.ventricle_point).norm())
        continue;
      for (const Candidate& candidate : find_widenings(backward ? reversed(bore, given.arc.back()) : bore))
        attempts.push_back(settle_root(lumen, tree, line, candidate, options));
    }
  }
  const Attempt* best = nullptr;
  for (const Attempt& attempt : attempts)
    if (attempt.root && (best == nullptr || attempt.order < best->order)) best = &attempt;
  if (best != nullptr) {
    search.root = best->root;
    search.centreline = best->line;
    return search;
  }
  for (const Attempt& attempt : attempts)  // three lobes without an annulus or junction: worth telling
    if (attempt.three_lobes && (best == nullptr || attempt.prominence > best->prominence)) best = &attempt;
  if (best != nullptr) {
    search.centreline = best->line;
    char text[160];
    std::snprintf(text, sizeof text, "three sinuses found (%.1f mm wide, junction %.1f mm), but ", 1e3 * best->sinus_diameter,
                  1e3 * best->junction_diameter);
    search.reason = text + mend_of_annulus(best->why);
  } else {
    search.reason = attempts.empty() ? "no root: the vessel nowhere widens between two narrower places as sinuses do"
                                     : "no root: " + attempts.back().why;
    search.reason += "; import with --build-root to put one on the vessel";
  }
  return search;
}

}  // namespace geometry
