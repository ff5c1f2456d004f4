#include "sim/shell_frequency.h"

#include <algorithm>
#include <cmath>

namespace sim {

template <int D>
double highest_frequency(const ShellElasticity<D>& source) {
  ShellElasticity<D> shells = source;
  for (ShellBody& body : shells.bodies) body.material.fibre_modulus = 0;
  shells.axial_dashpot = 0;
  const std::size_t rows = shells.size();
  std::vector<Vector<D>> mode(rows), plus(rows), minus(rows), up(rows), down(rows), still(rows, Vector<D>::Zero());
  std::uint64_t seed = 12345;
  for (auto& m : mode)
    for (int k = 0; k < D; ++k)
      m[k] = static_cast<double>((seed = seed * 6364136223846793005ull + 1442695040888963407ull) >> 40) / (1 << 23) - 1;
  double squared = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    double largest = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      for (int k = 0; k < D; ++k)
        if (shells.fixed[i] >> k & 1) mode[i][k] = 0;
      largest = std::max(largest, mode[i].norm());
    }
    if (largest == 0) return 0;
    const double scale = 1e-5 * shells.bodies.front().spacing;
    for (std::size_t i = 0; i < rows; ++i) {
      mode[i] /= largest;
      plus[i] = shells.rest_position[i] + scale * mode[i];
      minus[i] = shells.rest_position[i] - scale * mode[i];
    }
    shell_forces<D>(shells, plus, still, up);
    shell_forces<D>(shells, minus, still, down);
    double product = 0, norm = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const Vector<D> image = (down[i] - up[i]) / (2 * scale * shells.mass[i]);
      product += image.dot(mode[i]) * shells.mass[i];
      norm += mode[i].squaredNorm() * shells.mass[i];
      mode[i] = image;
    }
    squared = std::max(squared, product / norm);
  }
  return std::sqrt(1.05 * squared);
}

template double highest_frequency(const ShellElasticity<2>&);
template double highest_frequency(const ShellElasticity<3>&);

}  // namespace sim
