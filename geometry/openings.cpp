#include "geometry/openings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

#include "geometry/sections.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

Vector3d face_normal(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& t) {  // length = twice the area
  const Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])], &c = mesh.vertices[std::size_t(t[2])];
  return (b - a).cross(c - a);
}

std::vector<Vector3d> positions(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop) {
  std::vector<Vector3d> points;
  for (std::int32_t v : loop) points.push_back(mesh.vertices[std::size_t(v)]);
  return points;
}

double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Smallest angle's sine-like quality of the ear (p, q, r) in [-1, 1]; <= 0 where it turns the wrong way.
double ear_quality(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
  const double longest = std::max({(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()});
  return longest > 0 ? cross2(q - p, r - p) / longest : 0;
}

bool holds(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r, const Eigen::Vector2d& x) {
  return cross2(q - p, x - p) > 0 && cross2(r - q, x - q) > 0 && cross2(p - r, x - r) > 0;
}

// Ear clipping, always the best-shaped valid ear; where a warped rim leaves none, the least bad one, so that it always ends closed.
std::vector<std::array<std::size_t, 3>> clip_ears(const std::vector<Eigen::Vector2d>& polygon) {
  std::vector<std::size_t> left(polygon.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  auto quality_at = [&](std::size_t i) {
    const std::size_t before = left[(i + left.size() - 1) % left.size()], here = left[i], after = left[(i + 1) % left.size()];
    double quality = ear_quality(polygon[before], polygon[here], polygon[after]);
    if (quality <= 0) return quality;
    for (std::size_t other : left)
      if (other != before && other != here && other != after && holds(polygon[before], polygon[here], polygon[after], polygon[other]))
        return -1.0;
    return quality;
  };
  std::vector<double> quality(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) quality[i] = quality_at(i);
  std::vector<std::array<std::size_t, 3>> triangles;
  while (left.size() > 3) {
    const auto best = std::size_t(std::max_element(quality.begin(), quality.end()) - quality.begin());
    triangles.push_back({left[(best + left.size() - 1) % left.size()], left[best], left[(best + 1) % left.size()]});
    left.erase(left.begin() + std::ptrdiff_t(best));
    quality.erase(quality.begin() + std::ptrdiff_t(best));
    const std::size_t n = left.size();
    for (std::size_t i : {(best + n - 1) % n, best % n}) quality[i] = quality_at(i);
  }
  if (left.size() == 3) triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

void make_plane_axes(const Vector3d& normal, Vector3d& x_axis, Vector3d& y_axis) {
  x_axis = normal.unitOrthogonal();
  y_axis = normal.cross(x_axis);
}

}  // namespace

std::vector<std::vector<std::int32_t>> border_loops(const TriangleMesh& mesh) {
  std::set<std::pair<std::int32_t, std::int32_t>> directed;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) directed.insert({t[c], t[(c + 1) % 3]});
  std::map<std::int32_t, std::vector<std::int32_t>> next;
  for (const auto& [a, b] : directed)
    if (!directed.count({b, a})) next[a].push_back(b);
  std::vector<std::vector<std::int32_t>> loops;
  while (!next.empty()) {
    std::vector<std::int32_t> path{next.begin()->first};
    std::unordered_map<std::int32_t, std::size_t> place{{path[0], 0}};
    for (;;) {  // walk; each time the path meets itself a loop is complete, so loops touching at a corner come apart
      const auto out = next.find(path.back());
      if (out == next.end()) break;  // a border that does not close: badly oriented faces beside it
      const std::int32_t to = out->second.back();
      out->second.pop_back();
      if (out->second.empty()) next.erase(out);
      const auto seen = place.find(to);
      if (seen == place.end()) {
        place[to] = path.size();
        path.push_back(to);
        continue;
      }
      const std::size_t begin = seen->second;
      loops.emplace_back(path.begin() + std::ptrdiff_t(begin), path.end());
      for (std::size_t i = begin + 1; i < path.size(); ++i) place.erase(path[i]);
      path.resize(begin + 1);
      if (path.size() == 1 && !next.count(path[0])) break;
    }
  }
  return loops;
}

OpenEnd measure_loop(const std::vector<Vector3d>& rim) {
  OpenEnd end;
  end.rim = rim;
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : rim) mean += p / double(rim.size());
  Vector3d area = Vector3d::Zero(), moment = Vector3d::Zero();
  for (std::size_t i = 0; i < rim.size(); ++i) area += (rim[i] - mean).cross(rim[(i + 1) % rim.size()] - mean) / 2;
  end.area = area.norm();
  end.normal = end.area > 0 ? Vector3d(-area / end.area) : Vector3d::UnitZ();  // the wall's half-edges run clockwise as seen from outside
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vector3d &a = rim[i], &b = rim[(i + 1) % rim.size()];
    moment += -(a - mean).cross(b - mean).dot(end.normal) / 2 * ((a - mean) + (b - mean)) / 3;
  }
  end.center = end.area > 0 ? Vector3d(mean + moment / end.area) : mean;
  end.radius = std::sqrt(end.area / std::numbers::pi);
  for (const Vector3d& p : rim) end.radius_max = std::max(end.radius_max, (p - end.center).norm());
  return end;
}

bool is_vessel_end(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop, double minimum_diameter) {
  const OpenEnd end = measure_loop(positions(mesh, loop));
  if (2 * end.radius < minimum_diameter) return false;
  // The wall within a third of a radius of the rim: does it run along the cap's normal (end) or in the cap's plane (hole)?
  std::vector<bool> near(mesh.vertices.size(), false);
  for (std::size_t v = 0; v < near.size(); ++v) {
    if ((mesh.vertices[v] - end.center).norm() > end.radius_max + 0.35 * end.radius) continue;
    for (const Vector3d& p : end.rim)
      if ((mesh.vertices[v] - p).norm() < 0.3 * end.radius) {
        near[v] = true;
        break;
      }
  }
  double along = 0, total = 0;
  for (const auto& t : mesh.triangles) {
    if (!near[std::size_t(t[0])] && !near[std::size_t(t[1])] && !near[std::size_t(t[2])]) continue;
    const Vector3d normal = face_normal(mesh, t);
    along += std::abs(normal.dot(end.normal));
    total += normal.norm();
  }
  return total > 0 && along < 0.6 * total;
}

std::size_t cap_loop(TriangleMesh& mesh, const std::vector<std::int32_t>& loop) {
  std::vector<std::int32_t> rim(loop.rbegin(), loop.rend());  // against the wall's half-edges
  const OpenEnd end = measure_loop(positions(mesh, loop));
  Vector3d x_axis, y_axis;
  make_plane_axes(end.normal, x_axis, y_axis);
  std::vector<Eigen::Vector2d> polygon;
  for (std::int32_t v : rim) {
    const Vector3d d = mesh.vertices[std::size_t(v)] - end.center;
    polygon.emplace_back(d.dot(x_axis), d.dot(y_axis));
  }
  const auto ears = clip_ears(polygon);
  for (const auto& ear : ears) mesh.triangles.push_back({rim[ear[0]], rim[ear[1]], rim[ear[2]]});
  return ears.size();
}

}  // namespace geometry
