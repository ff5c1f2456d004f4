// Particles as shaded balls (or, in 2-D scenes, flat discs) with true depth.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/shader.h"

namespace render {

struct Sphere {
  Eigen::Vector3f center;  // m
  float radius;            // m
  std::array<std::uint8_t, 4> color;
};

// One sphere a particle, coloured by the layer's style, without those that cannot be seen: beyond the clip plane, or (balls only) deep
// within a dense cloud. `scale` is null where the style is plain.
std::vector<Sphere> visible_spheres(const ParticleSet& set, const Style& style, const ColorScale* scale,
                                    const std::optional<ClipPlane>& clip, ParticleShape shape);

// Rows that are surrounded on all sides: every cell (2.5 radii wide) up to two cells from theirs holds particles, of those `kept` marks.
std::vector<std::uint8_t> buried(const std::vector<Eigen::Vector3f>& positions, const std::vector<std::uint8_t>& kept, float radius);

// Needs a current context, and a framebuffer with colour and normal bound.
class ParticlePainter {
 public:
  ParticlePainter();
  void draw(const std::vector<Sphere>& spheres, ParticleShape shape, const Projection& projection, const std::optional<ClipPlane>& clip);

 private:
  Program program_;
  VertexArray vertices_;
  Buffer corners_, indices_;
  std::size_t indexed_ = 0;  // spheres that the index buffer reaches
};

// The plane as (n, d) in view space: positive is cut away.
Eigen::Vector4f in_view(const ClipPlane& plane, const Projection& projection);

}  // namespace render
