// Evens out particles between surfaces: each is pushed from where others are dense, and kept on its side of the surface.
// (Particle shifting against the gradient of the particles' concentration, Lind et al. 2012, run as a relaxation; Jiang et al. 2015 for
// body-fitted boundaries.)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/point_grid.h"

namespace geometry {

struct Relaxation {
  int dimension = 3;
  double spacing = 0;  // l0, m
  int sweeps = 60;
  PeriodicBox periodic;
  // Moves particle `row` at `position` back to where it may be; called in parallel.
  std::function<void(std::size_t row, Eigen::Vector3d& position)> project;
};

// Moves the rows with mobile != 0; the others stay and push. Deterministic for any number of threads.
void relax_particles(std::vector<Eigen::Vector3d>& position, const std::vector<double>& volume, const std::vector<std::uint8_t>& mobile,
                     const Relaxation& relaxation);

// Wendland C2 kernel of support R: W (1/m^D) and -dW/dr (1/m^(D+1)) at distance r.
double wendland(double r, double support, int dimension);
double wendland_slope(double r, double support, int dimension);

}  // namespace geometry
