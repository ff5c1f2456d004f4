// Neighbours of the rest configuration, within bodies: brute-force exact, by cells. Used once, when a scene is built.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/particles.h"

namespace sim {

// Compressed rows: the neighbours of query i are index[begin[i]] ... index[begin[i+1] - 1], in ascending order.
struct NeighborTable {
  std::vector<std::int64_t> begin;
  std::vector<std::int32_t> index;
  std::span<const std::int32_t> of(std::size_t i) const {
    return {index.data() + begin[i], static_cast<std::size_t>(begin[i + 1] - begin[i])};
  }
};

// For every query point all points closer than radius (m, > 0); a point at the query's own position is included.
template <int D>
NeighborTable points_within(std::span<const Vector<D>> queries, std::span<const Vector<D>> points, double radius);

}  // namespace sim
