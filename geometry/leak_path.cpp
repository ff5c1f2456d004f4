#include "geometry/leak_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>

#include "geometry/point_grid.h"

namespace geometry {

using Eigen::Vector3d;

double widest_path(const std::vector<Vector3d>& solids, const LeakSearch& search, Vector3d* narrowest) {
  std::array<int, 3> count;
  for (int k = 0; k < 3; ++k) count[k] = int((search.max[k] - search.min[k]) / search.step) + 1;
  const auto place = [&](int i, int j, int k) { return Vector3d(search.min + search.step * Vector3d(i, j, k)); };
  const auto index = [&](int i, int j, int k) { return std::size_t(i) + std::size_t(count[0]) * (j + std::size_t(count[1]) * k); };
  const auto coordinates = [&](std::size_t n) {
    return std::array<int, 3>{int(n % count[0]), int(n / count[0] % count[1]), int(n / count[0] / count[1])};
  };
  const std::size_t total = static_cast<std::size_t>(count[0]) * count[1] * count[2];
  std::vector<float> clearance(total, 0), reached(total, 0);
  std::vector<std::size_t> pinch(total, 0);  // the narrowest node so far on the path that came here
  std::vector<std::uint8_t> side(total, 0);
  const PointGrid grid(solids, search.largest);
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const Vector3d point = place(i, j, k);
        if (!search.open(point)) continue;
        double nearest2 = search.largest * search.largest;
        grid.for_each_near(point, [&](std::size_t, const Vector3d&, double d2) { nearest2 = std::min(nearest2, d2); });
        clearance[index(i, j, k)] = float(std::sqrt(nearest2));
        side[index(i, j, k)] = std::uint8_t(search.side(point));
      }
  // Dijkstra on the narrowest place of a path.
  std::priority_queue<std::pair<float, std::size_t>> front;
  for (std::size_t n = 0; n < total; ++n)
    if (side[n] == 1 && clearance[n] > 0) {
      reached[n] = clearance[n];
      pinch[n] = n;
      front.emplace(reached[n], n);
    }
  while (!front.empty()) {
    const auto [width, node] = front.top();
    front.pop();
    if (width < reached[node]) continue;
    const std::array<int, 3> at = coordinates(node);
    if (side[node] == 2) {
      const std::array<int, 3> tight = coordinates(pinch[node]);
      if (narrowest) *narrowest = place(tight[0], tight[1], tight[2]);
      return width;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int way : {-1, 1}) {
        std::array<int, 3> next = at;
        next[axis] += way;
        if (next[axis] < 0 || next[axis] >= count[axis]) continue;
        const std::size_t n = index(next[0], next[1], next[2]);
        const float through = std::min(width, clearance[n]);
        if (through <= reached[n]) continue;
        reached[n] = through;
        pinch[n] = clearance[n] < width ? n : pinch[node];
        front.emplace(through, n);
      }
  }
  return 0;
}

}  // namespace geometry
