#include "geometry/iso_surface.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

namespace geometry {
namespace {

using Eigen::Vector3d;

struct Corner {
  Vector3d point;
  double distance;
};

Vector3d zero_between(const Corner& a, const Corner& b) { return a.point + (b.point - a.point) * (a.distance / (a.distance - b.distance)); }

// Surface within one simplex (triangle or tetrahedron), split by the sign of its corners.
template <std::size_t N>
void cut_simplex(const std::array<const Corner*, N>& corners, std::vector<SurfaceElement>& elements) {
  std::array<const Corner*, N> in{}, out{};
  std::size_t ins = 0, outs = 0;
  for (const Corner* corner : corners) (corner->distance <= 0 ? in[ins++] : out[outs++]) = corner;
  if (ins == 0 || outs == 0) return;
  Vector3d outward = Vector3d::Zero();
  for (std::size_t i = 0; i < outs; ++i) outward += out[i]->point / double(outs);
  for (std::size_t i = 0; i < ins; ++i) outward -= in[i]->point / double(ins);
  const auto add = [&](const Vector3d& center, Vector3d area) {
    if (area.dot(outward) < 0) area = -area;
    elements.push_back({center, area});
  };
  if constexpr (N == 3) {
    const Corner& lone = ins == 1 ? *in[0] : *out[0];
    const auto& pair = ins == 1 ? out : in;
    const Vector3d p = zero_between(lone, *pair[0]), q = zero_between(lone, *pair[1]);
    add(0.5 * (p + q), {q.y() - p.y(), p.x() - q.x(), 0});
  } else {
    const auto triangle = [&](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
      add((p + q + r) / 3, 0.5 * (q - p).cross(r - p));
    };
    if (ins == 2) {
      const Vector3d p = zero_between(*in[0], *out[0]), q = zero_between(*in[0], *out[1]), r = zero_between(*in[1], *out[1]),
                     s = zero_between(*in[1], *out[0]);
      triangle(p, q, r);
      triangle(p, r, s);
    } else {
      const Corner& lone = ins == 1 ? *in[0] : *out[0];
      const auto& three = ins == 1 ? out : in;
      triangle(zero_between(lone, *three[0]), zero_between(lone, *three[1]), zero_between(lone, *three[2]));
    }
  }
}

constexpr int block = 4;  // cells along a block's edge

// Surface within one block of cells, its first corner at `origin`.
std::vector<SurfaceElement> cut_block(const Shape& shape, int dimension, double spacing, const Vector3d& origin) {
  std::vector<SurfaceElement> elements;
  const int deep = dimension == 3 ? block : 0;
  const Vector3d middle = origin + 0.5 * spacing * Vector3d(block, block, deep);
  if (std::abs(signed_distance(shape, middle, dimension)) > 0.501 * spacing * block * std::sqrt(double(dimension))) return elements;
  std::array<Corner, (block + 1) * (block + 1) * (block + 1)> corners;
  const auto corner = [&](int i, int j, int k) { return &corners[i + (block + 1) * (j + (block + 1) * k)]; };
  for (int k = 0; k <= deep; ++k)
    for (int j = 0; j <= block; ++j)
      for (int i = 0; i <= block; ++i) {
        const Vector3d point = origin + spacing * Vector3d(i, j, k);
        *corner(i, j, k) = {point, signed_distance(shape, point, dimension)};
      }
  // Six tetrahedra a cube, all round its main diagonal: neighbours' faces match.
  constexpr int path[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
  for (int k = 0; k < std::max(deep, 1); ++k)
    for (int j = 0; j < block; ++j)
      for (int i = 0; i < block; ++i) {
        const auto at = [&](int bits) { return corner(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2)); };
        if (dimension == 2) {
          cut_simplex<3>({at(0), at(1), at(3)}, elements);
          cut_simplex<3>({at(0), at(3), at(2)}, elements);
        } else {
          for (const auto& two : path) cut_simplex<4>({at(0), at(two[0]), at(two[1]), at(7)}, elements);
        }
      }
  return elements;
}

}  // namespace

std::vector<SurfaceElement> surface_elements(const Shape& shape, int dimension, double spacing) {
  const BoundingBox box = bounding_box(shape, dimension);
  // Off the shape's own planes by an odd fraction: no corner lies exactly on a face.
  Vector3d origin = box.min.array() - 1.3717 * spacing;
  if (dimension == 2) origin.z() = 0;
  std::array<std::ptrdiff_t, 3> count{1, 1, 1};
  for (int k = 0; k < dimension; ++k) count[k] = std::ptrdiff_t(std::ceil((box.max[k] - origin[k] + 2 * spacing) / (block * spacing)));
  std::vector<SurfaceElement> elements;
  std::vector<std::vector<SurfaceElement>> layer(std::size_t(count[0] * count[1]));
  for (std::ptrdiff_t k = 0; k < count[2]; ++k) {
#pragma omp parallel for schedule(dynamic, 64)
    for (std::ptrdiff_t b = 0; b < count[0] * count[1]; ++b)
      layer[b] =
          cut_block(shape, dimension, spacing, origin + block * spacing * Vector3d(double(b % count[0]), double(b / count[0]), double(k)));
    for (const auto& part : layer) elements.insert(elements.end(), part.begin(), part.end());  // in order, whatever the number of threads
  }
  return elements;
}

}  // namespace geometry
