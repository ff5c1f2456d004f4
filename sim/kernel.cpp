#include "sim/kernel.h"

namespace sim {

Lattice make_lattice(int dimension, double spacing, double radius, bool literal) {
  Lattice lattice{dimension, spacing, radius};
  const int reach = static_cast<int>(std::ceil(radius / spacing));
  double squares = 0;
  for (int k = dimension == 3 ? -reach : 0; k <= (dimension == 3 ? reach : 0); ++k)
    for (int j = -reach; j <= reach; ++j)
      for (int i = -reach; i <= reach; ++i) {
        if (i == 0 && j == 0 && k == 0) continue;
        const double r = spacing * std::sqrt(static_cast<double>(i * i + j * j + k * k));
        const double w = literal ? literal_weight(r, radius, lattice.closest()) : weight(r, radius, lattice.closest());
        lattice.number_density += w;
        squares += r * r * w;
      }
  lattice.laplacian_lambda = squares / lattice.number_density;
  return lattice;
}

}  // namespace sim
