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
  std::optional<PlaneOverride> likely_annulus;
  std::string why, note;
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

// The state of one candidate while its axis settles.
struct Working {
  Axis axis;
  double z_sinus, diameter;  // m
  double z_junction = 0;     // m
  Lobes lobes;
  AorticRoot root;
  bool inlet_missing;
  std::string note;  // said with the result
};

// Without an outflow tract the axis rests on the sinus's and the junction's own centres.
void rest_on_sections(const TriangleMesh& lumen, Working& work) {
  for (int round = 0; round < 4; ++round) {
    const Section sinus = section_around(lumen, work.axis.at(0, 0, work.z_sinus), work.axis.direction);
    const auto z_junction = find_junction(lumen, work.axis, work.z_sinus, work.diameter);
    if (sinus.contour.empty() || !z_junction) return;
    const Section junction = section_around(lumen, work.axis.at(0, 0, *z_junction), work.axis.direction);
    if (junction.contour.empty()) return;
    work.axis = make_axis(sinus.center, junction.center);
    work.z_sinus = widest_between(lumen, work.axis, -0.2 * work.diameter, 0.2 * work.diameter);
    work.diameter = section_around(lumen, work.axis.at(0, 0, work.z_sinus), work.axis.direction).diameter();
  }
}

Working start_work(const TriangleMesh& lumen, const Centreline& line, const Candidate& candidate) {
  const Vector3d low = line.points[station_at(line, candidate.annulus_arc)], high = line.points[station_at(line, candidate.junction_arc)];
  const Vector3d middle = line.points[station_at(line, candidate.sinus_arc)];
  Working work;
  work.axis = make_axis(candidate.inlet_missing ? middle : low, high);
  work.z_sinus = (middle - work.axis.origin).dot(work.axis.direction);
  work.diameter = candidate.sinus_diameter;
  work.inlet_missing = candidate.inlet_missing;
  if (candidate.inlet_missing) rest_on_sections(lumen, work);
  return work;
}

std::string settle_junction(const TriangleMesh& lumen, const RootOptions& options, Working& work) {
  RootPlane& plane = work.root.sinotubular_junction;
  const auto found = find_junction(lumen, work.axis, work.z_sinus, work.diameter);
  if (options.sinotubular_junction) {
    plane = measure_plane(lumen, options.sinotubular_junction->center, options.sinotubular_junction->normal);
  } else if (found) {
    plane = measure_plane(lumen, work.axis.at(0, 0, *found), work.axis.direction);
  } else {
    return "the sinotubular junction is unresolved: the vessel does not narrow above the sinuses; give its plane";
  }
  if (plane.normal.dot(work.axis.direction) < 0) plane.normal *= -1;
  work.z_junction = plane_height(work.axis, plane);
  return "";
}

// Where a vessel cut off through its sinuses would have had its annulus: the plane below them in which it has closed to 0.75 of their
// width.
std::optional<PlaneOverride> guess_annulus(const TriangleMesh& lumen, const Working& work) {
  for (double below = 0.2; below < 0.9; below += 0.02) {
    const Section section = section_around(lumen, work.axis.at(0, 0, work.z_sinus - below * work.diameter), work.axis.direction);
    if (section.contour.empty()) break;
    if (section.diameter() < 0.75 * work.diameter) return PlaneOverride{section.center, work.axis.direction};
  }
  return std::nullopt;
}

// The user's plane; where the lumen does not reach down to it (a label that ends at the valve), the nearest one above that crosses it.
RootPlane plane_inside(const TriangleMesh& lumen, const PlaneOverride& given, Working& work) {
  Vector3d normal = given.normal.normalized();
  if (normal.dot(work.axis.direction) < 0) normal = -normal;
  RootPlane plane;
  for (int step = 0; step <= 20; ++step) {
    const double up = 0.5e-3 * step;
    plane = measure_plane(lumen, given.center + up * normal, normal);
    if (plane.mean_diameter < 0.55 * work.diameter) continue;
    work.note = step == 0 ? "" : "the annulus plane that was given lies outside the lumen; moved up by " + in_millimetres(up);
    return plane;
  }
  plane.mean_diameter = 0;
  return plane;
}

std::string settle_annulus(const TriangleMesh& lumen, const TriangleTree& tree, const RootOptions& options, Working& work) {
  AorticRoot& root = work.root;
  int resolved = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto nadir = find_nadir(tree, work.axis, work.lobes.peak[i], work.z_sinus, work.diameter);
    if (nadir) root.nadirs[i] = *nadir;
    resolved += nadir.has_value();
  }
  if (options.nadirs) root.nadirs = *options.nadirs;
  if (options.annulus) {
    root.annulus = plane_inside(lumen, *options.annulus, work);
  } else if (!options.nadirs && (resolved < 3 || work.inlet_missing)) {
    return "the annulus is unresolved: no outflow tract below the sinuses";
  } else {
    const Vector3d middle = (root.nadirs[0] + root.nadirs[1] + root.nadirs[2]) / 3;
    root.annulus = measure_plane(lumen, middle, plane_normal(root.nadirs, work.axis.direction));
  }
  if (root.annulus.normal.dot(work.axis.direction) < 0) root.annulus.normal *= -1;
  if (root.annulus.mean_diameter <= 0) return "the annulus is unresolved: no closed section of the lumen in its plane";
  return "";
}

// The axis from the annulus to the junction, and the widest section between them.
void renew_axis(const TriangleMesh& lumen, Working& work) {
  work.axis = make_axis(work.root.annulus.center, work.root.sinotubular_junction.center);
  work.z_junction = plane_height(work.axis, work.root.sinotubular_junction);
  work.z_sinus = widest_between(lumen, work.axis, 0, work.z_junction);
  work.root.sinuses = measure_plane(lumen, work.axis.at(0, 0, work.z_sinus), work.axis.direction);
  work.diameter = work.root.sinuses.mean_diameter;
}

// Nadirs below the lobes in the plane that the user gave.
void place_nadirs(const TriangleTree& tree, Working& work) {
  const RootPlane& annulus = work.root.annulus;
  for (std::size_t i = 0; i < 3; ++i) {
    const double theta = work.lobes.peak[i];
    const Vector3d direction = std::cos(theta) * work.axis.x_axis + std::sin(theta) * work.axis.y_axis;
    const Vector3d in_plane = (direction - direction.dot(annulus.normal) * annulus.normal).normalized();
    const double r = tree.first_hit(annulus.center, in_plane);
    work.root.nadirs[i] = annulus.center + (std::isinf(r) ? annulus.mean_diameter / 2 : r) * in_plane;
  }
}

// Why a found root cannot be one; "" where nothing speaks against it. What the user gave is not doubted.
std::string doubts_about(const Working& work, const RootOptions& options) {
  const double narrowing = work.root.sinotubular_junction.mean_diameter / work.root.sinuses.mean_diameter;
  if (!options.sinotubular_junction && (narrowing < 0.6 || narrowing > 0.99))
    return "the sinotubular junction is unresolved: the vessel ends or goes on too wide above the sinuses; give its plane";
  if (options.annulus || options.nadirs) return "";
  const RootPlane &annulus = work.root.annulus, &sinuses = work.root.sinuses;
  const double share = annulus.mean_diameter / sinuses.mean_diameter;
  const double tilt = std::acos(std::clamp(annulus.normal.dot(work.axis.direction), -1.0, 1.0)) * 180 / pi;
  const double length = work.z_junction / sinuses.mean_diameter;
  char text[200];
  if (share < 0.55 || share > 0.95) {
    std::snprintf(text, sizeof text,
                  "the annulus is unresolved: the plane through the sinuses' nadirs would be %.1f mm wide against %.1f mm at the sinuses",
                  1e3 * annulus.mean_diameter, 1e3 * sinuses.mean_diameter);
    return text;
  }
  if (!options.sinotubular_junction && annulus.mean_diameter > 1.3 * work.root.sinotubular_junction.mean_diameter)
    return "the annulus is unresolved: it would be wider than the junction by a third";
  if (tilt > 35) {
    std::snprintf(text, sizeof text, "the annulus is unresolved: the plane through the sinuses' nadirs leans by %.0f degrees", tilt);
    return text;
  }
  if (!options.sinotubular_junction && (length < 0.35 || length > 1.6)) {
    std::snprintf(text, sizeof text, "the annulus is unresolved: it would lie %.1f mm below the junction", 1e3 * work.z_junction);
    return text;
  }
  return "";
}

// Steps 5-7, repeated while the axis settles.
Attempt settle_root(const TriangleMesh& lumen, const TriangleTree& tree, const Centreline& line, const Candidate& candidate,
                    const RootOptions& options) {
  Attempt attempt;
  attempt.line = line;
  Working work = start_work(lumen, line, candidate);
  for (int round = 0; round < 4; ++round) {
    work.lobes = find_lobes(tree, work.axis, work.z_sinus, work.diameter);
    if (!work.lobes.found) {
      attempt.why = "the widening of " + in_millimetres(work.diameter) + " is not a root: " + work.lobes.why;
      return attempt;
    }
    attempt.three_lobes = true;
    attempt.prominence = work.lobes.prominence;
    attempt.sinus_diameter = work.diameter;
    attempt.why = settle_junction(lumen, options, work);
    if (!attempt.why.empty()) return attempt;
    attempt.junction_diameter = work.root.sinotubular_junction.mean_diameter;
    if (work.inlet_missing && work.diameter < 1.12 * attempt.junction_diameter) {  // an end without an outflow tract has to be clearer
      attempt.three_lobes = false;
      attempt.why = "the widening of " + in_millimetres(work.diameter) + " at the end is not a root: the vessel hardly narrows above it";
      return attempt;
    }
    attempt.why = settle_annulus(lumen, tree, options, work);
    if (!attempt.why.empty()) {
      attempt.likely_annulus = guess_annulus(lumen, work);
      return attempt;
    }
    renew_axis(lumen, work);
  }
  if (options.annulus && !options.nadirs) place_nadirs(tree, work);
  place_commissures(tree, work.axis, work.lobes, work.z_junction, 0, work.root);
  if (options.commissures) work.root.commissures = *options.commissures;
  attempt.order = work.root.annulus.mean_diameter / work.root.sinotubular_junction.mean_diameter;
  attempt.why = doubts_about(work, options);
  attempt.note = work.note;
  if (attempt.why.empty()) attempt.root = work.root;
  return attempt;
}

bool runs_the_wrong_way(const Centreline& line, const RootOptions& options) {
  if (!options.ventricle_point) return false;
  return (line.points.front() - *options.ventricle_point).norm() > (line.points.back() - *options.ventricle_point).norm();
}

std::string mend_of_annulus(const std::string& why) {
  return why.find("unresolved") == std::string::npos ? why : why + "; give root.annulus in the scene, or import with --build-root";
}

}  // namespace

RootSearch find_aortic_root(const TriangleMesh& lumen, const std::vector<Centreline>& centrelines, const RootOptions& options) {
  RootSearch search;
  const TriangleTree tree(lumen);
  std::vector<Attempt> attempts;
  // First with both ends left out generously; only where that finds nothing, nearly up to the ends.
  std::vector<BoreProfile> bores;
  for (const Centreline& given : centrelines) bores.push_back(measure_bore(lumen, given));
  auto any_root = [&] { return std::any_of(attempts.begin(), attempts.end(), [](const Attempt& a) { return a.root.has_value(); }); };
  for (const double share : {0.5, 0.15}) {
    if (any_root()) break;
    for (std::size_t l = 0; l < centrelines.size(); ++l)
      for (const bool backward : {false, true}) {
        const Centreline line = backward ? reversed(centrelines[l]) : centrelines[l];
        if (line.size() < 10 || runs_the_wrong_way(line, options)) continue;
        const BoreProfile bore = without_ends(backward ? reversed(bores[l]) : bores[l], share);
        for (const Candidate& candidate : find_widenings(bore)) attempts.push_back(settle_root(lumen, tree, line, candidate, options));
      }
  }
  const Attempt* best = nullptr;
  for (const Attempt& attempt : attempts)
    if (attempt.root && (best == nullptr || attempt.order < best->order)) best = &attempt;
  if (best != nullptr) {
    search.root = best->root;
    if (!best->note.empty()) search.warnings.push_back(best->note);
    search.centreline = best->line;
    return search;
  }
  for (const Attempt& attempt : attempts)  // three lobes without an annulus or junction: worth telling
    if (attempt.three_lobes && (best == nullptr || attempt.prominence > best->prominence)) best = &attempt;
  if (best != nullptr) {
    search.centreline = best->line;
    search.likely_annulus = best->likely_annulus;
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
