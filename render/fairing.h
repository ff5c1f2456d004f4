// Taking the jitter of a particle mesh out of a picture: values recovered over patches of triangles, positions faired. No OpenGL.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "render/topology.h"

namespace render {

// Nodal averaging, as finite-element codes show stress: each triangle takes the mean of its corners, then each vertex the mean of its
// triangles, weighted by their areas. The area integral of the values (a third of a triangle's area to each corner) stays exactly what it
// was, and no value leaves the range it had. One pass blurs over about one edge length. A vertex in no triangle keeps its value.
std::vector<float> recovered(std::vector<float> values, const std::vector<Eigen::Vector3f>& positions,
                             const std::vector<std::array<std::int32_t, 3>>& triangles, int passes);

// Whom each vertex follows when it is faired: along the border, its two neighbours there; inside, all.
using Followed = std::vector<std::vector<std::int32_t>>;
Followed followed(std::size_t vertices, const Topology& topology);

// Fairing by lambda | mu (G. Taubin 1995; 0.5, -0.53): short waves die out, long ones and the size stay. A border vertex follows its
// neighbours along the border alone; one with more or fewer than two of them stays where it is.
std::vector<Eigen::Vector3f> faired(std::vector<Eigen::Vector3f> positions, const Followed& others, int rounds);

}  // namespace render
