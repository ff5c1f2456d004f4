#include "sim/leaflet_coupling.h"

#include <algorithm>

namespace sim {
using Index = std::ptrdiff_t;

namespace {

// Share of scheme.resolved_mass that a step of dt bears: 1, and less where the leaflets' fastest waves pass more than 80 sub-steps in it.
// Last step's acceleration then lags so far behind the stiffest motions that it feeds them, as the square of their frequency times dt: a
// valve of 60 MPa (143 sub-steps) runs away with a share of 0.2/0.3 and is calm with 0.1/0.3; the default one (34 to 70) rests best with 1.
template <int D>
double resolved_share(const ShellElasticity<D>& shells, std::span<const Vector<D>> position, double dt) {
  constexpr double bearable = 80;
  const double substeps = dt / (0.95 * shell_time_step_limit<D>(shells, position));
  return substeps > bearable ? (bearable / substeps) * (bearable / substeps) : 1.0;
}

}  // namespace

template <int D>
ShellSubstepReport predict_leaflets(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const ShellElasticity<D>& shells = *scene.shells;
  const Index n = static_cast<Index>(scene.shell_count), first = static_cast<Index>(scene.elastic_count);
  auto rows = [&](const auto& v) { return std::span(v).subspan(first, n); };
  work.shell_position.assign(state.position.begin() + first, state.position.begin() + first + n);
  work.shell_velocity.assign(state.velocity.begin() + first, state.velocity.begin() + first + n);
  work.shell_normal.resize(n);
  work.shell_area.resize(n);
  shell_normals_and_areas<D>(shells, rows(state.position), work.shell_normal, work.shell_area);
  // outer forces that are not the blood's pressure: gravity, loads, the blood's drag
  work.shell_outer_force.assign(n, Vector<D>::Zero());
  add_shell_loads<D>(shells, scene.description.loads, state.time + dt, rows(state.position), work.shell_outer_force);
  if (scene.gravity)
    for (Index s = 0; s < n; ++s) work.shell_outer_force[s] += shells.mass[s] * scene.gravity->acceleration;
  if (!work.boundary_force.empty())
    for (Index s = 0; s < n; ++s) work.shell_outer_force[s] += work.boundary_force[first + s];
  std::vector<Vector<D>> external = work.shell_outer_force;
  std::vector<double> added(n);
  std::vector<Vector<D>> reference(n);
  double blood_density = 0;
  for (const auto& body : scene.description.bodies)
    if (body.kind == Kind::fluid) blood_density = std::max(blood_density, body.fluid.density);
  work.shell_normal_mass.resize(n);
  const double follow = scene.pressure ? scene.description.scheme.resolved_mass * resolved_share<D>(shells, rows(state.position), dt) : 0.0;
  for (Index s = 0; s < n; ++s) {
    external[s] += state.fluid_force[first + s];
    const double thickness = shells.bodies[shells.body[s]].thickness, l0 = scene.lattice.spacing;
    const double local = scene.description.scheme.added_mass * blood_density * work.shell_area[s] * std::max(l0 - thickness, 0.5 * l0);
    // Of the blood farther out a part is felt within the sub-steps, beyond last step's acceleration. It must not stand in the step's own
    // equation: there the difference to last step's acceleration would feed every oscillation, at the rate follows dt w^2 / (2 mass).
    const double wet = scene.pressure ? 0.5 * (work.wet_share[2 * s] + work.wet_share[2 * s + 1]) : 0.0;
    const double follows = follow * local * wet;
    added[s] = local + follows;
    reference[s] = local > 0 ? Vector<D>(follows / added[s] * state.fluid_acceleration[first + s]) : Vector<D>::Zero();
    work.shell_normal_mass[s] = shells.mass[s] + (scene.pressure ? local : 0.0);
  }
  work.shell_mean_force.resize(n);
  ShellSubstepInput<D> input;
  input.external_force = external;
  if (scene.pressure) {
    input.added_mass = added;
    input.added_normal = work.shell_normal;
    input.reference_acceleration = reference;
    input.relaxation = scene.description.scheme.leaflet_relaxation * dt;
  }
  input.duration = dt;
  const ShellSubstepReport report = shell_substeps<D>(shells, work.contact ? &*work.contact : nullptr, input, work.shell_position,
                                                      work.shell_velocity, work.shell_mean_force);
  work.shell_free_velocity.resize(n);
  for (Index s = 0; s < n; ++s) {
    const Vector<D> force = work.shell_mean_force[s] + work.shell_outer_force[s];
    const double along = force.dot(work.shell_normal[s]);
    Vector<D> v = state.velocity[first + s] +
                  dt * ((force - along * work.shell_normal[s]) / shells.mass[s] + along / work.shell_normal_mass[s] * work.shell_normal[s]);
    for (int k = 0; k < D; ++k)
      if (shells.fixed[s] >> k & 1) v[k] = 0;
    work.shell_free_velocity[s] = v;
  }
  return report;
}

namespace {

// Pressure on every face of the shells from the blood's, Pa.
template <int D>
std::vector<double> face_pressures(const Workspace<D>& work, std::span<const double> pressure) {
  const Index faces = static_cast<Index>(work.wet_start.size()) - 1;
  std::vector<double> face(static_cast<std::size_t>(faces), 0);
#pragma omp parallel for schedule(static) if (faces > 1000)
  for (Index a = 0; a < faces; ++a)
    for (std::int32_t k = work.wet_start[a]; k < work.wet_start[a + 1]; ++k)
      face[a] += work.wetting[k].weight * pressure[work.wetting[k].unknown];
  film_pressure(work.film, face);
  return face;
}

// Its transpose: adds volumes displaced at the faces to the blood's.
template <int D>
void displace_blood(const Workspace<D>& work, std::vector<double>& face, std::span<double> volume) {
  film_outflow(work.film, face);
  const Index wet = static_cast<Index>(work.wet_unknown.size());
#pragma omp parallel for schedule(static) if (wet > 1000)
  for (Index w = 0; w < wet; ++w) {
    double sum = 0;
    for (std::int32_t k = work.wet_unknown_start[w]; k < work.wet_unknown_start[w + 1]; ++k)
      sum += work.wet_faces[k].weight * face[work.wet_faces[k].face];
    volume[work.wet_unknown[w]] += sum;
  }
}

}  // namespace

template <int D>
void couple_leaflets(const Scene<D>& scene, const State<D>& state, Workspace<D>& work, double dt) {
  const ShellElasticity<D>& shells = *scene.shells;
  const Index n = static_cast<Index>(scene.shell_count), first = static_cast<Index>(scene.elastic_count);
  work.coupling.clear();
  std::vector<double> displaced(2 * n, 0);
  for (Index s = 0; s < n; ++s) {
    if (shells.fixed[s]) continue;
    const double area = work.shell_area[s];
    const double jump = (work.shell_free_velocity[s] - state.velocity[first + s]).dot(work.shell_normal[s]);
    work.coupling.push_back({static_cast<std::int32_t>(s), area * area / work.shell_normal_mass[s]});
    displaced[2 * s] = area * jump / dt;
    displaced[2 * s + 1] = -displaced[2 * s];
  }
  displace_blood<D>(work, displaced, work.source);
}

template <int D>
void apply_coupling(const Workspace<D>& work, std::span<const double> x, std::span<double> y) {
  if (work.coupling.empty()) return;
  std::vector<double> face = face_pressures<D>(work, x), moved(face.size(), 0);
  for (const auto& c : work.coupling) {
    moved[2 * c.shell] = c.strength * (face[2 * c.shell] - face[2 * c.shell + 1]);
    moved[2 * c.shell + 1] = -moved[2 * c.shell];
  }
  displace_blood<D>(work, moved, y);
}

template <int D>
void link_sides(const Workspace<D>& work, SymmetricMatrix& a) {
  constexpr std::size_t strongest = 4;  // links a side that stand for all
  struct Entry {
    std::int32_t row, column;
    double value;
  };
  std::vector<Entry> entries;
  const Index rows = static_cast<Index>(work.matrix.rows());
  a.diagonal.assign(static_cast<std::size_t>(rows), 0);
  a.start.assign(static_cast<std::size_t>(rows) + 1, 0);
  std::vector<typename Workspace<D>::WetLink> side[2];
  for (const auto& c : work.coupling) {
    if (work.wet_share[2 * c.shell] < 0.5 || work.wet_share[2 * c.shell + 1] < 0.5) continue;
    for (int k = 0; k < 2; ++k) {
      auto& s = side[k];
      s.assign(work.wetting.begin() + work.wet_start[2 * c.shell + k], work.wetting.begin() + work.wet_start[2 * c.shell + k + 1]);
      const auto last = s.begin() + static_cast<Index>(std::min(strongest, s.size()));
      std::partial_sort(s.begin(), last, s.end(), [](const auto& p, const auto& q) {
        return p.weight > q.weight || (p.weight == q.weight && p.unknown < q.unknown);
      });
      s.erase(last, s.end());
      double sum = 0;
      for (const auto& link : s) sum += link.weight;
      for (auto& link : s) link.weight /= sum;
    }
    for (const auto& p : side[0])
      for (const auto& q : side[1]) {
        if (p.unknown == q.unknown) continue;
        const double v = c.strength * p.weight * q.weight;
        entries.push_back({p.unknown, q.unknown, -v});
        entries.push_back({q.unknown, p.unknown, -v});
        a.diagonal[p.unknown] += v;
        a.diagonal[q.unknown] += v;
        ++a.start[p.unknown + 1], ++a.start[q.unknown + 1];
      }
  }
  for (Index u = 0; u < rows; ++u) a.start[u + 1] += a.start[u];
  a.column.resize(entries.size()), a.value.resize(entries.size());
  std::vector<std::int64_t> next(a.start.begin(), a.start.end() - 1);
  for (const Entry& entry : entries) {
    const std::int64_t to = next[entry.row]++;
    a.column[to] = entry.column;
    a.value[to] = entry.value;
  }
}

template <int D>
void correct_leaflets(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt) {
  const ShellElasticity<D>& shells = *scene.shells;
  const Index n = static_cast<Index>(scene.shell_count), first = static_cast<Index>(scene.elastic_count);
  const std::vector<double> face = face_pressures<D>(work, work.solution);
  for (Index s = 0; s < n; ++s) {
    const double p_plus = face[2 * s], p_minus = face[2 * s + 1];
    state.pressure_plus[s] = p_plus;
    state.pressure_minus[s] = p_minus;
    state.pressure[first + s] = 0.5 * (p_plus + p_minus);
    const Vector<D> force = -work.shell_area[s] * (p_plus - p_minus) * work.shell_normal[s];
    state.fluid_force[first + s] = force;
    Vector<D> v = work.shell_free_velocity[s] + dt / work.shell_normal_mass[s] * force;
    for (int k = 0; k < D; ++k)
      if (shells.fixed[s] >> k & 1) v[k] = 0;
    state.fluid_acceleration[first + s] = (v - state.velocity[first + s]) / dt;
    state.position[first + s] = work.shell_position[s];
    state.velocity[first + s] = v;
  }
}

#define INSTANTIATE(D)                                                                                   \
  template ShellSubstepReport predict_leaflets(const Scene<D>&, const State<D>&, Workspace<D>&, double); \
  template void couple_leaflets(const Scene<D>&, const State<D>&, Workspace<D>&, double);                \
  template void apply_coupling(const Workspace<D>&, std::span<const double>, std::span<double>);         \
  template void link_sides(const Workspace<D>&, SymmetricMatrix&);                                       \
  template void correct_leaflets(const Scene<D>&, State<D>&, Workspace<D>&, double);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
