#include "sim/ordering.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sim {
namespace {

// Values of rows first … in the given order.
template <class T>
void reorder(std::vector<T>& values, std::size_t first, const std::vector<std::int32_t>& order) {
  const std::vector<T> old(values.begin() + static_cast<std::ptrdiff_t>(first), values.end());
  for (std::size_t k = 0; k < order.size(); ++k) values[first + k] = old[static_cast<std::size_t>(order[k])];
}

}  // namespace

template <int D>
void sort_by_cells(const Scene<D>& scene, State<D>& state) {
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid), n = state.size() - first;
  const double edge = scene.lattice.radius;
  std::vector<std::array<std::int64_t, D + 1>> key(n);  // slowest axis first, then the id
  for (std::size_t k = 0; k < n; ++k) {
    for (int axis = 0; axis < D; ++axis)
      key[k][D - 1 - axis] = static_cast<std::int64_t>(std::floor(std::clamp(state.position[first + k][axis] / edge, -1e15, 1e15)));
    key[k][D] = state.id[first + k];
  }
  std::vector<std::int32_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return key[a] < key[b]; });
  reorder(state.id, first, order);
  reorder(state.kind, first, order);
  reorder(state.body, first, order);
  reorder(state.port, first, order);
  reorder(state.position, first, order);
  reorder(state.velocity, first, order);
  reorder(state.pressure, first, order);
}

template void sort_by_cells(const Scene<2>&, State<2>&);
template void sort_by_cells(const Scene<3>&, State<3>&);

}  // namespace sim
