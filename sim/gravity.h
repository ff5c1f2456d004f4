// Gravity: the smallest effect, and the template for new ones (docs/adding_an_effect.md).
#pragma once

#include <span>

#include "sim/particles.h"

namespace sim {

template <int D>
struct Gravity {
  Vector<D> acceleration = Vector<D>::Zero();  // m/s²
};

// Adds rho g / rho = g to the acceleration of every given particle (paper Eq 25: the external force is gravity alone).
template <int D>
void add_gravity(const Gravity<D>& gravity, std::span<Vector<D>> acceleration);

}  // namespace sim
