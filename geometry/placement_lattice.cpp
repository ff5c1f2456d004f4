#include "geometry/placement_lattice.h"

#include <algorithm>
#include <cmath>

namespace geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

bool along_axis(const Vector3d& direction, int axis) { return std::abs(direction[axis]) > (1 - 1e-12) * direction.norm(); }

struct RectilinearTest {
  int dimension;
  bool operator()(const Box&) const { return true; }
  bool operator()(const Sphere&) const { return false; }
  bool operator()(const Cylinder& c) const {
    const Vector3d axis = c.to - c.from;
    return dimension == 2 && axis.z() == 0 && (axis.x() == 0 || axis.y() == 0);
  }
  bool operator()(const Polygon& polygon) const {
    for (std::size_t i = 0, j = polygon.points.size() - 1; i < polygon.points.size(); j = i++)
      if (polygon.points[i].x() != polygon.points[j].x() && polygon.points[i].y() != polygon.points[j].y()) return false;
    return true;
  }
  bool operator()(const HalfSpace& half) const {
    return along_axis(half.normal, 0) || along_axis(half.normal, 1) || (dimension == 3 && along_axis(half.normal, 2));
  }
  bool operator()(const MeshSolid&) const { return false; }
};

struct PlaneCollector {
  int dimension, axis;
  double grow;
  std::vector<double>& planes;
  void operator()(const Box& box) const {
    planes.push_back(box.min[axis] - grow);
    planes.push_back(box.max[axis] + grow);
  }
  void operator()(const Sphere&) const {}
  void operator()(const Cylinder& c) const {
    const Vector3d line = c.to - c.from;
    if (along_axis(line, axis)) {
      planes.push_back(std::min(c.from[axis], c.to[axis]) - grow);
      planes.push_back(std::max(c.from[axis], c.to[axis]) + grow);
    } else if (dimension == 2 && along_axis(line, 1 - axis)) {
      for (double r : {c.radius + grow, c.inner_radius})
        if (r > 0) planes.insert(planes.end(), {c.from[axis] - r, c.from[axis] + r});
    }
  }
  void operator()(const Polygon& polygon) const {
    if (axis == 2) {
      planes.insert(planes.end(), {std::min(polygon.from, polygon.to) - grow, std::max(polygon.from, polygon.to) + grow});
      return;
    }
    for (std::size_t i = 0, j = polygon.points.size() - 1; i < polygon.points.size(); j = i++) {
      const Vector2d &p = polygon.points[i], &q = polygon.points[j];
      if (p[axis] == q[axis]) planes.push_back(p[axis]);
    }
  }
  void operator()(const HalfSpace& half) const {
    if (along_axis(half.normal, axis)) planes.push_back(half.point[axis]);
  }
  void operator()(const MeshSolid&) const {}
};

void collect_planes(const Shape& shape, int dimension, int axis, std::vector<double>& planes) {
  std::visit(PlaneCollector{dimension, axis, shape.grow, planes}, shape.base);
  for (const Shape& part : shape.subtract) collect_planes(part, dimension, axis, planes);
  for (const Shape& part : shape.intersect) collect_planes(part, dimension, axis, planes);
}

// Cells between consecutive planes; `low`, `high` bound what must be covered beyond the outermost planes.
std::vector<double> cell_edges(const std::vector<double>& planes, double low, double high, double spacing) {
  std::vector<double> edges;
  const double slack = 1e-6 * spacing;
  const int before = int(std::ceil((planes.front() - low - slack) / spacing));
  for (int i = std::max(0, before); i > 0; --i) edges.push_back(planes.front() - i * spacing);
  for (std::size_t p = 0; p + 1 < planes.size(); ++p) {
    const double length = planes[p + 1] - planes[p];
    const int cells = std::max(1, int(std::lround(length / spacing)));
    for (int i = 0; i < cells; ++i) edges.push_back(planes[p] + length * i / cells);
  }
  edges.push_back(planes.back());
  const int after = int(std::ceil((high - planes.back() - slack) / spacing));
  for (int i = 1; i <= after; ++i) edges.push_back(planes.back() + i * spacing);
  return edges;
}

}  // namespace

std::array<int, 3> PlacementLattice::cell(std::size_t index) const {
  const std::size_t row = index / count(0);
  return {int(index % count(0)), int(row % count(1)), int(row / count(1))};
}

Vector3d PlacementLattice::center(const std::array<int, 3>& cell) const {
  Vector3d point;
  for (int k = 0; k < 3; ++k) point[k] = 0.5 * (edge[k][cell[k]] + edge[k][cell[k] + 1]);
  return point;
}

Vector3d PlacementLattice::pitch(const std::array<int, 3>& cell) const {
  Vector3d size;
  for (int k = 0; k < 3; ++k) size[k] = edge[k][cell[k] + 1] - edge[k][cell[k]];
  return size;
}

double PlacementLattice::smallest_pitch(const std::array<int, 3>& cell) const {
  const Vector3d size = pitch(cell);
  return dimension == 3 ? size.minCoeff() : std::min(size.x(), size.y());
}

bool PlacementLattice::neighbor(const std::array<int, 3>& cell, const std::array<int, 3>& offset, std::array<int, 3>& result) const {
  for (int k = 0; k < 3; ++k) {
    result[k] = cell[k] + offset[k];
    if (periodic.active[k]) result[k] = (result[k] % count(k) + count(k)) % count(k);
    if (result[k] < 0 || result[k] >= count(k)) return false;
  }
  return true;
}

bool is_rectilinear(const Shape& shape, int dimension) {
  if (shape.grow > 0 || !std::visit(RectilinearTest{dimension}, shape.base)) return false;
  const auto straight = [&](const Shape& part) { return is_rectilinear(part, dimension); };
  return std::all_of(shape.subtract.begin(), shape.subtract.end(), straight) &&
         std::all_of(shape.intersect.begin(), shape.intersect.end(), straight);
}

std::vector<double> face_planes(const Shape& shape, int dimension, int axis) {
  std::vector<double> planes;
  collect_planes(shape, dimension, axis, planes);
  const BoundingBox box = bounding_box(shape, dimension);
  const double slack = 1e-9 * (box.max[axis] - box.min[axis]);
  std::erase_if(planes, [&](double p) { return !(p >= box.min[axis] - slack && p <= box.max[axis] + slack); });
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end(), [&](double a, double b) { return b - a <= slack; }), planes.end());
  return planes;
}

PlacementLattice make_placement_lattice(const std::vector<PlacedBody>& bodies, const std::vector<int>& members,
                                        const PlacementOptions& options) {
  PlacementLattice lattice;
  lattice.dimension = options.dimension;
  const double spacing = options.spacing;
  BoundingBox box;
  for (int m : members) box.include(bounding_box(bodies[m].shape, options.dimension));
  lattice.bodies = box;
  lattice.edge[2] = {-0.5, 0.5};
  // Curved surfaces are relaxed against particles of the space outside: room for them.
  const bool straight =
      std::all_of(members.begin(), members.end(), [&](int m) { return is_rectilinear(bodies[m].shape, options.dimension); });
  const double room = straight ? 0 : 7 * spacing;
  for (int axis = 0; axis < options.dimension; ++axis) {
    std::vector<double> planes;
    const auto accept = [&](double plane, double own_partner) {
      for (double p : planes)
        if (std::abs(p - plane) < 1e-6 * spacing || (std::abs(p - plane) < 0.5 * spacing && p != own_partner)) return;
      planes.push_back(plane);
    };
    if (options.periodic[axis]) {
      planes = {options.domain_min[axis], options.domain_max[axis]};
      lattice.periodic.active[axis] = true;
      lattice.periodic.min[axis] = options.domain_min[axis];
      lattice.periodic.length[axis] = options.domain_max[axis] - options.domain_min[axis];
    }
    for (int m : members) {
      const std::vector<double> faces = face_planes(bodies[m].shape, options.dimension, axis);
      // The outermost pair of a body first, kept even where it is thin: a body's extent decides how stiff or how wide it is.
      if (faces.empty()) continue;
      accept(faces.front(), std::numeric_limits<double>::quiet_NaN());
      accept(faces.back(), faces.front());
      for (double face : faces) accept(face, std::numeric_limits<double>::quiet_NaN());
    }
    if (options.periodic[axis])
      std::erase_if(planes, [&](double p) { return p < options.domain_min[axis] || p > options.domain_max[axis]; });
    std::sort(planes.begin(), planes.end());
    if (planes.empty()) {
      const BoundingBox first = bounding_box(bodies[members.front()].shape, options.dimension);
      planes.push_back(0.5 * (first.min[axis] + first.max[axis]));
    }
    const bool wraps = options.periodic[axis];
    lattice.edge[axis] =
        cell_edges(planes, wraps ? planes.front() : box.min[axis] - room, wraps ? planes.back() : box.max[axis] + room, spacing);
  }
  return lattice;
}

double rectilinear_volume(const Shape& shape, int dimension) {
  PlacementLattice cells;
  cells.dimension = dimension;
  cells.edge[2] = {-0.5, 0.5};
  for (int axis = 0; axis < dimension; ++axis) cells.edge[axis] = face_planes(shape, dimension, axis);
  double volume = 0;
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (contains(shape, cells.center(cells.cell(c)), dimension)) volume += cells.volume(cells.cell(c));
  return volume;
}

double cut_cell_volume(const Shape& shape, const PlacementLattice& lattice) {
  const int parts = lattice.dimension == 3 ? 5 : 16, deep = lattice.dimension == 3 ? parts : 1;
  std::vector<double> row(std::size_t(lattice.count(1)) * lattice.count(2), 0.0);
#pragma omp parallel for schedule(dynamic, 16)
  for (std::ptrdiff_t r = 0; r < std::ptrdiff_t(row.size()); ++r)
    for (int i = 0; i < lattice.count(0); ++i) {
      const std::array<int, 3> cell = lattice.cell(std::size_t(r) * lattice.count(0) + i);
      const Vector3d center = lattice.center(cell), pitch = lattice.pitch(cell);
      const double reach = 0.5 * (lattice.dimension == 3 ? pitch.norm() : pitch.head<2>().norm());
      const double distance = signed_distance(shape, center, lattice.dimension);
      if (distance >= reach) continue;
      if (distance <= -reach) {
        row[r] += pitch.prod();
        continue;
      }
      double inside = 0;
      for (int c = 0; c < deep; ++c)
        for (int b = 0; b < parts; ++b)
          for (int a = 0; a < parts; ++a) {
            const Vector3d part((a + 0.5) / parts - 0.5, (b + 0.5) / parts - 0.5, deep == 1 ? 0.0 : (c + 0.5) / parts - 0.5);
            // A part's own cut is smoothed over its width: exact for a plane square to an axis.
            const double d = signed_distance(shape, center + part.cwiseProduct(pitch), lattice.dimension) * parts / pitch.x();
            inside += std::clamp(0.5 - d, 0.0, 1.0);
          }
      row[r] += pitch.prod() * inside / (parts * parts * deep);
    }
  double volume = 0;
  for (double v : row) volume += v;
  return volume;
}

}  // namespace geometry
