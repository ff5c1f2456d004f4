#include "sim/gravity.h"

namespace sim {

template <int D>
void add_gravity(const Gravity<D>& gravity, std::span<Vector<D>> acceleration) {
  for (auto& a : acceleration) a += gravity.acceleration;
}

template void add_gravity(const Gravity<2>&, std::span<Vector<2>>);
template void add_gravity(const Gravity<3>&, std::span<Vector<3>>);

}  // namespace sim
