// The finishing function of SplitMix64 (Steele, Lea & Flood 2014): the standard library's distributions differ between machines.
#pragma once

#include <cstdint>

namespace app {

// A number in [0, 1) from a state; states that differ give independent ones.
inline double uniform_of(std::uint64_t state) {
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace app
