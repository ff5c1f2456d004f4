// Is there a way past a surface of particles? The widest path between two sides.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace geometry {

struct LeakSearch {
  Eigen::Vector3d min, max;                          // m, region searched
  double step = 0;                                   // m, of the search lattice
  double largest = 0;                                // m, clearances are capped at this
  std::function<bool(const Eigen::Vector3d&)> open;  // a path may pass here
  std::function<int(const Eigen::Vector3d&)> side;   // 1: where paths start, 2: where they end, else 0
};

// The largest clearance to all of `solids` with which a path leads from side 1 to side 2, m; 0 where none does. `narrowest` gets the place
// on that path that is nearest to a solid.
double widest_path(const std::vector<Eigen::Vector3d>& solids, const LeakSearch& search, Eigen::Vector3d* narrowest = nullptr);

}  // namespace geometry
