#include "geometry/centreline.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>

#include "geometry/check_mesh.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t nowhere = std::size_t(-1);

struct Tree {
  std::vector<double> cost;         // from the sources
  std::vector<std::size_t> before;  // the voxel the path comes from
};

// Shortest paths over 26 neighbours; `weight` multiplies a step's length by the mean over its two voxels.
Tree shortest_paths(const LumenField& field, const std::vector<std::size_t>& sources, const std::function<double(std::size_t)>& weight) {
  const VoxelGrid& grid = field.grid;
  Tree tree{std::vector<double>(grid.inside.size(), infinity), std::vector<std::size_t>(grid.inside.size(), nowhere)};
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t source : sources) {
    tree.cost[source] = 0;
    open.push({0, source});
  }
  while (!open.empty()) {
    const auto [cost, at] = open.top();
    open.pop();
    if (cost > tree.cost[at]) continue;
    const auto here = grid.coordinates(at);
    for (int n = 0; n < 27; ++n) {
      const int di = n % 3 - 1, dj = n / 3 % 3 - 1, dk = n / 9 - 1;
      const int i = here[0] + di, j = here[1] + dj, k = here[2] + dk;
      if (n == 13 || i < 0 || j < 0 || k < 0 || i >= grid.size[0] || j >= grid.size[1] || k >= grid.size[2]) continue;
      const std::size_t next = grid.index(i, j, k);
      if (!grid.inside[next]) continue;
      const double length = grid.spacing * std::sqrt(double(di * di + dj * dj + dk * dk));
      const double total = cost + length * (weight(at) + weight(next)) / 2;
      if (total >= tree.cost[next]) continue;
      tree.cost[next] = total;
      tree.before[next] = at;
      open.push({total, next});
    }
  }
  return tree;
}

std::size_t inside_voxel_near(const LumenField& field, const Vector3d& point) {
  const auto start = field.grid.nearest(point);
  std::size_t best = nowhere;
  double nearest = infinity;
  for (int reach = 0; reach <= 12 && best == nowhere; reach += 3)
    for (int k = std::max(0, start[2] - reach); k <= std::min(field.grid.size[2] - 1, start[2] + reach); ++k)
      for (int j = std::max(0, start[1] - reach); j <= std::min(field.grid.size[1] - 1, start[1] + reach); ++j)
        for (int i = std::max(0, start[0] - reach); i <= std::min(field.grid.size[0] - 1, start[0] + reach); ++i) {
          const std::size_t at = field.grid.index(i, j, k);
          const double distance = (field.grid.center(i, j, k) - point).norm();
          if (field.grid.inside[at] && distance < nearest) {
            nearest = distance;
            best = at;
          }
        }
  return best;
}

Vector3d center_of(const VoxelGrid& grid, std::size_t at) {
  const auto c = grid.coordinates(at);
  return grid.center(c[0], c[1], c[2]);
}

std::vector<std::size_t> path_to(const Tree& tree, std::size_t end) {
  std::vector<std::size_t> path;
  for (std::size_t at = end; at != nowhere; at = tree.before[at]) path.push_back(at);
  std::reverse(path.begin(), path.end());
  return path;
}

std::size_t farthest(const Tree& tree) {
  std::size_t best = nowhere;
  for (std::size_t v = 0; v < tree.cost.size(); ++v)
    if (tree.cost[v] < infinity && (best == nowhere || tree.cost[v] > tree.cost[best])) best = v;
  return best;
}

// Each pass moves a point to the middle of its neighbours and itself; the ends stay.
void smooth(std::vector<Vector3d>& points, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<Vector3d> next = points;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) next[i] = (points[i - 1] + 2 * points[i] + points[i + 1]) / 4;
    points = std::move(next);
  }
}

}  // namespace

double LumenField::largest_bore() const { return distance.empty() ? 0 : 2 * *std::max_element(distance.begin(), distance.end()); }

LumenField make_lumen_field(const TriangleMesh& lumen, double voxels) {
  LumenField field;
  Vector3d low, high;
  bounding_box(lumen, low, high);
  const double box_floor = std::cbrt((high - low).prod() / 2e7);  // never more than 20 million lattice points in the box
  const double spacing = std::max(std::cbrt(std::abs(signed_volume(lumen)) / voxels), box_floor);
  field.grid = voxelize(lumen, spacing);
  keep_largest_part(field.grid);
  field.distance = distance_transform(field.grid);
  return field;
}

std::vector<Vector3d> find_far_ends(const LumenField& field, std::size_t most) {
  const auto plain = [](std::size_t) { return 1.0; };
  const auto deepest = std::size_t(std::max_element(field.distance.begin(), field.distance.end()) - field.distance.begin());
  if (field.distance.empty() || !field.grid.inside[deepest]) return {};
  const std::size_t first = farthest(shortest_paths(field, {deepest}, plain));
  std::vector<std::size_t> ends{first}, covered{first};
  while (ends.size() < most) {
    const Tree tree = shortest_paths(field, covered, plain);
    const std::size_t next = farthest(tree);
    const std::vector<std::size_t> path = path_to(tree, next);
    // A bulge of the wall is not an end: it must stand off by more than the bore where it leaves the others.
    double bore = 0;
    for (std::size_t v : path) bore = std::max(bore, 2 * field.distance[v]);
    if (ends.size() > 1 && tree.cost[next] < 1.2 * bore) break;
    ends.push_back(next);
    const Tree inner = shortest_paths(field, {first}, [&](std::size_t v) { return 1 / (field.distance[v] * field.distance[v]); });
    for (std::size_t v : path_to(inner, next)) covered.push_back(v);
  }
  std::vector<Vector3d> points;
  for (std::size_t end : ends) points.push_back(center_of(field.grid, end));
  return points;
}

double geodesic_distance(const LumenField& field, const Vector3d& from, const Vector3d& to) {
  const std::size_t a = inside_voxel_near(field, from), b = inside_voxel_near(field, to);
  if (a == nowhere || b == nowhere) return infinity;
  return shortest_paths(field, {a}, [](std::size_t) { return 1.0; }).cost[b];
}

Centreline trace_centreline(const LumenField& field, const Vector3d& from, const Vector3d& to) {
  const std::size_t a = inside_voxel_near(field, from), b = inside_voxel_near(field, to);
  if (a == nowhere || b == nowhere || a == b) return {};
  const Tree tree = shortest_paths(field, {a}, [&](std::size_t v) { return 1 / (field.distance[v] * field.distance[v]); });
  if (tree.cost[b] == infinity) return {};
  std::vector<Vector3d> points{from};
  for (std::size_t v : path_to(tree, b)) points.push_back(center_of(field.grid, v));
  points.push_back(to);
  smooth(points, 30);
  Centreline line = resample_centreline(points, field.grid.spacing);
  smooth(line.points, 60);
  return resample_centreline(line.points, field.grid.spacing);
}

Centreline resample_centreline(const std::vector<Vector3d>& polyline, double step) {
  Centreline line;
  if (polyline.size() < 2) return line;
  std::vector<double> arc{0};
  for (std::size_t i = 1; i < polyline.size(); ++i) arc.push_back(arc.back() + (polyline[i] - polyline[i - 1]).norm());
  const auto pieces = std::max<std::size_t>(1, std::size_t(std::lround(arc.back() / step)));
  for (std::size_t n = 0, i = 1; n <= pieces; ++n) {
    const double s = arc.back() * double(n) / double(pieces);
    while (i + 1 < arc.size() && arc[i] < s) ++i;
    const double t = arc[i] > arc[i - 1] ? std::clamp((s - arc[i - 1]) / (arc[i] - arc[i - 1]), 0.0, 1.0) : 0;
    line.points.push_back(polyline[i - 1] + t * (polyline[i] - polyline[i - 1]));
    line.arc.push_back(s);
  }
  for (std::size_t n = 0; n < line.points.size(); ++n) {
    const std::size_t before = n >= 3 ? n - 3 : 0, after = std::min(n + 3, line.points.size() - 1);
    line.tangents.push_back((line.points[after] - line.points[before]).normalized());
  }
  return line;
}

}  // namespace geometry
