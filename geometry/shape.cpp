#include "geometry/shape.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Distance to an axis-aligned box centred at the origin: outside the length of what sticks out, inside the least depth.
template <class Vector>
double centred_box_distance(const Vector& point, const Vector& half) {
  const Vector out = point.cwiseAbs() - half;
  return out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0);
}

double distance_to(const Box& box, const Vector3d& point, int dimension) {
  const Vector3d middle = 0.5 * (box.min + box.max), half = 0.5 * (box.max - box.min);
  if (dimension == 2) return centred_box_distance<Vector2d>((point - middle).head<2>(), half.head<2>());
  return centred_box_distance<Vector3d>(point - middle, half);
}

double distance_to(const Sphere& sphere, const Vector3d& point, int dimension) {
  const Vector3d arm = point - sphere.center;
  return (dimension == 2 ? arm.head<2>().norm() : arm.norm()) - sphere.radius;
}

// A tube is a rectangle in (distance from the axis, place along the axis).
double distance_to(const Cylinder& cylinder, const Vector3d& point, int dimension) {
  const Vector3d axis = cylinder.to - cylinder.from;
  const double length = axis.norm();
  const Vector3d arm = point - cylinder.from;
  const double along = arm.dot(axis) / length;
  const double radial = (arm - along * axis / length).norm();
  const double inner = cylinder.inner_radius > 0 ? cylinder.inner_radius : -cylinder.radius;
  const double middle = 0.5 * (cylinder.radius + inner), half = 0.5 * (cylinder.radius - inner);
  if (dimension == 2 && std::abs(axis.z()) > 0.5 * length) return std::abs(radial - middle) - half;  // a ring: no ends in the plane
  return centred_box_distance<Vector2d>({radial - middle, along - 0.5 * length}, {half, 0.5 * length});
}

// Nearest edge for the size, crossings of a ray towards +x for the sign.
double polygon_distance(const std::vector<Vector2d>& corners, const Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vector2d edge = corners[i] - corners[j], arm = point - corners[j];
    const double length2 = edge.squaredNorm();
    const double t = length2 > 0 ? std::clamp(arm.dot(edge) / length2, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (arm - t * edge).squaredNorm());
    if ((corners[i].y() > point.y()) != (corners[j].y() > point.y()) &&
        point.x() < corners[j].x() + edge.x() * (point.y() - corners[j].y()) / edge.y())
      inside = !inside;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

double distance_to(const Polygon& polygon, const Vector3d& point, int dimension) {
  const double flat = polygon_distance(polygon.points, point.head<2>());
  if (dimension == 2) return flat;
  const double middle = 0.5 * (polygon.from + polygon.to), half = 0.5 * std::abs(polygon.to - polygon.from);
  const Vector2d out(flat, std::abs(point.z() - middle) - half);
  return out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0);
}

double distance_to(const HalfSpace& half, const Vector3d& point, int) { return (point - half.point).dot(half.normal.normalized()); }

double distance_to(const MeshSolid& solid, const Vector3d& point, int) { return solid.distance->distance(point); }

BoundingBox box_of(const Box& box) { return {box.min, box.max}; }
BoundingBox box_of(const Sphere& sphere) {
  return {sphere.center - Vector3d::Constant(sphere.radius), sphere.center + Vector3d::Constant(sphere.radius)};
}
BoundingBox box_of(const Cylinder& cylinder) {
  const Vector3d axis = (cylinder.to - cylinder.from).normalized();
  const Vector3d reach = cylinder.radius * (Vector3d::Ones() - axis.cwiseAbs2()).cwiseMax(0.0).cwiseSqrt();
  return {cylinder.from.cwiseMin(cylinder.to) - reach, cylinder.from.cwiseMax(cylinder.to) + reach};
}
BoundingBox box_of(const Polygon& polygon) {
  BoundingBox box;
  for (const Vector2d& p : polygon.points) box.include({{p.x(), p.y(), polygon.from}, {p.x(), p.y(), polygon.from}});
  box.min.z() = std::min(polygon.from, polygon.to);
  box.max.z() = std::max(polygon.from, polygon.to);
  return box;
}
BoundingBox box_of(const HalfSpace&) {
  const double infinity = std::numeric_limits<double>::infinity();
  return {Vector3d::Constant(-infinity), Vector3d::Constant(infinity)};
}
BoundingBox box_of(const MeshSolid& solid) {
  BoundingBox box;
  for (const Vector3d& p : solid.mesh->vertices) box.include({p, p});
  return box;
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) { throw std::invalid_argument(name + ": " + what); }

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

struct ShapeChecker {
  int dimension;
  const std::string& name;
  void operator()(const Box& box) const {
    for (int k = 0; k < dimension; ++k)
      if (!(box.min[k] < box.max[k]))
        refuse(name, std::string("box has min >= max along ") + "xyz"[k] + " (" + text(box.min[k]) + " and " + text(box.max[k]) + ")");
  }
  void operator()(const Sphere& sphere) const {
    if (!(sphere.radius > 0)) refuse(name, "sphere has radius " + text(sphere.radius) + "; it must be positive");
  }
  void operator()(const Cylinder& c) const {
    if (!(c.radius > 0)) refuse(name, "cylinder has radius " + text(c.radius) + "; it must be positive");
    if (!(c.inner_radius >= 0 && c.inner_radius < c.radius))
      refuse(name, "cylinder's inner_radius must be at least 0 and less than its radius");
    const Vector3d axis = c.to - c.from;
    if (!(axis.norm() > 0)) refuse(name, "cylinder has the same point for from and to");
    if (dimension == 2 && axis.z() != 0 && axis.head<2>().norm() > 1e-9 * axis.norm())
      refuse(name, "in 2-D a cylinder's axis must lie in the plane or along z");
  }
  void operator()(const Polygon& polygon) const {
    if (polygon.points.size() < 3) refuse(name, "polygon needs at least three points");
    if (dimension == 3 && !(polygon.from != polygon.to)) refuse(name, "polygon in 3-D needs different heights `from` and `to`");
  }
  void operator()(const HalfSpace& half) const {
    if (!(half.normal.norm() > 0)) refuse(name, "half space has a zero normal");
  }
  void operator()(const MeshSolid& solid) const {
    if (dimension == 2) refuse(name, "a mesh shape needs dimension = 3");
    if (!solid.mesh || solid.mesh->empty()) refuse(name, "mesh shape has no triangles");
    if (!solid.distance) refuse(name, "mesh shape has no distance grid; make it with mesh_shape");
  }
};

// Every edge must be used equally often in both directions; points are welded by exact position first.
bool is_closed(const TriangleMesh& mesh) {
  auto less = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vector3d, std::int32_t, decltype(less)> number(less);
  std::vector<std::int32_t> welded(mesh.vertices.size());
  for (std::size_t i = 0; i < welded.size(); ++i)
    welded[i] = number.try_emplace(mesh.vertices[i], std::int32_t(number.size())).first->second;
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto a = welded[t[k]], b = welded[t[(k + 1) % 3]];
      if (a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[j] == edges[i]) ++j;
    if ((j - i) % 2 != 0) return false;
    i = j;
  }
  return true;
}

}  // namespace

void BoundingBox::include(const BoundingBox& other) {
  min = min.cwiseMin(other.min);
  max = max.cwiseMax(other.max);
}

Shape box_shape(const Vector3d& min, const Vector3d& max) {
  Shape shape;
  shape.base = Box{min, max};
  return shape;
}

Shape sphere_shape(const Vector3d& center, double radius) {
  Shape shape;
  shape.base = Sphere{center, radius};
  return shape;
}

Shape cylinder_shape(const Vector3d& from, const Vector3d& to, double radius, double inner_radius) {
  Shape shape;
  shape.base = Cylinder{from, to, radius, inner_radius};
  return shape;
}

Shape polygon_shape(std::vector<Vector2d> points, double from, double to) {
  Shape shape;
  shape.base = Polygon{std::move(points), from, to};
  return shape;
}

Shape mesh_shape(std::shared_ptr<const TriangleMesh> mesh, double spacing, double band) {
  if (!is_closed(*mesh)) throw std::runtime_error("the mesh is not closed, so it has no inside; repair it, or use a `shell` shape");
  MeshSolid solid;
  solid.distance = std::make_shared<SignedDistanceGrid>(*mesh, 0.5 * spacing, band > 0 ? band : 5 * spacing);
  solid.mesh = std::move(mesh);
  Shape shape;
  shape.base = std::move(solid);
  return shape;
}

void check_shape(const Shape& shape, int dimension, const std::string& name) {
  std::visit(ShapeChecker{dimension, name}, shape.base);
  if (!(shape.grow >= 0)) refuse(name, "shape cannot grow by " + text(shape.grow));
  for (const Shape& part : shape.subtract) check_shape(part, dimension, name + " (subtract)");
  for (const Shape& part : shape.intersect) check_shape(part, dimension, name + " (intersect)");
}

double signed_distance(const Shape& shape, const Vector3d& point, int dimension) {
  double distance = std::visit([&](const auto& base) { return distance_to(base, point, dimension); }, shape.base) - shape.grow;
  for (const Shape& part : shape.subtract) distance = std::max(distance, -signed_distance(part, point, dimension));
  for (const Shape& part : shape.intersect) distance = std::max(distance, signed_distance(part, point, dimension));
  return distance;
}

bool contains(const Shape& shape, const Vector3d& point, int dimension) { return signed_distance(shape, point, dimension) <= 0; }

Vector3d distance_gradient(const Shape& shape, const Vector3d& point, int dimension, double step) {
  Vector3d slope = Vector3d::Zero();
  for (int k = 0; k < dimension; ++k) {
    const Vector3d shift = step * Vector3d::Unit(k);
    slope[k] = signed_distance(shape, point + shift, dimension) - signed_distance(shape, point - shift, dimension);
  }
  const double length = slope.norm();
  if (length < 1e-3 * step) return Vector3d::Zero();
  return slope / length;
}

BoundingBox bounding_box(const Shape& shape, int dimension) {
  BoundingBox box = std::visit([](const auto& base) { return box_of(base); }, shape.base);
  box.min.array() -= shape.grow;
  box.max.array() += shape.grow;
  for (const Shape& part : shape.intersect) {
    const BoundingBox other = bounding_box(part, dimension);
    box.min = box.min.cwiseMax(other.min);
    box.max = box.max.cwiseMin(other.max);
  }
  if (dimension == 2) box.min.z() = box.max.z() = 0;
  return box;
}

}  // namespace geometry
