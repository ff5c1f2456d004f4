#include "sim/solid_clamp.h"

#include <span>

#include "sim/solid_neighbors.h"

namespace sim {

namespace {

// Half-way points between a particle free along an axis and the nearest one that is fixed along it.
template <int D>
std::vector<ClampPoint<D>> estimated_points(const SceneDescription<D>& scene, std::size_t count) {
  const auto& particles = scene.particles;
  std::vector<Vector<D>> fixed_position;
  std::vector<std::size_t> fixed_row;
  for (std::size_t i = 0; i < count; ++i)
    if (particles.fixed[i]) {
      fixed_position.push_back(particles.position[i]);
      fixed_row.push_back(i);
    }
  std::vector<ClampPoint<D>> points;
  if (fixed_row.empty()) return points;
  const std::span<const Vector<D>> queries(particles.position.data(), count);
  const NeighborTable near = points_within<D>(queries, fixed_position, 1.6 * scene.spacing);
  for (std::size_t i = 0; i < count; ++i)
    for (int axis = 0; axis < D; ++axis) {
      if (particles.fixed[i] >> axis & 1) continue;
      double nearest = 1e300;
      Vector<D> point = Vector<D>::Zero();
      for (const std::int32_t candidate : near.of(i)) {
        const std::size_t j = fixed_row[candidate];
        if (particles.body[j] != particles.body[i] || !(particles.fixed[j] >> axis & 1)) continue;
        const double distance = (particles.position[j] - particles.position[i]).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        point = 0.5 * (particles.position[j] + particles.position[i]);
      }
      if (nearest < 1e300) points.push_back({point, static_cast<std::uint8_t>(1 << axis), particles.body[i]});
    }
  return points;
}

// In a corner between two faces that hold different axes a particle knows the nearer face alone: the other one is its neighbours' face,
// taken as plane.
template <int D>
void add_corner_points(const InitialParticles<D>& particles, std::size_t count, double spacing, std::vector<ClampPoint<D>>& points) {
  constexpr std::uint8_t all = (1 << D) - 1;
  std::vector<Vector<D>> beside;
  std::vector<std::size_t> row;
  for (std::size_t i = 0; i < count; ++i)
    if (particles.clamp_axes[i]) beside.push_back(particles.position[i]), row.push_back(i);
  const NeighborTable near = points_within<D>(beside, beside, 1.5 * spacing);
  for (std::size_t a = 0; a < row.size(); ++a) {
    const std::size_t i = row[a];
    const std::uint8_t missing = all & ~particles.clamp_axes[i] & ~particles.fixed[i];
    for (int axis = 0; axis < D; ++axis) {
      if (!(missing >> axis & 1)) continue;
      double nearest = 1e300;
      Vector<D> point = Vector<D>::Zero();
      for (const std::int32_t b : near.of(a)) {
        const std::size_t j = row[b];
        if (particles.body[j] != particles.body[i] || !(particles.clamp_axes[j] >> axis & 1)) continue;
        const double away = (particles.position[j] - particles.position[i]).norm(), depth = particles.clamp_offset[j].norm();
        if (away >= nearest || depth > 1.001 * spacing || !(depth > 0)) continue;
        nearest = away;
        const Vector<D> normal = particles.clamp_offset[j] / depth;
        point = particles.position[i] + normal.dot(particles.position[j] + particles.clamp_offset[j] - particles.position[i]) * normal;
      }
      if (nearest < 1e300 && (point - particles.position[i]).norm() < 1.6 * spacing)
        points.push_back({point, static_cast<std::uint8_t>(1 << axis), particles.body[i]});
    }
  }
}

template <int D>
std::vector<ClampPoint<D>> given_points(const SceneDescription<D>& scene, std::size_t count) {
  const auto& particles = scene.particles;
  std::vector<ClampPoint<D>> points;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t axes = particles.clamp_axes[i] & ~particles.fixed[i];
    if (axes) points.push_back({particles.position[i] + particles.clamp_offset[i], axes, particles.body[i]});
  }
  add_corner_points(particles, count, scene.spacing, points);
  return points;
}

// Joins points that coincide, or nearly so, keeping the first.
template <int D>
std::vector<ClampPoint<D>> merged(const std::vector<ClampPoint<D>>& points, double distance) {
  std::vector<Vector<D>> positions;
  for (const ClampPoint<D>& point : points) positions.push_back(point.position);
  const NeighborTable near = points_within<D>(positions, positions, distance);
  std::vector<ClampPoint<D>> kept = points;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::int32_t earlier : near.of(i)) {
      if (static_cast<std::size_t>(earlier) >= i) break;
      if (points[earlier].body != points[i].body || kept[earlier].axes == 0) continue;
      kept[earlier].axes |= kept[i].axes;
      kept[i].axes = 0;
      break;
    }
  std::erase_if(kept, [](const ClampPoint<D>& point) { return point.axes == 0; });
  return kept;
}

}  // namespace

template <int D>
std::vector<ClampPoint<D>> clamp_points(const SceneDescription<D>& scene, std::size_t elastic_count) {
  const bool given = scene.particles.clamp_offset.size() >= elastic_count && scene.particles.clamp_axes.size() >= elastic_count;
  const auto points = given && elastic_count > 0 ? given_points(scene, elastic_count) : estimated_points(scene, elastic_count);
  return merged(points, 0.3 * scene.spacing);
}

template std::vector<ClampPoint<2>> clamp_points<2>(const SceneDescription<2>&, std::size_t);
template std::vector<ClampPoint<3>> clamp_points<3>(const SceneDescription<3>&, std::size_t);

}  // namespace sim
