// Bodies that are one particle thick.
#include <algorithm>
#include <cmath>

#include "app/case_parts.h"
#include "app/to_geometry.h"
#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"
#include "geometry/surface_particles.h"

namespace app {

BodyParticles box_shell(const BodySpec& body, int source, int dimension, double spacing, int thin) {
  const ShapeSpec& box = body.shape;
  BodyParticles result;
  result.source = source, result.name = body.name, result.kind = sim::Kind::shell;
  result.thickness = body.elastic.thickness > 0 ? body.elastic.thickness : box.max[thin] - box.min[thin];
  // In-plane axes such that (first, second, thin) is right-handed; in 2-D `along` turned by +90 degrees is the normal.
  const int first = (thin + 1) % 3, second = (thin + 2) % 3;
  const int along = dimension == 2 ? 1 - thin : first, across = dimension == 2 ? -1 : second;
  const auto cells = [&](int axis) {
    return axis < 0 ? 1 : std::max(1, static_cast<int>(std::lround((box.max[axis] - box.min[axis]) / spacing)));
  };
  const int columns = cells(along), rows = cells(across);
  const double width = (box.max[along] - box.min[along]) / columns, height = across < 0 ? 1 : (box.max[across] - box.min[across]) / rows;
  const geometry::Shape shape = to_geometry(box, dimension, spacing);
  std::vector<std::int32_t> row_of(static_cast<std::size_t>(columns) * rows, -1);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      x[thin] = 0.5 * (box.min[thin] + box.max[thin]);
      x[along] = box.min[along] + (i + 0.5) * width;
      if (across >= 0) x[across] = box.min[across] + (j + 0.5) * height;
      if (!geometry::contains(shape, x, dimension)) continue;
      row_of[static_cast<std::size_t>(j) * columns + i] = static_cast<std::int32_t>(result.size());
      result.position.push_back(x);
      result.volume.push_back(width * height);
    }
  result.normal.assign(result.size(), Eigen::Vector3d::Unit(thin));
  result.fibre.assign(result.size(), Eigen::Vector3d::Unit(across >= 0 && height * rows > width * columns ? across : along));
  const auto at = [&](int i, int j) { return row_of[static_cast<std::size_t>(j) * columns + i]; };
  for (int j = 0; j + (dimension == 3 ? 1 : 0) < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      if (dimension == 2) {  // beam along x: normal +y; along y: normal +x, so the segment runs down
        if (at(i, 0) >= 0 && at(i + 1, 0) >= 0)
          result.elements.push_back(thin == 1 ? std::array<std::int32_t, 3>{at(i, 0), at(i + 1, 0), -1}
                                              : std::array<std::int32_t, 3>{at(i + 1, 0), at(i, 0), -1});
        continue;
      }
      const std::array<std::int32_t, 4> corner{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      if (std::min({corner[0], corner[1], corner[2]}) >= 0) result.elements.push_back({corner[0], corner[1], corner[2]});
      if (std::min({corner[0], corner[2], corner[3]}) >= 0) result.elements.push_back({corner[0], corner[2], corner[3]});
    }
  return result;
}

BodyParticles surface_shell(const BodySpec& body, int source, double spacing) {
  if (body.shape.layers != 1)
    refuse(body.shape.spot, "a shell of several layers is not offered",
           "set layers = 1 (thickness is the material's), or give a solid mesh");
  if (!body.shape.subtract.empty() || !body.shape.intersect.empty())
    refuse(body.shape.spot, "a shell takes no subtract or intersect", "cut the mesh before");
  try {
    geometry::TriangleMesh mesh = geometry::load_mesh(body.shape.file.string()).mesh;
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex *= body.shape.unit;
    geometry::weld_vertices(mesh);
    const geometry::SurfaceParticles particles = geometry::mesh_particles(mesh, spacing);
    BodyParticles result;
    result.source = source, result.name = body.name, result.kind = sim::Kind::shell, result.thickness = body.shape.thickness;
    result.position = particles.position, result.volume = particles.area, result.normal = particles.normal, result.fibre = particles.fibre;
    result.elements = particles.triangles;
    return result;
  } catch (const SceneError&) {
    throw;
  } catch (const std::exception& error) {
    refuse(body.shape.spot, error.what());
  }
}

}  // namespace app
