// The values of a body of particles on a plane through it, as a continuous field. No OpenGL.
#pragma once

#include <array>
#include <vector>

#include "render/frame.h"

namespace render {

inline constexpr float section_reach = 2.5f;  // of the particle's drawn radius: how far a particle's value spreads

// Sums over the particles round each cell's middle of the weight (1 - q²)², q = distance / reach, and of weight times value, the value as
// its place along the colour scale (0 ... 1 within it). Their quotient is the Shepard mean.
struct PlaneField {
  Eigen::Vector3f corner, right, up;  // m, in the plane: the outer corner of the first cell; unit vectors along rows and columns
  float cell = 0;                     // m, the side of a cell
  int width = 0, height = 0;          // cells; 0 where no particle is near
  std::vector<std::array<float, 2>> sums;
};

// Cells are a fifth of the reach wide, larger where that would make more than a few million. Particles without a finite place or value
// are passed over; without a scale all values are 0.
PlaneField plane_field(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& plane);

}  // namespace render
