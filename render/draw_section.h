// The face where the clip plane cuts a body of particles, as a continuous field: each pixel shows the kernel-weighted mean of the
// particles round it.
#pragma once

#include <array>
#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/shader.h"

namespace render {

inline constexpr float section_reach = 2.5f;  // of the particle's drawn radius: how far a particle's value spreads

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
  void spread(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& clip, const Projection& projection);
  void fill_outline(const Outline& outline, const Projection& projection);
  Program splat_, face_, mask_;
  VertexArray vertices_, screen_, fan_;
  Buffer corners_, indices_, fan_corners_;
  Texture sums_, inside_;
  Framebuffer sums_target_, inside_target_;
  int width_ = 0, height_ = 0;                // of the sums
  int inside_width_ = 0, inside_height_ = 0;  // of the mask
  std::size_t indexed_ = 0;
};

}  // namespace render
