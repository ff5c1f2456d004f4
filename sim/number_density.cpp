#include "sim/number_density.h"

namespace sim {
using Index = std::ptrdiff_t;

template <int D>
void link_weights(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const Index n = static_cast<Index>(state.size());
  work.link_weight.resize(work.neighbors.index.size());
  const double radius = scene.lattice.radius, closest = scene.lattice.closest();
#pragma omp parallel for schedule(dynamic, 512)
  for (Index i = 0; i < n; ++i)
    for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
      const std::int32_t j = work.neighbors.index[k];
      const double r = scene.space.difference(state.position[i], state.position[j]).norm();
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

#define INSTANTIATE(D)                                                                    \
  template void link_weights(const Scene<D>&, const State<D>&, Workspace<D>&);            \
  template void particle_number_density(const Scene<D>&, const State<D>&, Workspace<D>&); \
  template void find_free_surface(const Scene<D>&, const State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
