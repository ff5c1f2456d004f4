#include "app/loaded_surface.h"

#include <cmath>

namespace app {
namespace {

void add_cell_faces(LoadedSurface& loaded, const BodyParticles& particles, std::size_t i, const geometry::Shape& region, int dimension,
                    double slack) {
  const Eigen::Vector3d& area = particles.surface_area[i];
  for (int k = 0; k < dimension; ++k) {
    if (std::abs(area[k]) <= 1e-6 * area.norm()) continue;
    const Eigen::Vector3d offset = std::copysign(particles.volume[i] / (2 * std::abs(area[k])), area[k]) * Eigen::Vector3d::Unit(k);
    if (geometry::signed_distance(region, particles.position[i] + offset, dimension) > slack) continue;
    loaded.row.push_back(static_cast<std::int64_t>(i));
    loaded.area.push_back(area[k] * Eigen::Vector3d::Unit(k));
    loaded.offset.push_back(offset);
  }
}

}  // namespace

LoadedSurface loaded_surface(const geometry::Shape& body, const BodyParticles& particles, const geometry::Shape& region, int dimension,
                             double spacing) {
  LoadedSurface loaded;
  if (!particles.surface.empty()) {  // the parts of the shares inside the region
    double volume = 0;
    for (double v : particles.volume) volume += v;
    const auto inside = [&](const Eigen::Vector3d& x) { return geometry::signed_distance(region, x, dimension) <= 1e-3 * spacing; };
    for (const geometry::SurfaceShare& share : geometry::surface_shares(body, particles.position, dimension, spacing, volume, inside)) {
      loaded.row.push_back(static_cast<std::int64_t>(share.particle));
      loaded.area.push_back(share.area);
      loaded.offset.push_back(share.offset);
    }
    return loaded;
  }
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (particles.surface_area[i].norm() > 1e-12 * std::pow(spacing, dimension - 1))
      add_cell_faces(loaded, particles, i, region, dimension, 1e-3 * spacing);
  return loaded;
}

}  // namespace app
