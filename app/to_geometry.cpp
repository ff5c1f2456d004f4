#include "app/to_geometry.h"

#include <memory>

#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"

namespace app {
namespace {

geometry::Shape mesh_inside(const ShapeSpec& spec, double spacing) {
  try {
    auto mesh = std::make_shared<geometry::TriangleMesh>(geometry::load_mesh(spec.file.string()).mesh);
    geometry::weld_vertices(*mesh);
    if (geometry::signed_volume(*mesh) < 0)
      for (auto& triangle : mesh->triangles) std::swap(triangle[1], triangle[2]);
    for (Eigen::Vector3d& vertex : mesh->vertices) vertex *= spec.unit;
    return geometry::mesh_shape(mesh, spacing);
  } catch (const std::exception& error) {
    refuse(spec.spot, error.what());
  }
}

geometry::Shape base_shape(const ShapeSpec& spec, int dimension, double spacing) {
  switch (spec.type) {
    case ShapeType::sphere:
      return geometry::sphere_shape(spec.center, spec.radius);
    case ShapeType::cylinder:
      return geometry::cylinder_shape(spec.from, spec.to, spec.radius, spec.inner_radius);
    case ShapeType::polygon:
      return geometry::polygon_shape(spec.points, spec.height_from, spec.height_to);
    case ShapeType::mesh:
      return mesh_inside(spec, spacing);
    case ShapeType::shell:
      refuse(spec.spot, "a shell has no inside", "use it as the shape of an elastic body, not in a region or a difference");
    case ShapeType::patient:
      refuse(spec.spot, "type \"patient\" belongs to [patient]", "use another shape");
    case ShapeType::box:
      break;
  }
  (void)dimension;
  return geometry::box_shape(spec.min, spec.max);
}

}  // namespace

geometry::Shape to_geometry(const ShapeSpec& spec, int dimension, double spacing) {
  geometry::Shape shape = base_shape(spec, dimension, spacing);
  for (const ShapeSpec& other : spec.subtract) shape.subtract.push_back(to_geometry(other, dimension, spacing));
  for (const ShapeSpec& other : spec.intersect) shape.intersect.push_back(to_geometry(other, dimension, spacing));
  return shape;
}

int thin_axis(const ShapeSpec& spec, int dimension, double spacing) {
  if (spec.type != ShapeType::box) return -1;
  int thin = -1;
  for (int axis = 0; axis < dimension; ++axis) {
    if (spec.max[axis] - spec.min[axis] >= 1.5 * spacing * (1 - 1e-9)) continue;
    if (thin >= 0) return -1;
    thin = axis;
  }
  return thin;
}

}  // namespace app
