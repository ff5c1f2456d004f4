#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/orifice.h"
#include "sim/point_grid.h"

namespace sim {
namespace {

using Eigen::Vector3d;

double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  return (p - a - std::clamp((p - a).dot(d) / std::max(d.squaredNorm(), 1e-30), 0.0, 1.0) * d).norm();
}

double distance_to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const auto within = [&](const Vector3d& u, const Vector3d& v) { return normal.dot((v - u).cross(p - u)) >= 0; };
  if (normal.squaredNorm() > 0 && within(a, b) && within(b, c) && within(c, a)) return std::abs(normal.dot(p - a)) / normal.norm();
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// m, from each row to the nearest point of another leaflet's triangles; where that is farther than `reach`, reach.
std::vector<double> distances_to_others(const ValveSheet& sheet, std::span<const Vector3d> position, double reach) {
  std::vector<Vector3d> middle(sheet.elements.size());
  double largest = 0;  // from a triangle's middle to its corners
  for (std::size_t e = 0; e < middle.size(); ++e) {
    const auto& [a, b, c] = sheet.elements[e];
    middle[e] = (position[a] + position[b] + position[c]) / 3;
    for (const std::int32_t corner : {a, b, c}) largest = std::max(largest, (position[corner] - middle[e]).norm());
  }
  std::vector<double> distance(sheet.size(), reach);
  const PointGrid<3> grid(middle, reach + largest);
  for (std::size_t i = 0; i < sheet.size(); ++i)
    grid.for_each_near(position[i], reach + largest, [&](std::int32_t e, double) {
      const auto& [a, b, c] = sheet.elements[e];
      if (sheet.leaflet[a] != sheet.leaflet[i])
        distance[i] = std::min(distance[i], distance_to_triangle(position[i], position[a], position[b], position[c]));
    });
  return distance;
}

// The part of a triangle in which what is a, b, c at its corners and linear between them is negative.
double negative_part(double a, double b, double c) {
  if (a > b) std::swap(a, b);
  if (b > c) std::swap(b, c);
  if (a > b) std::swap(a, b);
  if (a >= 0) return 0;
  if (c <= 0) return 1;
  return b >= 0 ? a * a / ((a - b) * (a - c)) : 1 - c * c / ((c - a) * (c - b));
}
// The same of a line.
double negative_part(double a, double b) {
  return (a < 0) == (b < 0) ? (a < 0 ? 1.0 : 0.0) : std::min(a, b) / (std::min(a, b) - std::max(a, b));
}

// m: along the line in which the plane through the leaflet's tip and the valve's axis cuts it at rest, as it lies now, how long it touches.
double touching_mid_line(const ValveSheet& sheet, std::span<const Vector3d> position, const std::vector<double>& gap, int leaflet) {
  const ValveSheet::Leaflet& one = sheet.leaflets[static_cast<std::size_t>(leaflet)];
  const Vector3d side = sheet.frame.axis.cross(one.outward), tip = sheet.rest[static_cast<std::size_t>(one.tip)];
  double length = 0;
  for (const auto& element : sheet.elements) {
    if (sheet.leaflet[element[0]] != leaflet) continue;
    Vector3d ends[2];
    double gaps[2];
    int found = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = element[k], b = element[(k + 1) % 3];
      const double from = side.dot(sheet.rest[a] - tip), to = side.dot(sheet.rest[b] - tip);
      if ((from < 0) == (to < 0)) continue;
      const double part = from / (from - to);
      ends[found] = position[a] + part * (position[b] - position[a]);
      gaps[found++] = gap[a] + part * (gap[b] - gap[a]);
    }
    if (found == 2) length += negative_part(gaps[0], gaps[1]) * (ends[1] - ends[0]).norm();
  }
  return length;
}

}  // namespace

Coaptation coaptation(const ValveSheet& sheet, std::span<const Vector3d> position, double distance) {
  Coaptation result;
  std::vector<double> gap = distances_to_others(sheet, position, 2 * distance);  // less `distance`: negative where it touches
  for (double& g : gap) g -= distance;
  for (const auto& [a, b, c] : sheet.elements) {
    if (sheet.held[a] && sheet.held[b] && sheet.held[c]) continue;
    const double area = 0.5 * (position[b] - position[a]).cross(position[c] - position[a]).norm();
    result.area += 0.5 * area * negative_part(gap[a], gap[b], gap[c]);
  }
  double tips = 0;
  for (std::size_t k = 0; k < sheet.leaflets.size(); ++k) {
    const ValveSheet::Leaflet& leaflet = sheet.leaflets[k];
    for (std::size_t i = 1; i < leaflet.free_edge.size(); ++i)
      result.length += 0.5 * (position[leaflet.free_edge[i]] - position[leaflet.free_edge[i - 1]]).norm();
    if (leaflet.tip < 0) continue;
    ++tips;
    result.central += touching_mid_line(sheet, position, gap, static_cast<int>(k));
    result.effective_height += sheet.frame.axis.dot(position[leaflet.tip] - sheet.frame.annulus_center);
  }
  result.height = result.length > 0 ? result.area / result.length : 0;
  result.central /= std::max(1.0, tips);
  result.effective_height /= std::max(1.0, tips);
  return result;
}

}  // namespace sim
