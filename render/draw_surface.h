// Surfaces: opaque ones into the lit buffers, translucent ones as glass over the lit picture, from back to front.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/shader.h"
#include "render/skin.h"

namespace render {

// Needs a current context, and a framebuffer with colour and normal bound.
class SurfacePainter {
 public:
  SurfacePainter();
  // Coloured along `scale` where it is given, else plain.
  void draw(const DrawnMesh& mesh, const ColorScale* scale, const Color& plain, const Projection& projection,
            const std::optional<ClipPlane>& clip);

 private:
  Program program_;
  VertexArray vertices_;
  Buffer buffer_, indices_;
};

// Gathers the triangles of all translucent surfaces of a picture, so that they can be sorted together.
struct Glass {
  struct Vertex {
    Eigen::Vector3f position, normal;
    std::array<std::uint8_t, 4> color;
    float clipped;
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  void add(const DrawnMesh& mesh, const Style& style, const ColorScale* scale);
};

// The triangles that may be seen (not wholly beyond one side of the picture, nor wholly cut away), from the farthest middle to the nearest;
// equal ones stay in order.
std::vector<std::uint32_t> back_to_front(const Glass& glass, const Projection& projection, const std::optional<ClipPlane>& clip);

// Needs a current context, and a framebuffer with the lit picture and the depth of the opaque things bound.
class GlassPainter {
 public:
  GlassPainter();
  void draw(const Glass& glass, const Projection& projection, const std::optional<ClipPlane>& clip);

 private:
  Program program_;
  VertexArray vertices_;
  Buffer buffer_, indices_;
};

}  // namespace render
