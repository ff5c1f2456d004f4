#include "geometry/signed_distance_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace geometry {
namespace {

using Eigen::Vector3d;
constexpr int slab = 4;  // grid layers handled by one thread at a time

struct Piece {
  Vector3d a, b, c, middle;
  double radius;
};

// Halves the longest edge until pieces are small, so that a piece's neighbourhood holds few grid points in vain.
void split_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, double largest, std::vector<Piece>& pieces) {
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  if (std::max({ab, bc, ca}) <= largest * largest) {
    const Vector3d middle = (a + b + c) / 3;
    const double radius = std::sqrt(std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
    pieces.push_back({a, b, c, middle, radius});
    return;
  }
  if (ab >= bc && ab >= ca) {
    const Vector3d m = 0.5 * (a + b);
    split_triangle(a, m, c, largest, pieces);
    split_triangle(m, b, c, largest, pieces);
  } else if (bc >= ca) {
    split_triangle(b, 0.5 * (b + c), a, largest, pieces);
    split_triangle(0.5 * (b + c), c, a, largest, pieces);
  } else {
    split_triangle(c, 0.5 * (c + a), b, largest, pieces);
    split_triangle(0.5 * (c + a), a, b, largest, pieces);
  }
}

// Which side of the directed line p -> q the point (y, z) lies on, computed the same way for both triangles that share the edge.
bool left_of(const Vector3d& p, const Vector3d& q, double y, double z) {
  const bool ordered = p.y() < q.y() || (p.y() == q.y() && (p.z() < q.z() || (p.z() == q.z() && p.x() < q.x())));
  const Vector3d& s = ordered ? p : q;
  const Vector3d& t = ordered ? q : p;
  const double cross = (t.y() - s.y()) * (z - s.z()) - (t.z() - s.z()) * (y - s.y());
  return (cross > 0) == ordered;
}

// Where the line through (y, z) along x meets the triangle; NaN where it does not.
double crossing_along_x(const Vector3d& a, const Vector3d& b, const Vector3d& c, double y, double z) {
  const bool side = left_of(a, b, y, z);
  if (left_of(b, c, y, z) != side || left_of(c, a, y, z) != side) return std::numeric_limits<double>::quiet_NaN();
  const Vector3d normal = (b - a).cross(c - a);
  if (normal.x() == 0) return std::numeric_limits<double>::quiet_NaN();
  const double x = a.x() - (normal.y() * (y - a.y()) + normal.z() * (z - a.z())) / normal.x();
  return std::clamp(x, std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}));
}

}  // namespace

double squared_distance_to_triangle(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c, Vector3d* closest) {
  const auto answer = [&](const Vector3d& foot) {
    if (closest) *closest = foot;
    return (point - foot).squaredNorm();
  };
  const Vector3d ab = b - a, ac = c - a, ap = point - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return answer(a);
  const Vector3d bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return answer(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return answer(a + ab * (d1 / (d1 - d3)));
  const Vector3d cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return answer(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return answer(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return answer(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  if (!(sum > 0)) return answer(a);  // a triangle without area
  return answer(a + ab * (vb / sum) + ac * (vc / sum));
}

double enclosed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  const Vector3d origin = mesh.vertices.empty() ? Vector3d::Zero() : mesh.vertices.front();
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

SignedDistanceGrid::SignedDistanceGrid(const TriangleMesh& mesh, double spacing, double band) : spacing_(spacing), band_(band) {
  if (mesh.empty()) throw std::runtime_error("a mesh without triangles has no inside");
  Vector3d low = mesh.vertices[mesh.triangles[0][0]], high = low;
  for (const auto& t : mesh.triangles)
    for (int k : t) {
      low = low.cwiseMin(mesh.vertices[k]);
      high = high.cwiseMax(mesh.vertices[k]);
    }
  origin_ = low.array() - (band + spacing);
  double total = 1;
  for (int k = 0; k < 3; ++k) {
    count_[k] = int(std::ceil((high[k] - low[k] + 2 * (band + spacing)) / spacing)) + 1;
    total *= count_[k];
  }
  if (total > 4e8) throw std::runtime_error("the mesh is too large for this particle spacing; use a coarser spacing or smaller units");
  values_.assign(std::size_t(total), float(band * band));

  std::vector<Piece> pieces;
  for (const auto& t : mesh.triangles) split_triangle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], 3 * spacing, pieces);
  const int slabs = (count_[2] + slab - 1) / slab;
  std::vector<std::vector<std::int32_t>> near(slabs), crossed(slabs);
  const auto list = [&](std::vector<std::vector<std::int32_t>>& lists, double from, double to, std::int32_t item) {
    const int first = std::max(0, int(std::floor((from - origin_.z()) / spacing)) / slab);
    const int last = std::min(slabs - 1, std::max(0, int(std::ceil((to - origin_.z()) / spacing))) / slab);
    for (int s = first; s <= last; ++s) lists[s].push_back(item);
  };
  for (std::size_t i = 0; i < pieces.size(); ++i)
    list(near, pieces[i].middle.z() - pieces[i].radius - band, pieces[i].middle.z() + pieces[i].radius + band, std::int32_t(i));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const double za = mesh.vertices[t[0]].z(), zb = mesh.vertices[t[1]].z(), zc = mesh.vertices[t[2]].z();
    list(crossed, std::min({za, zb, zc}), std::max({za, zb, zc}), std::int32_t(i));
  }

#pragma omp parallel for schedule(dynamic)
  for (int s = 0; s < slabs; ++s) {
    const int k0 = s * slab, k1 = std::min(count_[2], k0 + slab);
    // Squared distances: the least over all pieces in reach.
    for (std::int32_t item : near[s]) {
      const Piece& piece = pieces[item];
      const double reach = piece.radius + band;
      for (int k = k0; k < k1; ++k) {
        const double dz = origin_.z() + k * spacing - piece.middle.z();
        const double rest = reach * reach - dz * dz;
        if (rest <= 0) continue;
        const double width = std::sqrt(rest);
        const int j0 = std::max(0, int(std::ceil((piece.middle.y() - width - origin_.y()) / spacing)));
        const int j1 = std::min(count_[1] - 1, int(std::floor((piece.middle.y() + width - origin_.y()) / spacing)));
        for (int j = j0; j <= j1; ++j) {
          const double dy = origin_.y() + j * spacing - piece.middle.y();
          const double half = std::sqrt(std::max(0.0, rest - dy * dy));
          const int i0 = std::max(0, int(std::ceil((piece.middle.x() - half - origin_.x()) / spacing)));
          const int i1 = std::min(count_[0] - 1, int(std::floor((piece.middle.x() + half - origin_.x()) / spacing)));
          float* row = values_.data() + std::size_t(count_[0]) * (j + std::size_t(count_[1]) * k);
          for (int i = i0; i <= i1; ++i) {
            const double dx = origin_.x() + i * spacing - piece.middle.x();
            const double away2 = dx * dx + dy * dy + dz * dz, known = row[i];
            const double gap2 = away2 - known - piece.radius * piece.radius;  // away > radius + sqrt(known) without a root
            if (gap2 > 0 && gap2 * gap2 >= 4 * known * piece.radius * piece.radius) continue;
            const Vector3d point(origin_.x() + i * spacing, origin_.y() + j * spacing, origin_.z() + k * spacing);
            row[i] = std::min(row[i], float(squared_distance_to_triangle(point, piece.a, piece.b, piece.c)));
          }
        }
      }
    }
    // Sign: crossings of each grid line along x, moved off lattice-aligned faces and vertices by a fraction too small to matter.
    const double shift_y = 1.234567e-5 * spacing, shift_z = 2.718281e-5 * spacing;
    std::vector<std::vector<double>> crossings(std::size_t(count_[1]) * (k1 - k0));
    for (std::int32_t item : crossed[s]) {
      const auto& t = mesh.triangles[item];
      const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      const auto range = [&](int axis, double shift, int count) {
        const double from = (std::min({a[axis], b[axis], c[axis]}) - shift - origin_[axis]) / spacing;
        const double to = (std::max({a[axis], b[axis], c[axis]}) - shift - origin_[axis]) / spacing;
        return std::array<int, 2>{std::max(0, int(std::ceil(from)) - 1), std::min(count - 1, int(std::floor(to)) + 1)};
      };
      const auto [j0, j1] = range(1, shift_y, count_[1]);
      const auto [m0, m1] = range(2, shift_z, count_[2]);
      for (int k = std::max(m0, k0); k <= std::min(m1, k1 - 1); ++k)
        for (int j = j0; j <= j1; ++j) {
          const double x = crossing_along_x(a, b, c, origin_.y() + j * spacing + shift_y, origin_.z() + k * spacing + shift_z);
          if (!std::isnan(x)) crossings[std::size_t(count_[1]) * (k - k0) + j].push_back(x);
        }
    }
    for (int k = k0; k < k1; ++k)
      for (int j = 0; j < count_[1]; ++j) {
        auto& line = crossings[std::size_t(count_[1]) * (k - k0) + j];
        std::sort(line.begin(), line.end());
        float* row = values_.data() + std::size_t(count_[0]) * (j + std::size_t(count_[1]) * k);
        std::size_t passed = 0;
        for (int i = 0; i < count_[0]; ++i) {
          const double x = origin_.x() + i * spacing;
          while (passed < line.size() && line[passed] < x) ++passed;
          row[i] = std::sqrt(row[i]) * (passed % 2 ? -1.0f : 1.0f);
        }
      }
  }
}

double SignedDistanceGrid::distance(const Vector3d& point) const {
  const Vector3d place = (point - origin_) / spacing_;
  std::array<int, 3> cell;
  Vector3d part;
  for (int k = 0; k < 3; ++k) {
    if (place[k] < 0 || place[k] > count_[k] - 1) {  // outside the grid: how far outside the surface's own box at least
      const Vector3d low = origin_.array() + (band_ + spacing_);
      const Vector3d high = (origin_ + spacing_ * Vector3d(count_[0] - 1, count_[1] - 1, count_[2] - 1)).array() - band_;
      return std::max(band_, (low - point).cwiseMax(point - high).cwiseMax(0.0).norm());
    }
    cell[k] = std::min(int(place[k]), count_[k] - 2);
    part[k] = place[k] - cell[k];
  }
  const std::size_t up = count_[0], deep = std::size_t(count_[0]) * count_[1];
  const float* v = values_.data() + cell[0] + up * cell[1] + deep * cell[2];
  const auto mix = [](double t, double a, double b) { return a + t * (b - a); };
  const double front = mix(part[1], mix(part[0], v[0], v[1]), mix(part[0], v[up], v[up + 1]));
  const double back = mix(part[1], mix(part[0], v[deep], v[deep + 1]), mix(part[0], v[deep + up], v[deep + up + 1]));
  return mix(part[2], front, back);
}

}  // namespace geometry
