// Where clamps act: points on the faces of fixed regions, at which the displacement is held at 0.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/scene_description.h"

namespace sim {

// The free particles next to a fixed region see, instead of the particles inside it, the points of its face nearest to them: the
// displacement has a kink there, which a smooth fit across the face would smear over half a spacing. With these points the clamp acts at
// the face itself, to the order of the fit.
template <int D>
struct ClampPoint {
  Vector<D> position;     // m
  std::uint8_t axes = 0;  // bit k: u_k = 0 here
  std::int32_t body = 0;
};

// One point for each free elastic particle next to a fixed region: from InitialParticles::clamp_offset where the scene gives it, otherwise
// half-way to the nearest particle (within 1.6 l0, same body) that is fixed along that axis. Points less than 0.3 l0 apart are merged.
template <int D>
std::vector<ClampPoint<D>> clamp_points(const SceneDescription<D>& scene, std::size_t elastic_count);

}  // namespace sim
