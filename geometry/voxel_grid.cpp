#include "geometry/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/check_mesh.h"

namespace geometry {
namespace {

// Sign of the side of (y, z) to the directed edge a -> b in the yz plane, never 0: a point on the line is moved by an infinitesimal
// (epsilon, epsilon^2), the same for every edge, so that every ray crosses a closed surface an even number of times.
bool left_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double y, double z) {
  const double dy = b.y() - a.y(), dz = b.z() - a.z();
  const double side = dy * (z - a.z()) - dz * (y - a.y());
  if (side != 0) return side > 0;
  return dz != 0 ? dz < 0 : dy > 0;
}

// The edge is always evaluated from its lower-numbered vertex, so both of its triangles get the same answer to the last bit.
bool left_of_edge(const TriangleMesh& mesh, std::int32_t a, std::int32_t b, double y, double z) {
  const Eigen::Vector3d &p = mesh.vertices[std::size_t(a)], &q = mesh.vertices[std::size_t(b)];
  return a < b ? left_of(p, q, y, z) : !left_of(q, p, y, z);
}

struct Crossing {
  std::int32_t row;
  double x;
};

void collect_crossings(const TriangleMesh& mesh, const VoxelGrid& grid, std::vector<Crossing>& crossings) {
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                          &c = mesh.vertices[std::size_t(t[2])];
    const double area = (b.y() - a.y()) * (c.z() - a.z()) - (b.z() - a.z()) * (c.y() - a.y());
    if (area == 0) continue;  // seen edge-on: its neighbours carry the crossings
    const Eigen::Vector3d low = (a.cwiseMin(b).cwiseMin(c) - grid.origin) / grid.spacing,
                          high = (a.cwiseMax(b).cwiseMax(c) - grid.origin) / grid.spacing;
    const int j0 = std::max(0, int(std::floor(low.y()))), j1 = std::min(grid.size[1] - 1, int(std::ceil(high.y())));
    const int k0 = std::max(0, int(std::floor(low.z()))), k1 = std::min(grid.size[2] - 1, int(std::ceil(high.z())));
    for (int k = k0; k <= k1; ++k)
      for (int j = j0; j <= j1; ++j) {
        const double y = grid.origin.y() + grid.spacing * j, z = grid.origin.z() + grid.spacing * k;
        const bool side = left_of_edge(mesh, t[0], t[1], y, z);
        if (left_of_edge(mesh, t[1], t[2], y, z) != side || left_of_edge(mesh, t[2], t[0], y, z) != side) continue;
        const double weight_b = ((y - a.y()) * (c.z() - a.z()) - (z - a.z()) * (c.y() - a.y())) / area;
        const double weight_c = ((b.y() - a.y()) * (z - a.z()) - (b.z() - a.z()) * (y - a.y())) / area;
        const double x = a.x() + weight_b * (b.x() - a.x()) + weight_c * (c.x() - a.x());
        crossings.push_back({j + grid.size[1] * k, std::clamp(x, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}))});
      }
  }
}

// Lower envelope of parabolas: out[i] = min over q of (i - q)^2 + in[q] (Felzenszwalb & Huttenlocher 2012, Algorithm 1).
void transform_line(const std::vector<double>& in, int count, std::vector<int>& vertex, std::vector<double>& border,
                    std::vector<double>& out) {
  const double infinity = std::numeric_limits<double>::infinity();
  int last = -1;
  for (int q = 0; q < count; ++q) {
    if (in[std::size_t(q)] == infinity) continue;
    double meet = -infinity;
    while (last >= 0) {
      const int p = vertex[std::size_t(last)];
      meet = ((in[std::size_t(q)] + double(q) * q) - (in[std::size_t(p)] + double(p) * p)) / (2.0 * (q - p));
      if (meet > border[std::size_t(last)]) break;
      --last;
    }
    ++last;
    vertex[std::size_t(last)] = q;
    border[std::size_t(last)] = last == 0 ? -infinity : meet;
  }
  if (last < 0) {
    std::fill(out.begin(), out.begin() + count, infinity);
    return;
  }
  for (int i = 0, part = 0; i < count; ++i) {
    while (part < last && border[std::size_t(part) + 1] < i) ++part;
    const int q = vertex[std::size_t(part)];
    out[std::size_t(i)] = double(i - q) * (i - q) + in[std::size_t(q)];
  }
}

void transform_along(const VoxelGrid& grid, int axis, std::vector<double>& squared) {
  const int count = grid.size[std::size_t(axis)];
  const int u = (axis + 1) % 3, w = (axis + 2) % 3;
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? std::size_t(grid.size[0]) : std::size_t(grid.size[0]) * std::size_t(grid.size[1]);
#pragma omp parallel
  {
    std::vector<double> in(static_cast<std::size_t>(count)), out(in), border(in);
    std::vector<int> vertex(static_cast<std::size_t>(count));
#pragma omp for schedule(static)
    for (int b = 0; b < grid.size[std::size_t(w)]; ++b)
      for (int a = 0; a < grid.size[std::size_t(u)]; ++a) {
        std::array<int, 3> start{};
        start[std::size_t(u)] = a;
        start[std::size_t(w)] = b;
        const std::size_t first = grid.index(start[0], start[1], start[2]);
        for (int i = 0; i < count; ++i) in[std::size_t(i)] = squared[first + stride * std::size_t(i)];
        transform_line(in, count, vertex, border, out);
        for (int i = 0; i < count; ++i) squared[first + stride * std::size_t(i)] = out[std::size_t(i)];
      }
  }
}

}  // namespace

std::array<int, 3> VoxelGrid::coordinates(std::size_t at) const {
  const std::size_t nx = std::size_t(size[0]), ny = std::size_t(size[1]);
  return {int(at % nx), int(at / nx % ny), int(at / (nx * ny))};
}

std::array<int, 3> VoxelGrid::nearest(const Eigen::Vector3d& point) const {
  std::array<int, 3> voxel;
  for (int k = 0; k < 3; ++k)
    voxel[std::size_t(k)] = std::clamp(int(std::lround((point[k] - origin[k]) / spacing)), 0, size[std::size_t(k)] - 1);
  return voxel;
}

VoxelGrid voxelize(const TriangleMesh& mesh, double spacing, int padding) {
  VoxelGrid grid;
  grid.spacing = spacing;
  Eigen::Vector3d low, high;
  bounding_box(mesh, low, high);
  grid.origin = low - Eigen::Vector3d::Constant(padding * spacing);
  for (int k = 0; k < 3; ++k) grid.size[std::size_t(k)] = int(std::ceil((high[k] - low[k]) / spacing)) + 1 + 2 * padding;
  scan_inside(mesh, grid);
  return grid;
}

void scan_inside(const TriangleMesh& mesh, VoxelGrid& grid) {
  grid.inside.assign(std::size_t(grid.size[0]) * std::size_t(grid.size[1]) * std::size_t(grid.size[2]), 0);
  std::vector<Crossing> crossings;
  collect_crossings(mesh, grid, crossings);
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& p, const Crossing& q) { return p.row != q.row ? p.row < q.row : p.x < q.x; });
  for (std::size_t c = 0; c + 1 < crossings.size();) {
    if (crossings[c].row != crossings[c + 1].row) {  // odd: the surface has a hole here
      ++c;
      continue;
    }
    const double from = (crossings[c].x - grid.origin.x()) / grid.spacing, to = (crossings[c + 1].x - grid.origin.x()) / grid.spacing;
    const int first = std::max(0, int(std::ceil(from))), last = std::min(grid.size[0] - 1, int(std::ceil(to)) - 1);
    const std::size_t row = std::size_t(grid.size[0]) * std::size_t(crossings[c].row);
    for (int i = first; i <= last; ++i) grid.inside[row + std::size_t(i)] = 1;
    c += 2;
  }
}

std::vector<double> distance_transform(const VoxelGrid& grid) {
  std::vector<double> squared(grid.inside.size());
  for (std::size_t v = 0; v < squared.size(); ++v) squared[v] = grid.inside[v] ? std::numeric_limits<double>::infinity() : 0;
  for (int axis = 0; axis < 3; ++axis) transform_along(grid, axis, squared);
  for (double& value : squared) value = grid.spacing * std::sqrt(value);
  return squared;
}

std::size_t keep_largest_part(VoxelGrid& grid) {
  std::vector<std::int32_t> part(grid.inside.size(), -1);
  std::vector<std::size_t> sizes, stack;
  const std::array<std::array<int, 3>, 6> steps{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  for (std::size_t seed = 0; seed < part.size(); ++seed) {
    if (!grid.inside[seed] || part[seed] >= 0) continue;
    sizes.push_back(0);
    part[seed] = std::int32_t(sizes.size()) - 1;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      ++sizes.back();
      const auto here = grid.coordinates(at);
      for (const auto& step : steps) {
        const int i = here[0] + step[0], j = here[1] + step[1], k = here[2] + step[2];
        if (i < 0 || j < 0 || k < 0 || i >= grid.size[0] || j >= grid.size[1] || k >= grid.size[2]) continue;
        const std::size_t next = grid.index(i, j, k);
        if (!grid.inside[next] || part[next] >= 0) continue;
        part[next] = part[seed];
        stack.push_back(next);
      }
    }
  }
  if (sizes.empty()) return 0;
  const auto largest = std::int32_t(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::size_t gone = 0;
  for (std::size_t v = 0; v < part.size(); ++v)
    if (part[v] >= 0 && part[v] != largest) {
      grid.inside[v] = 0;
      ++gone;
    }
  return gone;
}

}  // namespace geometry
