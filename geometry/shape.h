// Solid shapes by signed distance: what scene bodies and regions are made of. Lengths in metres. In 2-D (dimension = 2) z is ignored.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "geometry/signed_distance_grid.h"
#include "geometry/triangle_mesh.h"

namespace geometry {

struct Box {
  Eigen::Vector3d min, max;
};
struct Sphere {  // in 2-D a disc
  Eigen::Vector3d center;
  double radius = 0;
};
struct Cylinder {  // flat ends; in 2-D its section by the plane z = 0 (a strip, or a ring where the axis is z)
  Eigen::Vector3d from, to;
  double radius = 0, inner_radius = 0;
};
struct Polygon {  // simple, either direction round; in 3-D extruded from z = from to z = to
  std::vector<Eigen::Vector2d> points;
  double from = 0, to = 0;
};
struct HalfSpace {  // all points x with (x - point) . normal <= 0
  Eigen::Vector3d point, normal;
};
struct MeshSolid {  // the inside of a closed surface; 3-D only
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const SignedDistanceGrid> distance;
};

// base, grown outward by `grow`, without the shapes in `subtract`, within every shape in `intersect`.
struct Shape {
  std::variant<Box, Sphere, Cylinder, Polygon, HalfSpace, MeshSolid> base = Box{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  std::vector<Shape> subtract, intersect;
  double grow = 0;  // m, >= 0
};

struct BoundingBox {
  Eigen::Vector3d min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d max = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  bool empty() const { return (min.array() > max.array()).any(); }
  void include(const BoundingBox& other);
};

Shape box_shape(const Eigen::Vector3d& min, const Eigen::Vector3d& max);
Shape sphere_shape(const Eigen::Vector3d& center, double radius);
Shape cylinder_shape(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, double inner_radius = 0);
Shape polygon_shape(std::vector<Eigen::Vector2d> points, double from = 0, double to = 0);
// The inside of a closed mesh; distances exact to about (l0/2)^2 x curvature within `band` of the surface (default 5 spacings),
// a lower bound beyond. Throws std::runtime_error where the mesh is not closed.
Shape mesh_shape(std::shared_ptr<const TriangleMesh> mesh, double spacing, double band = 0);

// Throws std::invalid_argument with one clear line where a shape cannot be (min >= max, radius <= 0, inner_radius >= radius, fewer than
// three points, a mesh in 2-D, ...). `name` starts the message.
void check_shape(const Shape& shape, int dimension, const std::string& name);

// Distance to the surface, m, negative inside. Exact for a single primitive (box, sphere, cylinder, polygon and its extrusion, half
// space); with subtract or intersect a bound that never overestimates the distance's size and is exact next to smooth surface parts.
double signed_distance(const Shape& shape, const Eigen::Vector3d& point, int dimension);
bool contains(const Shape& shape, const Eigen::Vector3d& point, int dimension);  // signed_distance <= 0

// Direction in which the distance grows fastest (unit; central differences over `step` m; zero where the distance has no slope).
Eigen::Vector3d distance_gradient(const Shape& shape, const Eigen::Vector3d& point, int dimension, double step);

// Encloses the shape (subtract ignored, intersect used). Infinite where a half space is unbounded. In 2-D z is 0.
BoundingBox bounding_box(const Shape& shape, int dimension);

}  // namespace geometry
