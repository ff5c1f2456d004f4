// Leaflets that are stretched beyond what their law is for.
#pragma once

#include <optional>
#include <string>

#include "sim/scene.h"

namespace sim {

// The shell body with the largest strain, where that is more than 0.75 over a hundredth of its particles: tissue tears
// before, and an isotropic rubber may have no equilibrium under such a load.
struct Overload {
  double strain = 0;       // 99th percentile of the mid-surface's larger principal stretch minus one
  std::int32_t shell = 0;  // of ShellElasticity::bodies
  Eigen::Vector3d place;   // m, of the particle that has it
  double time = 0;         // s
};
template <int D>
std::optional<Overload> overload(const Scene<D>& scene, const State<D>& state);

// One line: body, strain, place, time, the load that the law bears, and the mend.
template <int D>
std::string overload_message(const Scene<D>& scene, const Overload& overload);

}  // namespace sim
