// Inside the sides of leaflets: elements of the sheet as they lie now, nearest points, and the list of those near a particle.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "sim/sides.h"

namespace sim {

template <int D>
SheetElement<D> element_at(const State<D>& state, const std::array<std::int32_t, D>& rows) {
  SheetElement<D> e;
  e.origin = state.position[rows[0]];
  for (int k = 1; k < D; ++k) e.edges.col(k - 1) = state.position[rows[k]] - e.origin;
  if constexpr (D == 2)
    e.normal = Vector<2>(-e.edges(1, 0), e.edges(0, 0));
  else
    e.normal = Eigen::Vector3d(e.edges.col(0)).cross(Eigen::Vector3d(e.edges.col(1)));
  e.offset = e.normal.dot(e.origin);
  e.center.setZero();
  for (std::int32_t row : rows) e.center += state.position[row] / D;
  e.reach = 0;
  for (std::int32_t row : rows) e.reach = std::max(e.reach, (state.position[row] - e.center).norm());
  return e;
}

// Whether the point x (in the element's plane) lies in the element, with a hair's margin so that no link slips between two.
template <int D>
bool in_element(const SheetElement<D>& e, const Vector<D>& x) {
  constexpr double margin = 1e-6;
  const Vector<D> r = x - e.origin;
  if constexpr (D == 2) {
    const double s = r.dot(e.edges.col(0)) / e.edges.col(0).squaredNorm();
    return s >= -margin && s <= 1 + margin;
  } else {
    const Eigen::Vector3d e1 = e.edges.col(0), e2 = e.edges.col(1);
    const double square = e.normal.squaredNorm();
    const double u = r.cross(e2).dot(e.normal) / square, v = e1.cross(r).dot(e.normal) / square;
    return u >= -margin && v >= -margin && u + v <= 1 + margin;
  }
}

// Nearest point of an element: barycentric weights of its rows.
template <int D>
Eigen::Matrix<double, D, 1> nearest_weights(const State<D>& state, const std::array<std::int32_t, D>& rows, const Vector<D>& x) {
  Eigen::Matrix<double, D, 1> w;
  if constexpr (D == 2) {
    const Vector<2> a = state.position[rows[0]], d = state.position[rows[1]] - a;
    const double s = std::clamp((x - a).dot(d) / std::max(d.squaredNorm(), 1e-300), 0.0, 1.0);
    w << 1 - s, s;
  } else {  // Ericson, Real-Time Collision Detection, 5.1.5
    const Eigen::Vector3d a = state.position[rows[0]], b = state.position[rows[1]], c = state.position[rows[2]];
    const Eigen::Vector3d ab = b - a, ac = c - a, ap = x - a, bp = x - b, cp = x - c;
    const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (d1 <= 0 && d2 <= 0)
      w << 1, 0, 0;
    else if (d3 >= 0 && d4 <= d3)
      w << 0, 1, 0;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
      w << 1 - d1 / (d1 - d3), d1 / (d1 - d3), 0;
    else if (d6 >= 0 && d5 <= d6)
      w << 0, 0, 1;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
      w << 1 - d2 / (d2 - d6), 0, d2 / (d2 - d6);
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      w << 0, 1 - s, s;
    } else {
      const double sum = va + vb + vc;
      w << va / sum, vb / sum, vc / sum;
    }
  }
  return w;
}

// Each thread's list of the elements near a row, and the row's height over each.
template <int D>
struct NearElements {
  std::vector<std::int32_t> seen;  // per element: the last row that listed it
  std::vector<std::int32_t> element;
  // What the tests against all of them need, element by element in arrays so that they vectorise.
  std::array<std::vector<double>, D> normal, center;  // center: as seen from x_i
  std::vector<double> height, reach;                  // height: normal . x_i - offset; reach: squared
  std::vector<std::uint8_t> candidate;                // filled up with zeros to whole words
  std::size_t near_count = 0;                         // of the first elements, which a link can cross in the half that begins at the row

  // Elements that hold a shell row near row i, each once, in the order of i's neighbours.
  void list(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, std::ptrdiff_t i) {
    const SheetGeometry<D>& sheet = *scene.sheet;
    seen.resize(sheet.elements.size(), -1);
    element.clear();
    for (std::int32_t j : work.neighbors.of(i)) {
      if (state.kind[j] != Kind::shell) continue;
      const std::int32_t s = j - static_cast<std::int32_t>(scene.elastic_count);
      for (std::int32_t k = sheet.incident_start[s]; k < sheet.incident_start[s + 1]; ++k) {
        const std::int32_t e = sheet.incident[k];
        if (seen[e] == static_cast<std::int32_t>(i)) continue;
        seen[e] = static_cast<std::int32_t>(i);
        element.push_back(e);
      }
    }
  }

  void measure(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, std::ptrdiff_t i) {
    const std::size_t count = element.size();
    const double half = 0.5 * scene.lattice.radius;
    const Vector<D> here = state.position[i];
    const auto far = std::partition(element.begin(), element.end(), [&](std::int32_t e) {
      const SheetElement<D>& one = work.sheet_elements[e];
      const double least = half + one.reach, over = one.normal.dot(here) - one.offset;
      return (one.center - here).squaredNorm() <= least * least && over * over <= half * half * one.normal.squaredNorm();
    });
    near_count = static_cast<std::size_t>(far - element.begin());
    // Filled up to whole registers with elements that nothing is near.
    const std::size_t whole = (count + 7) / 8 * 8;
    height.assign(whole, 1.0), reach.assign(whole, -1.0), candidate.assign(whole, 0);
    for (int k = 0; k < D; ++k) normal[k].assign(whole, 1.0), center[k].assign(whole, 0.0);
    for (std::size_t c = 0; c < count; ++c) {
      const SheetElement<D>& e = work.sheet_elements[element[c]];
      for (int k = 0; k < D; ++k) normal[k][c] = e.normal[k], center[k][c] = e.center[k] - here[k];
      reach[c] = 1.0001 * e.reach * e.reach;
      height[c] = e.normal.dot(here) - e.offset;
    }
  }

  // Marks the elements, of at least the first `count`, of which x_i + d lies on the other side than x_i and which are near where d crosses
  // their plane.
  void find_candidates(const Vector<D>& d, std::size_t count) {
    std::array<const double*, D> n, m;
    for (int k = 0; k < D; ++k) n[k] = normal[k].data(), m[k] = center[k].data();
    const double *here = height.data(), *far = reach.data();
    std::uint8_t* result = candidate.data();
    const Vector<D> way = d;
    const std::size_t whole = (count + 7) / 8 * 8;
#pragma omp simd
    for (std::size_t c = 0; c < whole; ++c) {
      double change = 0, aside = 0;
      for (int k = 0; k < D; ++k) change += n[k][c] * way[k];
      // d crosses the plane a part -here/change of its way along; squares times change² save the division.
      for (int k = 0; k < D; ++k) aside += (here[c] * way[k] + change * m[k][c]) * (here[c] * way[k] + change * m[k][c]);
      result[c] = static_cast<std::uint8_t>(((here[c] > 0) ^ (here[c] + change > 0)) & (aside <= far[c] * (change * change)));
    }
  }

  // Whether the segment from x_i to `to`, which may end on the sheet at row `on` (-1: does not), crosses one of the first `count` elements.
  bool crosses(const Scene<D>& scene, const Workspace<D>& work, const Vector<D>& from, const Vector<D>& to, std::int32_t on,
               std::size_t count) {
    const Vector<D> d = to - from;
    find_candidates(d, count);
    for (std::size_t first = 0; first < count; first += 8) {  // most are none: eight at a time are passed by
      std::uint64_t word;
      std::memcpy(&word, candidate.data() + first, 8);
      if (count - first < 8) word &= (std::uint64_t{1} << 8 * (count - first)) - 1;  // marks behind them are another link's
      for (; word != 0; word &= word - 1) {
        const std::size_t c = first + static_cast<std::size_t>(std::countr_zero(word)) / 8;
        const SheetElement<D>& e = work.sheet_elements[element[c]];
        const Vector<D> point = from - height[c] / e.normal.dot(d) * d;
        if (!in_element<D>(e, point)) continue;
        const auto& rows = scene.sheet->elements[element[c]];
        if (on < 0 || std::find(rows.begin(), rows.end(), on) == rows.end()) return true;
      }
    }
    return false;
  }
};

}  // namespace sim
