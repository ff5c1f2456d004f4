#include "app/loaded_surface.h"

#include <cmath>

#include "geometry/iso_surface.h"

namespace app {
namespace {

// True where the particle's area is that of its cell's faces: the nearest of them is as far as the surface.
bool has_cell_faces(const BodyParticles& particles, std::size_t i, int dimension) {
  const Eigen::Vector3d& area = particles.surface_area[i];
  double nearest = 1e300;
  for (int k = 0; k < dimension; ++k)
    if (std::abs(area[k]) > 1e-6 * area.norm()) nearest = std::min(nearest, particles.volume[i] / (2 * std::abs(area[k])));
  return std::abs(nearest - particles.depth[i]) < 1e-4 * particles.depth[i];
}

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

// The true surface's elements inside the region, gathered on the nearest of the particles `rows`.
void add_true_surface(LoadedSurface& loaded, const geometry::Shape& body, const BodyParticles& particles,
                      const std::vector<std::size_t>& rows, const geometry::Shape& region, int dimension, double spacing) {
  std::vector<Eigen::Vector3d> area(rows.size(), Eigen::Vector3d::Zero()), moment = area;
  std::vector<double> size(rows.size(), 0);
  for (const geometry::SurfaceElement& element : geometry::surface_elements(body, dimension, 0.5 * spacing)) {
    if (geometry::signed_distance(region, element.center, dimension) > 1e-3 * spacing) continue;
    std::size_t nearest = rows.size();
    double best = 1e300;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const double away = (particles.position[rows[r]] - element.center).squaredNorm();
      if (away < best) best = away, nearest = r;
    }
    if (nearest == rows.size()) return;
    area[nearest] += element.area;
    moment[nearest] += element.area.norm() * element.center;
    size[nearest] += element.area.norm();
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!(size[r] > 0)) continue;
    loaded.row.push_back(static_cast<std::int64_t>(rows[r]));
    loaded.area.push_back(area[r]);
    loaded.offset.push_back(moment[r] / size[r] - particles.position[rows[r]]);
  }
}

}  // namespace

LoadedSurface loaded_surface(const geometry::Shape& body, const BodyParticles& particles, const geometry::Shape& region, int dimension,
                             double spacing) {
  LoadedSurface loaded;
  std::vector<std::size_t> curved;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles.surface_area[i].norm() < 1e-12 * std::pow(spacing, dimension - 1)) continue;
    if (has_cell_faces(particles, i, dimension))
      add_cell_faces(loaded, particles, i, region, dimension, 1e-3 * spacing);
    else
      curved.push_back(i);
  }
  if (!curved.empty()) add_true_surface(loaded, body, particles, curved, region, dimension, spacing);
  return loaded;
}

}  // namespace app
