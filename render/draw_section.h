// The face where the clip plane cuts a body of particles, as a continuous field: each pixel shows the kernel-weighted mean of the
// particles round it.
#pragma once

#include "render/camera.h"
#include "render/frame.h"
#include "render/shader.h"

namespace render {

inline constexpr float section_reach = 2.5f;  // of the particle's drawn radius: how far a particle's value spreads

// Needs a current context. `target` is the framebuffer with colour, normal and depth that the face is drawn into.
class SectionPainter {
 public:
  SectionPainter();
  void draw(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& clip, const Projection& projection,
            const Framebuffer& target);

 private:
  void spread(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& clip, const Projection& projection);
  Program splat_, face_;
  VertexArray vertices_, screen_;
  Buffer corners_, indices_;
  Texture sums_;
  Framebuffer sums_target_;
  int width_ = 0, height_ = 0;
  std::size_t indexed_ = 0;
};

}  // namespace render
