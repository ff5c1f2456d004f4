#include "geometry/wall_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geometry {
namespace {

using Eigen::Vector3d;
using Cell = std::array<int, 3>;

std::vector<Cell> offsets_by_distance(int cells, int dimension) {
  std::vector<Cell> offsets;
  const int deep = dimension == 3 ? cells : 0;
  for (int c = -deep; c <= deep; ++c)
    for (int b = -cells; b <= cells; ++b)
      for (int a = -cells; a <= cells; ++a)
        if (a * a + b * b + c * c <= cells * cells) offsets.push_back({a, b, c});
  const auto length2 = [](const Cell& o) { return o[0] * o[0] + o[1] * o[1] + o[2] * o[2]; };
  std::stable_sort(offsets.begin(), offsets.end(), [&](const Cell& a, const Cell& b) { return length2(a) < length2(b); });
  return offsets;
}

struct Solids {
  const std::vector<const Shape*>& shapes;
  const PlacementLattice& lattice;
  double distance(const Vector3d& at) const {
    const Vector3d point = lattice.periodic.wrap(at);
    double least = std::numeric_limits<double>::infinity();
    for (const Shape* shape : shapes) least = std::min(least, signed_distance(*shape, point, lattice.dimension));
    return least;
  }
  Vector3d gradient(const Vector3d& at, double step) const {
    Vector3d slope = Vector3d::Zero();
    for (int k = 0; k < lattice.dimension; ++k)
      slope[k] = distance(at + step * Vector3d::Unit(k)) - distance(at - step * Vector3d::Unit(k));
    const double length = slope.norm();
    return length > 1e-3 * step ? Vector3d(slope / length) : Vector3d::Zero();
  }
};

int cell_along(const std::vector<double>& edge, double at) {
  const auto above = std::upper_bound(edge.begin(), edge.end(), at);
  return std::clamp(int(above - edge.begin()) - 1, 0, int(edge.size()) - 2);
}

// Arm from `point` to the centre of the nearest wanted cell; false where none is near.
bool arm_to_nearest(const Vector3d& point, const PlacementLattice& lattice, const std::vector<std::uint8_t>& wanted,
                    const std::vector<Cell>& offsets, double reach, Vector3d& arm) {
  Cell home;
  for (int k = 0; k < 3; ++k) home[k] = cell_along(lattice.edge[k], point[k]);
  double best = reach * reach, last_ring = std::numeric_limits<double>::infinity();
  bool found = false;
  for (const Cell& offset : offsets) {
    const double ring = std::sqrt(offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]);
    if (ring > last_ring) break;
    Cell cell;
    if (!lattice.neighbor(home, offset, cell) || !wanted[lattice.index(cell[0], cell[1], cell[2])]) continue;
    const Vector3d there = lattice.periodic.nearest_image(lattice.center(cell) - point);
    if (there.squaredNorm() >= best * (1 - 1e-9)) continue;
    best = there.squaredNorm();
    arm = there;
    if (!found) last_ring = ring + 1.5;  // uneven cells and relaxed points: the nearest may be a ring further out
    found = true;
  }
  return found;
}

// Where the line from `point` leaves the solids, going back from the open place at `along` m. Sphere tracing: outside, the distance to a
// union is exact, so no step oversteps.
double trace_back(const Vector3d& point, const Vector3d& direction, double along, const Solids& solids, double spacing) {
  for (int i = 0; i < 60 && along > 0; ++i) {
    const double step = solids.distance(point + along * direction);
    if (step < 1e-7 * spacing) break;
    along -= step;
  }
  return std::max(0.0, along);
}

SurfaceFoot foot_towards(const Vector3d& point, const Vector3d& arm, const Solids& solids, double spacing) {
  SurfaceFoot foot{0, arm.normalized()};
  foot.depth = trace_back(point, foot.normal, arm.norm(), solids, spacing);
  // Turn the arm square to the surface where it comes out, until it stays; it never gets longer.
  const double hover = 0.3 * spacing, difference = 0.02 * spacing;
  for (int i = 0; i < 8; ++i) {
    const Vector3d normal = solids.gradient(point + (foot.depth + hover) * foot.normal, difference);
    if (normal.isZero() || solids.distance(point + (foot.depth + hover) * normal) <= 0) break;
    const double depth = trace_back(point, normal, foot.depth + hover, solids, spacing);
    if (depth > foot.depth + 1e-6 * spacing) break;
    const bool settled = (normal - foot.normal).norm() < 1e-5;
    foot = {depth, normal};
    if (settled) break;
  }
  return foot;
}

}  // namespace

std::vector<std::uint8_t> reachable_cells(const PlacementLattice& lattice, const std::vector<std::uint8_t>& solid,
                                          const std::vector<std::uint8_t>& fluid) {
  std::vector<std::uint8_t> reachable(lattice.size(), 0);
  std::vector<std::size_t> front;
  for (std::size_t c = 0; c < reachable.size(); ++c)
    if (fluid[c]) {
      reachable[c] = 1;
      front.push_back(c);
    }
  if (front.empty()) {
    for (std::size_t c = 0; c < reachable.size(); ++c) reachable[c] = !solid[c];
    return reachable;
  }
  while (!front.empty()) {
    const Cell cell = lattice.cell(front.back());
    front.pop_back();
    for (int k = 0; k < lattice.dimension; ++k)
      for (int step : {-1, 1}) {
        Cell offset{}, next;
        offset[k] = step;
        if (!lattice.neighbor(cell, offset, next)) continue;
        const std::size_t n = lattice.index(next[0], next[1], next[2]);
        if (reachable[n] || solid[n]) continue;
        reachable[n] = 1;
        front.push_back(n);
      }
  }
  return reachable;
}

std::vector<SurfaceFoot> exposed_surface(const std::vector<Vector3d>& points, const std::vector<const Shape*>& solids, const Shape& own,
                                         const PlacementLattice& lattice, const std::vector<std::uint8_t>& fluid,
                                         const std::vector<std::uint8_t>& reachable, double reach, double spacing) {
  const std::vector<Cell> offsets = offsets_by_distance(int(std::ceil(reach / spacing)) + 1, lattice.dimension);
  const Solids all{solids, lattice};
  std::vector<SurfaceFoot> feet(points.size());
#pragma omp parallel for schedule(dynamic, 256)
  for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(points.size()); ++i) {
    Vector3d arm;
    if (arm_to_nearest(points[i], lattice, fluid, offsets, reach, arm) ||
        arm_to_nearest(points[i], lattice, reachable, offsets, reach, arm)) {
      feet[i] = foot_towards(points[i], arm, all, spacing);
      continue;
    }
    feet[i].depth = std::max(0.0, -signed_distance(own, points[i], lattice.dimension));
    feet[i].normal = distance_gradient(own, points[i], lattice.dimension, 0.02 * spacing);
    if (feet[i].normal.isZero()) feet[i].normal = Vector3d::UnitX();  // on a medial surface every way out is as good
  }
  return feet;
}

}  // namespace geometry
