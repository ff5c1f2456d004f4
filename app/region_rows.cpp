#include "app/region_rows.h"

#include <cmath>
#include <numeric>

#include "app/to_geometry.h"

namespace app {

geometry::Shape region_shape(const ShapeSpec& region, int dimension, double spacing) {
  ShapeSpec padded = region;
  for (int axis = 0; axis < 3; ++axis)
    if (padded.type == ShapeType::box && padded.max[axis] - padded.min[axis] < 1e-6 * spacing) {
      padded.min[axis] -= 1e-6 * spacing;
      padded.max[axis] += 1e-6 * spacing;
    }
  return to_geometry(padded, dimension, spacing);
}

std::vector<std::int64_t> rows_in_region(const ShapeSpec& region, const BodyParticles& body, int dimension, double spacing) {
  const geometry::Shape shape = region_shape(region, dimension, spacing);
  std::vector<std::int64_t> inside, cut;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const double distance = geometry::signed_distance(shape, body.position[i], dimension);
    if (distance <= 1e-9 * spacing) inside.push_back(static_cast<std::int64_t>(i));
    if (distance <= 0.5001 * spacing) cut.push_back(static_cast<std::int64_t>(i));
  }
  const std::vector<std::int64_t>& found = inside.empty() ? cut : inside;
  if (found.empty())
    refuse(region.spot, "holds no particle of body \"" + body.name + "\"", "regions are in the initial configuration, in m");
  return found;
}

void move_shares_to_region(const ShapeSpec& region, const BodyParticles& body, int dimension, double spacing,
                           std::vector<std::int64_t>& rows, std::vector<double>& share) {
  const geometry::Shape shape = region_shape(region, dimension, spacing);
  const std::size_t count = rows.size();
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::Vector3d x = body.position[static_cast<std::size_t>(rows[k])];
    const double away = geometry::signed_distance(shape, x, dimension);
    if (away <= 1e-9 * spacing) continue;
    const Eigen::Vector3d back = geometry::distance_gradient(shape, x, dimension, 1e-4 * spacing);
    std::size_t behind = body.size();
    double nearest = 0.3 * spacing;
    for (std::size_t j = 0; j < body.size(); ++j) {
      const double miss = (body.position[j] - x - spacing * back).norm();
      if (miss < nearest) nearest = miss, behind = j;
    }
    if (behind == body.size()) continue;
    const double lever = away / (body.position[behind] - x).dot(back) * share[k];
    share[k] += lever;
    rows.push_back(static_cast<std::int64_t>(behind));
    share.push_back(-lever);
  }
}

std::vector<std::int64_t> surface_rows(const std::optional<ShapeSpec>& region, const BodyParticles& body, int dimension, double spacing) {
  std::vector<std::int64_t> rows;
  if (body.kind == sim::Kind::shell) {
    if (region) return rows_in_region(*region, body, dimension, spacing);
    rows.resize(body.size());
    std::iota(rows.begin(), rows.end(), std::int64_t{0});
    return rows;
  }
  std::optional<geometry::Shape> shape;
  if (region) shape = to_geometry(*region, dimension, spacing);
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Eigen::Vector3d& area = body.surface_area[i];
    if (area.norm() < 1e-12 * std::pow(spacing, dimension - 1)) continue;
    const Eigen::Vector3d point = body.position[i] + body.depth[i] * area.normalized();
    const double slack = 1e-3 * spacing;
    if (!shape || geometry::signed_distance(*shape, point, dimension) <= slack ||
        geometry::signed_distance(*shape, body.position[i], dimension) <= slack)
      rows.push_back(static_cast<std::int64_t>(i));
  }
  if (rows.empty() && region)
    refuse(region->spot, "holds no part of the surface of body \"" + body.name + "\"", "let it enclose the surface");
  return rows;
}

}  // namespace app
