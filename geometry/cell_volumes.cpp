#include "geometry/cell_volumes.h"

#include <algorithm>
#include <cmath>

namespace geometry {
namespace {

using Eigen::Vector3d;

// One sample's volume, shared between the two nearest particles.
struct Sample {
  std::size_t first = 0, second = 0;
  double to_first = 0, to_second = 0;                                      // share of a sample's volume
  Vector3d from_first = Vector3d::Zero(), from_second = Vector3d::Zero();  // the sample, seen from them, m
};

// A sample is a cube: of a plane face within half its side, a part lies on either side.
Sample share_sample(const Shape& shape, const PointGrid& particles, const std::vector<double>& depth, const Vector3d& place, int dimension,
                    double spacing, double side) {
  Sample sample;
  double nearest = 1e300, next = 1e300;
  Vector3d to_first = Vector3d::Zero(), to_second = Vector3d::Zero();
  particles.for_each_near(place, [&](std::size_t i, const Vector3d& arm, double d2) {
    if (d2 < nearest) {
      next = nearest, sample.second = sample.first, to_second = to_first;
      nearest = d2, sample.first = i, to_first = arm;
    } else if (d2 < next) {
      next = d2, sample.second = i, to_second = arm;
    }
  });
  if (nearest == 1e300) return sample;
  double inside = 1;
  if (depth[sample.first] < 1.5 * spacing) inside = std::clamp(0.5 - signed_distance(shape, place, dimension) / side, 0.0, 1.0);
  double own = 1;
  if (next < 1e300) own = std::min(1.0, 0.5 + (next - nearest) / (2 * (to_second - to_first).norm()) / side);
  sample.from_first = -to_first;
  sample.from_second = -to_second;
  sample.to_first = inside * own;
  sample.to_second = inside * (1 - own);
  return sample;
}

}  // namespace

Cells cell_volumes(const Shape& shape, const std::vector<Vector3d>& position, const std::vector<double>& depth, int dimension,
                   double spacing, const PeriodicBox& box) {
  Cells cells{std::vector<double>(position.size(), 0), std::vector<Vector3d>(position.size(), Vector3d::Zero())};
  BoundingBox bounds = bounding_box(shape, dimension);
  const double wanted = (dimension == 2 ? 0.125 : 0.25) * spacing;
  std::array<std::ptrdiff_t, 3> count{1, 1, 1};
  Vector3d step = Vector3d::Zero();
  for (int k = 0; k < dimension; ++k) {
    if (box.active[k]) bounds.min[k] = box.min[k], bounds.max[k] = box.min[k] + box.length[k];
    const double extent = bounds.max[k] - bounds.min[k];
    count[k] = std::max<std::ptrdiff_t>(1, std::lround(extent / wanted));
    step[k] = extent / static_cast<double>(count[k]);
  }
  double sample_volume = 1;
  for (int k = 0; k < dimension; ++k) sample_volume *= step[k];
  const double side = std::pow(sample_volume, 1.0 / dimension);
  const PointGrid particles(position, 1.5 * spacing, box);
  std::vector<Sample> layer(static_cast<std::size_t>(count[0] * count[1]));
  for (std::ptrdiff_t z = 0; z < count[2]; ++z) {
#pragma omp parallel for schedule(dynamic, 256)
    for (std::ptrdiff_t s = 0; s < count[0] * count[1]; ++s) {
      const std::ptrdiff_t x = s % count[0], y = s / count[0];
      Vector3d place = Vector3d::Zero();
      const std::array<std::ptrdiff_t, 3> index{x, y, z};
      for (int k = 0; k < dimension; ++k) place[k] = bounds.min[k] + (static_cast<double>(index[k]) + 0.5) * step[k];
      layer[s] = share_sample(shape, particles, depth, place, dimension, spacing, side);
    }
    for (const Sample& sample : layer) {  // in a fixed order, whatever the number of threads
      cells.volume[sample.first] += sample.to_first * sample_volume;
      cells.volume[sample.second] += sample.to_second * sample_volume;
      cells.centroid[sample.first] += sample.to_first * sample_volume * sample.from_first;
      cells.centroid[sample.second] += sample.to_second * sample_volume * sample.from_second;
    }
  }
  for (std::size_t i = 0; i < position.size(); ++i)
    if (cells.volume[i] > 0) cells.centroid[i] /= cells.volume[i];
  return cells;
}

}  // namespace geometry
