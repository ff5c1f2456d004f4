#include "render/plane_field.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace render {
namespace {

struct Near {
  Eigen::Vector2f place;  // m along right and up
  float height2, value;   // m², squared distance from the plane
};

}  // namespace

PlaneField plane_field(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& plane) {
  constexpr float cells_a_reach = 5;
  constexpr double most_cells = 4e6;
  const float reach = section_reach * set.radius;
  PlaneField field;
  const Eigen::Vector3f normal = plane.normal.normalized();
  field.right = normal.unitOrthogonal();
  field.up = normal.cross(field.right);
  std::vector<Near> near;
  Eigen::Array2f low(1e30f, 1e30f), high(-1e30f, -1e30f);
  for (std::size_t i = 0; i < set.positions.size(); ++i) {
    const Eigen::Vector3f from = set.positions[i] - plane.point;
    const float height = normal.dot(from);
    if (!(std::abs(height) < reach) || !from.allFinite()) continue;
    float value = 0;
    if (scale) value = static_cast<float>((set.fields[style.field][i] - scale->minimum) / (scale->maximum - scale->minimum));
    if (std::isnan(value)) continue;
    near.push_back({{field.right.dot(from), field.up.dot(from)}, height * height, value});
    low = low.min(near.back().place.array());
    high = high.max(near.back().place.array());
  }
  if (near.empty()) return field;
  const Eigen::Array2d size = (high - low).cast<double>() + 2.0 * reach;
  field.cell = std::max(reach / cells_a_reach, static_cast<float>(std::sqrt(size.prod() / most_cells)));
  field.width = static_cast<int>(std::ceil(size.x() / field.cell)) + 1;
  field.height = static_cast<int>(std::ceil(size.y() / field.cell)) + 1;
  const Eigen::Vector2f first = low - reach;
  field.corner = plane.point + first.x() * field.right + first.y() * field.up;
  field.sums.assign(static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height), {0, 0});
  const float scale2 = 1 / (reach * reach);
  for (const Near& particle : near) {
    const Eigen::Vector2f at = (particle.place - first) / field.cell - Eigen::Vector2f(0.5f, 0.5f);  // in cells from the first one's middle
    const float wide = std::sqrt(reach * reach - particle.height2) / field.cell;
    const int bottom = std::max(0, static_cast<int>(std::ceil(at.y() - wide))),
              top = std::min(field.height - 1, static_cast<int>(std::floor(at.y() + wide)));
    const int left = std::max(0, static_cast<int>(std::ceil(at.x() - wide))),
              end = std::min(field.width - 1, static_cast<int>(std::floor(at.x() + wide)));
    for (int y = bottom; y <= top; ++y) {
      const float dy = field.cell * (static_cast<float>(y) - at.y()), row2 = particle.height2 + dy * dy;
      std::array<float, 2>* row = &field.sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(field.width)];
      for (int x = left; x <= end; ++x) {
        const float dx = field.cell * (static_cast<float>(x) - at.x()), rest = std::max(0.0f, 1 - (row2 + dx * dx) * scale2);
        const float weight = rest * rest;
        row[x][0] += weight;
        row[x][1] += weight * particle.value;
      }
    }
  }
  return field;
}

}  // namespace render
