// Shapes of a scene file as signed-distance shapes.
#pragma once

#include "app/scene_file.h"
#include "geometry/shape.h"

namespace app {

// Reads meshes from their files. Throws SceneError with the shape's place in the scene.
geometry::Shape to_geometry(const ShapeSpec& spec, int dimension, double spacing);

// Extents of an elastic box thinner than 1.5 spacings along exactly one axis (that axis, else -1): such a body is a shell.
int thin_axis(const ShapeSpec& spec, int dimension, double spacing);

}  // namespace app
