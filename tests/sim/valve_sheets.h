// Made-up leaflets whose figures are known in closed form.
#pragma once

#include <cmath>

#include "sim/valve_sheet.h"

namespace valve_sheets {

using Eigen::Vector3d;

inline sim::ValveFrame frame(double radius) {
  sim::ValveFrame valve;
  valve.annulus_center = Vector3d(0, 0, -5e-3);
  valve.axis = Vector3d::UnitZ();
  valve.annulus_radius = valve.commissure_radius = radius;
  valve.commissure_height = 12e-3;
  valve.leaflet_bodies = {0, 1, 2};
  return valve;
}

struct Parts {
  std::vector<std::int32_t> leaflet;
  std::vector<Vector3d> rest;
  std::vector<std::uint8_t> held;
  std::vector<std::array<std::int32_t, 3>> elements;
  sim::ValveSheet build(double radius, double spacing, double thickness) const {
    sim::ValveSheet sheet = sim::make_valve_sheet(frame(radius), spacing, thickness, leaflet, rest, held, elements);
    for (std::size_t i = 0; i < sheet.size(); ++i) sheet.row.push_back(static_cast<std::int64_t>(i));
    return sheet;
  }
};

// A flat ring from `inner` to `outer` about the axis, the outermost row held: one leaflet with a hole.
inline Parts ring(double inner, double outer, int rows = 8, int around = 60) {
  Parts parts;
  for (int k = 0; k < rows; ++k)
    for (int j = 0; j < around; ++j) {
      const double r = inner + (outer - inner) * k / (rows - 1), a = 2 * M_PI * j / around;
      parts.rest.emplace_back(r * std::cos(a), r * std::sin(a), 1e-3 * k);
      parts.leaflet.push_back(0), parts.held.push_back(k == rows - 1);
      if (k + 1 == rows) continue;
      const int next = (j + 1) % around;
      parts.elements.push_back({k * around + j, (k + 1) * around + j, (k + 1) * around + next});
      parts.elements.push_back({k * around + j, (k + 1) * around + next, k * around + next});
    }
  return parts;
}

// A sheet of columns x rows points, corner + i u + j v, as leaflet `leaflet`; column 0 held where asked.
inline void add_sheet(Parts& parts, int leaflet, const Vector3d& corner, const Vector3d& u, const Vector3d& v, int columns, int rows,
                      bool hold = false) {
  const auto first = static_cast<std::int32_t>(parts.rest.size());
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      parts.rest.push_back(corner + i * u + j * v);
      parts.leaflet.push_back(leaflet), parts.held.push_back(hold && i == 0);
      if (i + 1 == columns || j + 1 == rows) continue;
      const std::int32_t a = first + j * columns + i;
      parts.elements.push_back({a, a + 1, a + columns + 1});
      parts.elements.push_back({a, a + columns + 1, a + columns});
    }
}

// Three flat leaflets hinged at radius `radius` in thirds of the circle (as in a tri-leaflet door): each a strip of `width` that reaches
// inwards by `length` and is turned up from the horizontal by `angle`; z = 0 at the hinge. Tips lie at radius - length cos(angle).
inline Parts doors(double radius, double length, double width, double angle, double spacing) {
  Parts parts;
  const int columns = static_cast<int>(std::lround(length / spacing)) + 1,
            rows = 2 * static_cast<int>(std::lround(width / spacing / 2)) + 1;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * M_PI * k / 3;
    const Vector3d out(std::cos(turn), std::sin(turn), 0), side(-std::sin(turn), std::cos(turn), 0);
    const Vector3d u = length / (columns - 1) * (-std::cos(angle) * out + std::sin(angle) * Vector3d::UnitZ());
    add_sheet(parts, k, radius * out - 0.5 * width * side, u, width / (rows - 1) * side, columns, rows, true);
  }
  return parts;
}

}  // namespace valve_sheets
