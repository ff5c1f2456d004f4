// The face where the clip plane cuts a body of particles, as a continuous field: each pixel shows the kernel-weighted mean of the
// particles round it.
#pragma once

#include <array>
#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/plane_field.h"
#include "render/shader.h"

namespace render {

using Outline = std::vector<std::array<Eigen::Vector3f, 2>>;

// Needs a current context. `target` is the framebuffer with colour, normal and depth that the face is drawn into.
class SectionPainter {
 public:
  SectionPainter();
  // `outline`: segments of closed curves in the plane that bound the body (the vessel's wall), so that the face ends there and not at the
  // outermost particles; empty = unbounded.
  void draw(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& clip, const Outline& outline,
            const Projection& projection, const Framebuffer& target);

 private:
  void fill_outline(const Outline& outline, const Projection& projection);
  Program face_, mask_;
  VertexArray screen_, fan_;
  Buffer fan_corners_;
  Texture inside_;
  Framebuffer inside_target_;
  int inside_width_ = 0, inside_height_ = 0;  // of the mask
};

}  // namespace render
