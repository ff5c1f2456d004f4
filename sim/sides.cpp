#include "sim/sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace sim {
using Index = std::ptrdiff_t;

namespace {

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
  void list(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i) {
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

  void measure(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i) {
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
      const double part = -here[c] / change;
      for (int k = 0; k < D; ++k) aside += (part * way[k] - m[k][c]) * (part * way[k] - m[k][c]);
      result[c] = static_cast<std::uint8_t>(((here[c] > 0) ^ (here[c] + change > 0)) & (aside <= far[c]));
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

}  // namespace

template <int D>
void cut_links(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  std::vector<std::uint8_t> beside(n, 0);
  for (Index s = scene.elastic_count; s < static_cast<Index>(scene.elastic_count + scene.shell_count); ++s)
    for (std::int32_t i : work.neighbors.of(s)) beside[i] = 1;
  work.near_sheet.clear();
  for (Index i = scene.first_fluid; i < n; ++i)
    if (beside[i]) work.near_sheet.push_back(static_cast<std::int32_t>(i));
  const Index near = static_cast<Index>(work.near_sheet.size()), elements = static_cast<Index>(scene.sheet->elements.size());
  work.sheet_elements.resize(elements);
#pragma omp parallel for schedule(static)
  for (Index e = 0; e < elements; ++e) work.sheet_elements[e] = element_at<D>(state, scene.sheet->elements[e]);
#pragma omp parallel
  {
    NearElements<D> sheet_near;
#pragma omp for schedule(dynamic, 64)
    for (Index a = 0; a < near; ++a) {
      const Index i = work.near_sheet[a];
      sheet_near.list(scene, state, work, i);
      sheet_near.measure(scene, state, work, i);
      for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
        if (work.link_weight[k] == 0) continue;
        const std::int32_t j = work.neighbors.index[k];
        // Of two fluid particles the one nearer to the crossing finds it, and cuts for both below.
        const std::size_t count = j >= scene.first_fluid ? sheet_near.near_count : sheet_near.element.size();
        if (sheet_near.crosses(scene, work, state.position[i], state.position[j], state.kind[j] == Kind::shell ? j : -1, count))
          work.link_weight[k] = 0;
      }
    }
  }
  // Cut (i, j) wherever (j, i) is cut.
  std::vector<std::pair<std::int32_t, std::int64_t>> also;
#pragma omp parallel
  {
    std::vector<std::pair<std::int32_t, std::int64_t>> mine;
#pragma omp for schedule(dynamic, 64) nowait
    for (Index a = 0; a < near; ++a) {
      const Index i = work.near_sheet[a];
      for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
        const std::int32_t j = work.neighbors.index[k];
        if (work.link_weight[k] != 0 || j < scene.first_fluid) continue;
        for (std::int64_t m = work.neighbors.start[j]; m < work.neighbors.start[j + 1]; ++m)
          if (work.neighbors.index[m] == i && work.link_weight[m] != 0) mine.emplace_back(j, m);
      }
    }
#pragma omp critical
    also.insert(also.end(), mine.begin(), mine.end());
  }
  for (const auto& [row, entry] : also) work.link_weight[entry] = 0;
  work.support.assign(n, 1.0);
#pragma omp parallel for schedule(static)
  for (Index a = 0; a < near; ++a) {
    const Index i = work.near_sheet[a];
    double visible = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k)
      if (work.neighbors.index[k] >= scene.first_fluid) visible += work.link_weight[k];
    work.support[i] = std::clamp((visible / scene.lattice.number_density - 0.25) / 0.25, 0.0, 1.0);
  }
}

namespace {

// Blood particle `unknown` wets a face, not yet with a weight's share of the face's sum.
struct Wet {
  std::int32_t face, unknown;
  double weight, visible;
};

// Who wets which face: blood particles in ascending order, part by part of near_sheet so that parts can be looked at at once.
template <int D>
std::vector<Wet> find_wet(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work) {
  constexpr Index part_rows = 256;
  const std::int32_t first_shell = static_cast<std::int32_t>(scene.elastic_count);
  const Index near = static_cast<Index>(work.near_sheet.size()), parts = (near + part_rows - 1) / part_rows;
  std::vector<std::vector<Wet>> found(static_cast<std::size_t>(parts));
#pragma omp parallel for schedule(dynamic, 1)
  for (Index part = 0; part < parts; ++part)
    for (Index a = part * part_rows; a < std::min(near, (part + 1) * part_rows); ++a) {
      const std::int32_t i = work.near_sheet[a];
      if (state.kind[i] != Kind::fluid || work.unknown[i] < 0 || work.support[i] <= 0) continue;
      for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
        const std::int32_t j = work.neighbors.index[k];
        if (work.link_weight[k] == 0 || state.kind[j] != Kind::shell) continue;
        const double height = scene.space.difference(state.position[j], state.position[i]).dot(work.boundary_normal[j]);
        const double weight = work.support[i] * work.link_weight[k];
        found[part].push_back(
            {2 * (j - first_shell) + (height > 0 ? 0 : 1), work.unknown[i], weight * std::abs(height), weight / scene.measure[j]});
      }
    }
  std::vector<Wet> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

template <int D>
void wetted_sides(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const std::size_t faces = 2 * static_cast<std::size_t>(scene.shell_count);
  const std::vector<Wet> found = find_wet(scene, state, work);
  std::vector<double> visible(faces, 0), sum(faces, 0);
  work.wet_start.assign(faces + 1, 0);
  for (const Wet& wet : found) {
    ++work.wet_start[wet.face + 1];
    visible[wet.face] += wet.visible;
    sum[wet.face] += wet.weight;
  }
  for (std::size_t a = 0; a < faces; ++a) work.wet_start[a + 1] += work.wet_start[a];
  std::vector<std::int32_t> next(work.wet_start.begin(), work.wet_start.end() - 1);
  work.wetting.resize(found.size()), work.wet_faces.resize(found.size());
  work.wet_unknown.clear(), work.wet_unknown_start.clear();
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Wet& wet = found[k];
    const double weight = wet.weight / (sum[wet.face] > 0 ? sum[wet.face] : 1.0);
    work.wetting[next[wet.face]++] = {wet.unknown, weight};
    work.wet_faces[k] = {wet.face, weight};
    if (!work.wet_unknown.empty() && work.wet_unknown.back() == wet.unknown) continue;
    work.wet_unknown.push_back(wet.unknown);
    work.wet_unknown_start.push_back(static_cast<std::int32_t>(k));
  }
  work.wet_unknown_start.push_back(static_cast<std::int32_t>(found.size()));
  // Wet: of the half space that blood on a lattice fills beside a leaflet (0.3 n0), half and more is seen; dry: less than a seventh.
  const double full = 0.3 * scene.lattice.number_density;
  work.wet_share.assign(faces, 0);
  for (std::size_t a = 0; a < faces; ++a)
    if (sum[a] > 0) work.wet_share[a] = std::clamp((visible[a] / full - 0.15) / 0.35, 0.0, 1.0);
  work.film = make_gap_film(work.wet_share, scene.sheet->neighbor_start, scene.sheet->neighbor);
}

template <int D>
void remember_sides(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index near = static_cast<Index>(work.near_sheet.size());
  work.side_memory.assign(near, {});
#pragma omp parallel
  {
    NearElements<D> sheet_near;
#pragma omp for schedule(dynamic, 64)
    for (Index a = 0; a < near; ++a) {
      const Index i = work.near_sheet[a];
      sheet_near.list(scene, state, work, i);
      double best = 1e300;
      for (std::size_t c = 0; c < sheet_near.element.size(); ++c) {
        const std::int32_t e = sheet_near.element[c];
        const double least = (state.position[i] - work.sheet_elements[e].center).norm() - work.sheet_elements[e].reach;
        if (least > 0 && least * least >= best) continue;
        const auto& rows = scene.sheet->elements[e];
        const auto w = nearest_weights<D>(state, rows, state.position[i]);
        Vector<D> point = Vector<D>::Zero(), normal = Vector<D>::Zero();
        for (int k = 0; k < D; ++k) point += w[k] * state.position[rows[k]], normal += w[k] * work.boundary_normal[rows[k]];
        const Vector<D> r = state.position[i] - point;
        if (r.squaredNorm() >= best) continue;
        best = r.squaredNorm();
        work.side_memory[a] = {e, static_cast<std::int8_t>(r.dot(normal) > 0 ? 1 : -1)};
      }
    }
  }
}

template <int D>
void keep_sides(const Scene<D>& scene, State<D>& state, Workspace<D>& work) {
  const Index near = static_cast<Index>(work.near_sheet.size());
  const SheetGeometry<D>& sheet = *scene.sheet;
  const std::int32_t first_shell = static_cast<std::int32_t>(scene.elastic_count);
  const double clearance = 0.35 * scene.lattice.spacing;
  std::int64_t crossings = 0;
  double deepest = 0;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : crossings) reduction(max : deepest)
  for (Index a = 0; a < near; ++a) {
    const Index i = work.near_sheet[a];
    const auto memory = work.side_memory[a];
    if (memory.element < 0 || state.kind[i] != Kind::fluid) continue;
    // nearest point over the remembered element and those around it
    double best = 1e300;
    Vector<D> point, normal, velocity;
    bool on_edge = false;
    for (std::int32_t row : sheet.elements[memory.element]) {
      const std::int32_t s = row - first_shell;
      for (std::int32_t k = sheet.incident_start[s]; k < sheet.incident_start[s + 1]; ++k) {
        const auto& rows = sheet.elements[sheet.incident[k]];
        const auto w = nearest_weights<D>(state, rows, state.position[i]);
        Vector<D> p = Vector<D>::Zero();
        for (int m = 0; m < D; ++m) p += w[m] * state.position[rows[m]];
        if ((state.position[i] - p).squaredNorm() >= best) continue;
        best = (state.position[i] - p).squaredNorm();
        point = p;
        normal.setZero();
        velocity.setZero();
        on_edge = true;
        for (int m = 0; m < D; ++m) {
          normal += w[m] * work.boundary_normal[rows[m]];
          velocity += w[m] * state.velocity[rows[m]];
          if (w[m] > 1e-9 && !sheet.edge[rows[m] - first_shell]) on_edge = false;
        }
      }
    }
    if (best >= 4 * scene.lattice.spacing * scene.lattice.spacing || on_edge) continue;
    normal *= memory.side / std::max(normal.norm(), 1e-300);
    const double height = (state.position[i] - point).dot(normal);
    if (height >= clearance) continue;
    // Nothing crosses by more than a step's motion: whoever seems to stands beside the elements looked at, near another part of the sheet.
    const double aside = best - height * height;
    if (aside > 0.25 * scene.lattice.spacing * scene.lattice.spacing || height < -0.5 * scene.lattice.spacing) continue;
    if (height < 0) {
      ++crossings;
      deepest = std::max(deepest, -height);
      state.position[i] += (clearance - height) * normal;
    } else {
      state.position[i] += std::min(clearance - height, 0.1 * scene.lattice.spacing) * normal;
    }
    const double closing = (velocity - state.velocity[i]).dot(normal);
    if (closing > 0) state.velocity[i] += closing * normal;
  }
  state.ledger.sheet_crossings += crossings;
  state.ledger.deepest_penetration = std::max(state.ledger.deepest_penetration, deepest);
}

template <int D>
void stick_in_gaps(State<D>& state, const Workspace<D>& work) {
  const Index near = static_cast<Index>(work.near_sheet.size());
  std::vector<Vector<D>> mean(near);
#pragma omp parallel for schedule(dynamic, 64)
  for (Index a = 0; a < near; ++a) {
    const Index i = work.near_sheet[a];
    mean[a] = state.velocity[i];
    if (work.support[i] >= 1 || state.kind[i] != Kind::fluid) continue;
    Vector<D> sum = Vector<D>::Zero();
    double weights = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      sum += work.link_weight[k] * state.velocity[work.neighbors.index[k]];
      weights += work.link_weight[k];
    }
    if (weights > 0) mean[a] = work.support[i] * state.velocity[i] + (1 - work.support[i]) / weights * sum;
  }
  for (Index a = 0; a < near; ++a) state.velocity[work.near_sheet[a]] = mean[a];
}

#define INSTANTIATE(D)                                                           \
  template void cut_links(const Scene<D>&, const State<D>&, Workspace<D>&);      \
  template void wetted_sides(const Scene<D>&, const State<D>&, Workspace<D>&);   \
  template void remember_sides(const Scene<D>&, const State<D>&, Workspace<D>&); \
  template void stick_in_gaps(State<D>&, const Workspace<D>&);                   \
  template void keep_sides(const Scene<D>&, State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
