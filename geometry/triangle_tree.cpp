#include "geometry/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/signed_distance_grid.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int leaf_size = 4;

// Where the ray enters the box, or infinity.
double box_entry(const Vector3d& low, const Vector3d& high, const Vector3d& origin, const Vector3d& inverse) {
  double enter = 0, leave = infinity;
  for (int k = 0; k < 3; ++k) {
    double a = (low[k] - origin[k]) * inverse[k], b = (high[k] - origin[k]) * inverse[k];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter <= leave * (1 + 1e-12) ? enter : infinity;
}

// Möller & Trumbore 1997; the edges belong to both triangles, so a ray through an edge is never lost.
double hit_triangle(const Vector3d& origin, const Vector3d& direction, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0) return infinity;
  const Vector3d s = origin - a, q = s.cross(ab);
  const double u = s.dot(p) / determinant, v = direction.dot(q) / determinant;
  constexpr double slack = 1e-12;
  if (u < -slack || v < -slack || u + v > 1 + slack) return infinity;
  return ac.dot(q) / determinant;
}

double squared_box_distance(const Vector3d& low, const Vector3d& high, const Vector3d& point) {
  return (low - point).cwiseMax(point - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  if (mesh_.triangles.empty()) return;
  std::iota(order_.begin(), order_.end(), 0);
  std::vector<Vector3d> centers;
  for (const auto& t : mesh_.triangles)
    centers.push_back((mesh_.vertices[std::size_t(t[0])] + mesh_.vertices[std::size_t(t[1])] + mesh_.vertices[std::size_t(t[2])]) / 3);
  nodes_.reserve(mesh_.triangles.size());
  nodes_.emplace_back();
  build(0, 0, std::int32_t(order_.size()), centers);
}

void TriangleTree::build(std::int32_t node, std::int32_t first, std::int32_t count, const std::vector<Vector3d>& centers) {
  Vector3d low = Vector3d::Constant(infinity), high = -low;
  for (std::int32_t i = first; i < first + count; ++i)
    for (std::int32_t v : mesh_.triangles[std::size_t(order_[std::size_t(i)])]) {
      low = low.cwiseMin(mesh_.vertices[std::size_t(v)]);
      high = high.cwiseMax(mesh_.vertices[std::size_t(v)]);
    }
  nodes_[std::size_t(node)].low = low;
  nodes_[std::size_t(node)].high = high;
  if (count <= leaf_size) {
    nodes_[std::size_t(node)].first = first;
    nodes_[std::size_t(node)].count = count;
    return;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [&](std::int32_t a, std::int32_t b) {
    const double p = centers[std::size_t(a)][axis], q = centers[std::size_t(b)][axis];
    return p != q ? p < q : a < b;
  });
  const auto child = std::int32_t(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[std::size_t(node)].first = child;
  build(child, first, count / 2, centers);
  build(child + 1, first + count / 2, count - count / 2, centers);
}

template <class Visit>
void TriangleTree::along_ray(const Vector3d& origin, const Vector3d& direction, Visit&& visit) const {
  if (nodes_.empty()) return;
  const Vector3d inverse = direction.cwiseInverse();
  std::int32_t stack[128];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[std::size_t(stack[--top])];
    if (box_entry(node.low, node.high, origin, inverse) == infinity) continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = node.first + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& t = mesh_.triangles[std::size_t(order_[std::size_t(i)])];
      const double hit = hit_triangle(origin, direction, mesh_.vertices[std::size_t(t[0])], mesh_.vertices[std::size_t(t[1])],
                                      mesh_.vertices[std::size_t(t[2])]);
      if (hit < infinity) visit(hit);
    }
  }
}

double TriangleTree::first_hit(const Vector3d& origin, const Vector3d& direction, double from) const {
  double nearest = infinity;
  along_ray(origin, direction, [&](double hit) {
    if (hit > from) nearest = std::min(nearest, hit);
  });
  return nearest;
}

bool TriangleTree::contains(const Vector3d& point) const {
  std::size_t hits = 0;
  along_ray(point, Vector3d(0.5377, 0.7213, 0.4366).normalized(), [&](double hit) { hits += hit > 0; });
  return hits % 2 == 1;
}

double TriangleTree::distance(const Vector3d& point) const {
  if (nodes_.empty()) return infinity;
  double nearest = infinity;
  std::int32_t stack[128];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[std::size_t(stack[--top])];
    if (squared_box_distance(node.low, node.high, point) >= nearest) continue;
    if (node.count == 0) {
      const Node &left = nodes_[std::size_t(node.first)], &right = nodes_[std::size_t(node.first) + 1];
      const bool left_first = squared_box_distance(left.low, left.high, point) < squared_box_distance(right.low, right.high, point);
      stack[top++] = left_first ? node.first + 1 : node.first;
      stack[top++] = left_first ? node.first : node.first + 1;
      continue;
    }
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& t = mesh_.triangles[std::size_t(order_[std::size_t(i)])];
      nearest = std::min(nearest, squared_distance_to_triangle(point, mesh_.vertices[std::size_t(t[0])], mesh_.vertices[std::size_t(t[1])],
                                                               mesh_.vertices[std::size_t(t[2])]));
    }
  }
  return std::sqrt(nearest);
}

}  // namespace geometry
