#include "geometry/sections.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

namespace geometry {
namespace {

using Eigen::Vector3d;

std::uint64_t edge_key(std::int32_t a, std::int32_t b) {
  return std::uint64_t(std::uint32_t(std::min(a, b))) << 32 | std::uint32_t(std::max(a, b));
}

// A contour crosses each cut triangle from one of its edges to another; the edges' keys chain the pieces exactly, without tolerances.
struct Link {
  std::uint64_t to;
  Vector3d at;  // where the contour crosses the edge it comes from
};

Vector3d crossing_point(const TriangleMesh& mesh, std::int32_t a, std::int32_t b, const std::vector<double>& height) {
  if (a > b) std::swap(a, b);
  const double p = height[std::size_t(a)], q = height[std::size_t(b)];
  return mesh.vertices[std::size_t(a)] + p / (p - q) * (mesh.vertices[std::size_t(b)] - mesh.vertices[std::size_t(a)]);
}

std::vector<std::vector<Vector3d>> closed_contours(const TriangleMesh& mesh, const std::vector<double>& height) {
  std::unordered_map<std::uint64_t, Link> links;
  std::vector<std::uint64_t> starts;
  for (const auto& t : mesh.triangles) {
    const bool above[3] = {height[std::size_t(t[0])] >= 0, height[std::size_t(t[1])] >= 0, height[std::size_t(t[2])] >= 0};
    if (above[0] == above[1] && above[1] == above[2]) continue;
    std::size_t enter = 0, leave = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (above[c] && !above[(c + 1) % 3]) enter = c;
      if (!above[c] && above[(c + 1) % 3]) leave = c;
    }
    const std::uint64_t from = edge_key(t[enter], t[(enter + 1) % 3]), to = edge_key(t[leave], t[(leave + 1) % 3]);
    links[from] = {to, crossing_point(mesh, t[enter], t[(enter + 1) % 3], height)};
    starts.push_back(from);
  }
  std::vector<std::vector<Vector3d>> contours;
  for (std::uint64_t start : starts) {
    std::vector<Vector3d> contour;
    std::uint64_t at = start;
    for (auto link = links.find(at); link != links.end(); link = links.find(at)) {
      contour.push_back(link->second.at);
      at = link->second.to;
      links.erase(link);
      if (at == start) break;
    }
    if (contour.size() >= 3 && at == start) contours.push_back(std::move(contour));
  }
  return contours;
}

Section measure_section(std::vector<Vector3d> contour, const Vector3d& normal) {
  Section section;
  const Vector3d origin = contour[0];
  Vector3d vector_area = Vector3d::Zero(), moment = Vector3d::Zero();
  for (std::size_t i = 0; i < contour.size(); ++i)
    vector_area += (contour[i] - origin).cross(contour[(i + 1) % contour.size()] - origin) / 2;
  double signed_area = vector_area.dot(normal);
  if (signed_area < 0) {
    std::reverse(contour.begin(), contour.end());
    signed_area = -signed_area;
  }
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const Vector3d a = contour[i] - origin, b = contour[(i + 1) % contour.size()] - origin;
    moment += a.cross(b).dot(normal) / 2 * (a + b) / 3;
  }
  section.area = signed_area;
  section.center = signed_area > 0 ? Vector3d(origin + moment / signed_area) : origin;
  const Vector3d x_axis = normal.unitOrthogonal(), y_axis = normal.cross(x_axis);
  constexpr int directions = 90;
  double widths[directions];
  for (int d = 0; d < directions; ++d) {
    const double angle = std::numbers::pi * d / directions;
    const Vector3d direction = std::cos(angle) * x_axis + std::sin(angle) * y_axis;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vector3d& p : contour) {
      const double s = (p - section.center).dot(direction);
      low = std::min(low, s);
      high = std::max(high, s);
    }
    widths[d] = high - low;
  }
  const int widest = int(std::max_element(widths, widths + directions) - widths);
  section.largest_width = widths[widest];
  section.perpendicular_width = widths[(widest + directions / 2) % directions];
  section.contour = std::move(contour);
  return section;
}

bool holds_point(const Section& section, const Vector3d& point, const Vector3d& normal) {
  const Vector3d x_axis = normal.unitOrthogonal(), y_axis = normal.cross(x_axis);
  bool inside = false;
  for (std::size_t i = 0; i < section.contour.size(); ++i) {
    const Vector3d a = section.contour[i] - point, b = section.contour[(i + 1) % section.contour.size()] - point;
    const double ay = a.dot(y_axis), by = b.dot(y_axis);
    if ((ay > 0) == (by > 0)) continue;
    if (a.dot(x_axis) + ay / (ay - by) * (b - a).dot(x_axis) > 0) inside = !inside;
  }
  return inside;
}

}  // namespace

double Section::diameter() const { return 2 * std::sqrt(area / std::numbers::pi); }

std::vector<Section> cut_sections(const TriangleMesh& mesh, const Vector3d& point, const Vector3d& normal) {
  const Vector3d unit = normal.normalized();
  std::vector<double> height(mesh.vertices.size());
  for (std::size_t v = 0; v < height.size(); ++v) height[v] = (mesh.vertices[v] - point).dot(unit);
  std::vector<Section> sections;
  for (auto& contour : closed_contours(mesh, height)) sections.push_back(measure_section(std::move(contour), unit));
  return sections;
}

Section section_around(const TriangleMesh& mesh, const Vector3d& point, const Vector3d& normal) {
  const Vector3d unit = normal.normalized();
  Section best;
  for (Section& section : cut_sections(mesh, point, normal))
    if (holds_point(section, point, unit) && (best.contour.empty() || section.area < best.area)) best = std::move(section);
  return best;
}

std::vector<double> section_radii(const Section& section, const Vector3d& center, const Vector3d& x_axis, const Vector3d& y_axis,
                                  int count) {
  std::vector<double> radii(std::size_t(count), std::numeric_limits<double>::infinity());
  const double step = 2 * std::numbers::pi / count;
  const std::size_t n = section.contour.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d a3 = section.contour[i] - center, b3 = section.contour[(i + 1) % n] - center;
    const Eigen::Vector2d a(a3.dot(x_axis), a3.dot(y_axis)), b(b3.dot(x_axis), b3.dot(y_axis));
    double from = std::atan2(a.y(), a.x()), turn = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    if (turn < 0) {
      from += turn;
      turn = -turn;
    }
    for (double k = std::ceil(from / step - 1e-9); k * step <= from + turn + 1e-12; ++k) {
      const Eigen::Vector2d ray(std::cos(k * step), std::sin(k * step)), edge = b - a;
      const double determinant = edge.x() * ray.y() - edge.y() * ray.x();
      if (determinant == 0) continue;
      const double distance = (edge.x() * a.y() - edge.y() * a.x()) / determinant;
      const auto slot = std::size_t(((long(k) % count) + count) % count);
      if (distance > 0) radii[slot] = std::min(radii[slot], distance);
    }
  }
  return radii;
}

}  // namespace geometry
