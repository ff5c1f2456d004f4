#include "sim/orifice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Projection {
  Vector3d origin, x, y;
  Vector2d operator()(const Vector3d& p) const { return {x.dot(p - origin), y.dot(p - origin)}; }
};

Projection make_projection(const ValveFrame& valve) {
  int axis = 0;
  valve.axis.cwiseAbs().minCoeff(&axis);
  const Vector3d x = (Vector3d::Unit(axis) - valve.axis * valve.axis[axis]).normalized();
  return {valve.annulus_center, x, valve.axis.cross(x)};
}

// Lumen radius by direction: the outermost held row at the leaflets' base, in 5-degree bins; empty bins between neighbours' values.
class LumenRadius {
 public:
  LumenRadius(const ValveSheet& sheet, const Projection& project) : radius_(bins, 0.0) {
    bool any = false;
    for (std::size_t i = 0; i < sheet.size(); ++i) {
      if (!sheet.held[i]) continue;
      const Vector2d p = project(sheet.rest[i]);
      double& r = radius_[bin(p)];
      r = std::max(r, p.norm());
      any = true;
    }
    if (!any) std::fill(radius_.begin(), radius_.end(), sheet.frame.commissure_radius);
    const std::vector<double> found = radius_;
    for (int b = 0; b < bins; ++b) {
      int before = b, after = b;
      while (found[(before + bins) % bins] == 0) --before;
      while (found[after % bins] == 0) ++after;
      const double t = after > before ? static_cast<double>(b - before) / (after - before) : 0;
      radius_[b] = (1 - t) * found[(before + bins) % bins] + t * found[after % bins];
    }
  }
  // At least `margin` within, so that the chords between held rows leave no slivers.
  bool inside(const Vector2d& p, double margin) const { return p.norm() < radius_[bin(p)] - margin; }
  double largest() const { return *std::max_element(radius_.begin(), radius_.end()); }

 private:
  static constexpr int bins = 72;
  static int bin(const Vector2d& p) {
    const double turn = std::atan2(p.y(), p.x()) / (2 * std::numbers::pi) + 1;
    return static_cast<int>(turn * bins) % bins;
  }
  std::vector<double> radius_;
};

double segment_distance_squared(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  const double t = std::clamp((p - a).dot(d) / std::max(d.squaredNorm(), 1e-30), 0.0, 1.0);
  return (p - a - t * d).squaredNorm();
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Within the triangle or no farther than `reach` from its border.
bool covers(const std::array<Vector2d, 3>& t, const Vector2d& p, double reach) {
  const double a = cross(t[1] - t[0], p - t[0]), b = cross(t[2] - t[1], p - t[1]), c = cross(t[0] - t[2], p - t[2]);
  if ((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) return true;
  const double limit = reach * reach;
  return segment_distance_squared(p, t[0], t[1]) <= limit || segment_distance_squared(p, t[1], t[2]) <= limit ||
         segment_distance_squared(p, t[2], t[0]) <= limit;
}

struct Raster {
  int size = 0;  // pixels a side
  double low = 0, pixel = 0;
  std::vector<std::uint8_t> open;
  Vector2d center(int i, int j) const { return {low + (i + 0.5) * pixel, low + (j + 0.5) * pixel}; }
  int index(double x) const { return std::clamp(static_cast<int>(std::floor((x - low) / pixel)), 0, size - 1); }
};

void cover(Raster& raster, const std::array<Vector2d, 3>& triangle, double reach) {
  const Vector2d low = triangle[0].cwiseMin(triangle[1]).cwiseMin(triangle[2]).array() - reach;
  const Vector2d high = triangle[0].cwiseMax(triangle[1]).cwiseMax(triangle[2]).array() + reach;
  if (high.minCoeff() < raster.low || low.maxCoeff() > raster.low + raster.size * raster.pixel) return;
  for (int j = raster.index(low.y()); j <= raster.index(high.y()); ++j)
    for (int i = raster.index(low.x()); i <= raster.index(high.x()); ++i) {
      std::uint8_t& open = raster.open[static_cast<std::size_t>(j) * raster.size + i];
      if (open && covers(triangle, raster.center(i, j), reach)) open = 0;
    }
}

// Open pixels within `reach` of an open pixel of `core`; the rest of them closed.
void keep_near(Raster& raster, const std::vector<std::uint8_t>& core, double reach) {
  const int pixels = static_cast<int>(std::ceil(reach / raster.pixel));
  const double limit = std::pow(reach / raster.pixel + 0.5, 2);
  const auto near_core = [&](int i, int j) {
    for (int b = std::max(0, j - pixels); b <= std::min(raster.size - 1, j + pixels); ++b)
      for (int a = std::max(0, i - pixels); a <= std::min(raster.size - 1, i + pixels); ++a)
        if (core[static_cast<std::size_t>(b) * raster.size + a] && (a - i) * (a - i) + (b - j) * (b - j) <= limit) return true;
    return false;
  };
  for (int j = 0; j < raster.size; ++j)
    for (int i = 0; i < raster.size; ++i) {
      const std::size_t at = static_cast<std::size_t>(j) * raster.size + i;
      if (raster.open[at] && !core[at] && !near_core(i, j)) raster.open[at] = 0;
    }
}

// Flood fill over open pixels sharing a side; returns the largest component's pixel count and clears the raster.
std::size_t largest_component(Raster& raster) {
  std::size_t largest = 0;
  std::vector<std::size_t> stack;
  const auto size = static_cast<std::size_t>(raster.size);
  for (std::size_t seed = 0; seed < raster.open.size(); ++seed) {
    if (!raster.open[seed]) continue;
    std::size_t count = 0;
    raster.open[seed] = 0;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::size_t p = stack.back(), column = p % size;
      stack.pop_back();
      ++count;
      auto visit = [&](bool within, std::size_t q) {
        if (within && raster.open[q]) raster.open[q] = 0, stack.push_back(q);
      };
      visit(column > 0, p - 1);
      visit(column + 1 < size, p + 1);
      visit(p >= size, p - size);
      visit(p + size < raster.open.size(), p + size);
    }
    largest = std::max(largest, count);
  }
  return largest;
}

}  // namespace

OrificeArea geometric_orifice_area(const ValveSheet& sheet, std::span<const Vector3d> position, double half_thickness, double half_contact,
                                   double resolution) {
  const Projection project = make_projection(sheet.frame);
  const LumenRadius lumen(sheet, project);
  Raster raster;
  raster.pixel = resolution;
  raster.size = 2 * static_cast<int>(std::ceil(lumen.largest() / resolution)) + 2;
  raster.low = -0.5 * raster.size * resolution;
  raster.open.resize(static_cast<std::size_t>(raster.size) * raster.size);
  for (int j = 0; j < raster.size; ++j)
    for (int i = 0; i < raster.size; ++i)
      raster.open[static_cast<std::size_t>(j) * raster.size + i] = lumen.inside(raster.center(i, j), resolution);
  const auto cover_all = [&](double reach) {
    for (const auto& element : sheet.elements)
      cover(raster, {project(position[element[0]]), project(position[element[1]]), project(position[element[2]])}, reach);
  };
  cover_all(half_thickness);
  if (half_contact > half_thickness) {
    const std::vector<std::uint8_t> seen = raster.open;
    cover_all(half_contact);
    const std::vector<std::uint8_t> core = raster.open;
    raster.open = seen;
    keep_near(raster, core, half_contact - half_thickness);
  }
  OrificeArea result;
  const double pixel_area = resolution * resolution;
  result.area = pixel_area * static_cast<double>(std::count(raster.open.begin(), raster.open.end(), 1));
  result.largest_opening = pixel_area * static_cast<double>(largest_component(raster));
  return result;
}

}  // namespace sim
