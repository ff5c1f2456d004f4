#include "sim/sides.h"

#include <algorithm>
#include <cmath>

#include "sim/near_elements.h"

namespace sim {
using Index = std::ptrdiff_t;

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
        if (count == 0) continue;
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
    Vector<D> point = Vector<D>::Zero(), normal = Vector<D>::Zero(), velocity = Vector<D>::Zero();
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
