#include "sim/number_density.h"

#include <algorithm>

namespace sim {
using Index = std::ptrdiff_t;

template <int D>
void link_weights(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.link_weight.resize(work.neighbors.index.size());
  const double radius = scene.lattice.radius, closest = scene.lattice.closest();
  work.position.resize(n);
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < n; ++i) work.position[i] = pad<D>(state.position[i]);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = 0; i < n; ++i)
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const double r = scene.space.difference(work.position[i], work.position[j]).norm();
      work.link_weight[k] = weight(r, radius, closest) * (j < scene.first_fluid ? scene.measure[j] : 1.0);
    }
}

template <int D>
void particle_number_density(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.number_density.assign(n, 1.0);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = scene.first_fluid; i < n; ++i) {
    double sum = 0;
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) sum += work.link_weight[k];
    work.number_density[i] = sum / scene.lattice.number_density;
  }
}

namespace {

// Whether something lies ahead of particle i: within 1.8 l0 and 45 degrees of the direction `outward`.
template <int D>
bool covered(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, Index i, const Vector<D>& outward) {
  const double reach = 1.8 * scene.lattice.spacing;
  for (std::int32_t j : work.neighbors.of(i)) {
    const Vector<D> r = scene.space.difference(state.position[i], state.position[j]);
    const double distance = r.norm();
    if (distance < reach && r.dot(outward) > 0.7071 * distance) return true;
  }
  return false;
}

}  // namespace

template <int D>
void find_free_surface(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.surface.assign(n, 0);
  work.surface_outward.assign(n, Vector<D>::Zero());
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (state.kind[i] != Kind::fluid || work.number_density[i] >= 0.97) continue;
    Vector<D> directions = Vector<D>::Zero(), moment = Vector<D>::Zero();
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const Vector<D> r = scene.space.difference(state.position[i], state.position[work.neighbors.index[k]]);
      directions -= work.link_weight[k] / std::max(r.norm(), 1e-300) * r;
      if (work.neighbors.index[k] >= scene.first_fluid) moment -= work.link_weight[k] * r;
    }
    const double size = directions.norm();
    const bool sparse = work.number_density[i] < 0.5;
    const bool open = work.number_density[i] < 0.8 && size > 0.2 * scene.lattice.number_density;
    if (!sparse && !open && (size < 0.12 * scene.lattice.number_density || covered<D>(scene, state, work, i, directions / size))) continue;
    work.surface[i] = 1;
    if (size > 0) work.surface_outward[i] = std::max(moment.dot(directions) / size, 0.0) / size * directions;
  }
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = scene.first_fluid; i < n; ++i) {
    if (work.surface[i]) continue;
    for (std::int32_t j : work.neighbors.of(i))
      if (work.surface[j] == 1) {
        work.surface[i] = 2;
        break;
      }
  }
}

namespace {

// Whether the way from x_i to x_j leads through a particle of a thin wall near particle `owner`: through its plane, within 0.75 l0 of it.
template <int D>
bool through_thin_wall(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work, std::int32_t owner, std::int32_t other) {
  const double beside = 0.75 * scene.lattice.spacing;
  const Vector<D> way = scene.space.difference(state.position[owner], state.position[other]);
  for (std::int32_t b : work.neighbors.of(static_cast<std::size_t>(owner))) {
    if (b >= scene.first_fluid || !(scene.back_depth[b] > 0)) continue;
    const Vector<D> r = scene.space.difference(state.position[owner], state.position[b]);
    const Vector<D>& normal = work.boundary_normal[b];
    const double here = -r.dot(normal), there = (way - r).dot(normal);
    if (here * there >= 0) continue;
    const Vector<D> crossing = way * (here / (here - there));
    if ((crossing - r).norm() < beside) return true;
  }
  return false;
}

}  // namespace

template <int D>
void cut_links_through_walls(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  if (std::none_of(scene.back_depth.begin(), scene.back_depth.end(), [](double depth) { return depth > 0; })) return;
  const Index n = static_cast<Index>(state.size());
  std::vector<std::uint8_t> beside_thin(n, 0);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = scene.first_fluid; i < n; ++i)
    for (std::int32_t b : work.neighbors.of(static_cast<std::size_t>(i)))
      if (b < scene.first_fluid && scene.back_depth[b] > 0) beside_thin[i] = 1;
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = scene.first_fluid; i < n; ++i)
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k], me = static_cast<std::int32_t>(i),
                         owner = std::min(me, j);  // the same for i-j and j-i
      if (j < scene.first_fluid || !beside_thin[owner]) continue;
      if (through_thin_wall(scene, state, work, owner, std::max(me, j))) work.link_weight[k] = 0;
    }
}

template <int D>
std::int64_t count_open_surface(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work) {
  const double l0 = scene.description.spacing;
  std::int64_t count = 0;
  for (Index i = scene.first_fluid; i < static_cast<Index>(state.size()); ++i) {
    if (work.surface[i] != 1) continue;
    const double size = work.surface_outward[i].norm();
    bool open = true;
    if (size > 0) {
      const Vector<D> ahead = 1.4 * l0 / size * work.surface_outward[i];
      for (std::int32_t j : work.neighbors.of(i))
        open = open && (scene.space.difference(state.position[i], state.position[j]) - ahead).norm() > 0.7 * l0;
    }
    count += open;
  }
  return count;
}

#define INSTANTIATE(D)                                                                             \
  template void cut_links_through_walls(const Scene<D>&, const State<D>&, Workspace<D>&);          \
  template std::int64_t count_open_surface(const Scene<D>&, const State<D>&, const Workspace<D>&); \
  template void link_weights(const Scene<D>&, const State<D>&, Workspace<D>&);                     \
  template void particle_number_density(const Scene<D>&, const State<D>&, Workspace<D>&);          \
  template void find_free_surface(const Scene<D>&, const State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
