// Probes in space: velocity, pressure and density of the fluid, and of the wall where the point lies on or in one.
#include <algorithm>
#include <cmath>

#include "sim/number_density.h"
#include "sim/operators.h"
#include "sim/point_fit.h"
#include "sim/probe_moment.h"
#include "sim/quadratic_fit.h"
#include "sim/step.h"
#include "sim/walls.h"

namespace sim {

template <int D>
const std::vector<Eigen::Matrix3d>& ProbeMoment<D>::stress() {
  if (!stress_) stress_ = elastic_stress(scene_, state_);
  return *stress_;
}
template <int D>
const ShellStress& ProbeMoment<D>::faces() {
  if (!faces_) faces_ = faces_stress(scene_, state_);
  return *faces_;
}
template <int D>
const std::vector<double>& ProbeMoment<D>::volume() {
  if (!volume_) volume_ = volume_ratio(scene_, state_);
  return *volume_;
}

template <int D>
const SolidWork<D>& ProbeMoment<D>::solid_work() {
  if (!solid_work_) {
    solid_work_.emplace();
    solid_derivatives(*scene_.solids, std::span<const Vector<D>>(state_.position).first(scene_.solids->size()), *solid_work_);
  }
  return *solid_work_;
}

template <int D>
void ProbeMoment<D>::prepare_space() {
  if (grid_) return;
  find_neighborhood(scene_, state_, work_);  // boundary normals and velocities, number density, free surface
  grid_.emplace(std::span<const Vector<D>>(state_.position), 1.05 * scene_.description.spacing);
}

// Samples around x, periodic images included: fluid particles on x's side of every leaflet, and the boundary's outermost layer.
template <int D>
typename ProbeMoment<D>::Near ProbeMoment<D>::near(const Vector<D>& x, std::int32_t body, double radius) {
  prepare_space();
  const double l0 = scene_.description.spacing;
  Near found;
  found.fluid_distance = found.wall_distance = 1e300;
  double nearest_surface = 1e300;
  std::vector<std::int32_t> shells;
  std::vector<Vector<D>> places{x};
  for (int axis = 0; axis < D; ++axis) {
    if (!(scene_.space.length[axis] > 0)) continue;
    const std::size_t known = places.size();
    for (std::size_t k = 0; k < known; ++k)
      for (int side : {-1, 1}) places.push_back(places[k] + side * scene_.space.length[axis] * Vector<D>::Unit(axis));
  }
  for (const Vector<D>& place : places)
    grid_->for_each_near(place, radius, [&](std::int32_t row, double squared) {
      const Vector<D> offset = state_.position[row] - place;
      if (row >= scene_.first_fluid) {
        if (body >= 0 && state_.body[row] != body) return;
        found.fluid.push_back(row);
        found.fluid_offset.push_back(offset);
        found.fluid_distance = std::min(found.fluid_distance, std::sqrt(squared));
        return;
      }
      if (state_.kind[row] == Kind::shell) shells.push_back(row);
      const double depth = scene_.description.particles.depth[row];
      if (depth > 0.8 * l0) return;
      const Vector<D> normal = work_.boundary_normal[row];
      const Vector<D> surface = offset + depth * normal;
      found.boundary.push_back(row);
      found.surface_offset.push_back(surface);
      if (surface.norm() < nearest_surface) {
        nearest_surface = surface.norm();
        found.wall = row, found.wall_distance = -surface.dot(normal), found.wall_normal = normal;
      }
    });
  if (!shells.empty()) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < found.fluid.size(); ++k) {
      if (behind_shell(x, x + found.fluid_offset[k], shells)) continue;
      found.fluid[kept] = found.fluid[k], found.fluid_offset[kept] = found.fluid_offset[k];
      ++kept;
    }
    found.fluid.resize(kept), found.fluid_offset.resize(kept);
  }
  return found;
}

template <int D>
bool ProbeMoment<D>::behind_shell(const Vector<D>& x, const Vector<D>& sample, const std::vector<std::int32_t>& shells) const {
  for (std::int32_t row : shells) {
    const Vector<D>& n = work_.boundary_normal[row];
    const double here = (x - state_.position[row]).dot(n), there = (sample - state_.position[row]).dot(n);
    if (here * there >= 0) continue;
    const Vector<D> crossing = x + (here / (here - there)) * (sample - x) - state_.position[row];
    if (crossing.norm() < 0.8 * scene_.description.spacing) return true;
  }
  return false;
}

template <int D>
bool ProbeMoment<D>::in_wall(const Near& around) const {
  const double l0 = scene_.description.spacing;
  if (around.wall < 0) return false;
  if (state_.kind[around.wall] == Kind::shell) return std::abs(around.wall_distance) < 1e-6 * l0;
  return around.wall_distance <= 1e-6 * l0 && around.fluid_distance > 0.3 * l0;
}

// How far to look, in l0, before giving up; the first reach with enough samples is used.
static constexpr double reaches[] = {2.1, 3.1, 4.6};

template <int D>
Vector<D> ProbeMoment<D>::velocity_at(const Vector<D>& x, std::int32_t body) {
  const double l0 = scene_.description.spacing;
  for (double reach : reaches) {
    const double radius = reach * l0;
    const Near around = near(x, body, radius);
    if (in_wall(around)) return work_.boundary_velocity[around.wall];
    std::vector<Vector<D>> offset = around.fluid_offset;
    if (offset.size() < 2 * D) continue;
    offset.insert(offset.end(), around.surface_offset.begin(), around.surface_offset.end());
    const std::vector<double> weight = fit_weights<D>(offset, radius, offset.size() >= 4 * D);
    Vector<D> value = Vector<D>::Zero();
    for (std::size_t k = 0; k < weight.size(); ++k)
      value += weight[k] * (k < around.fluid.size() ? state_.velocity[around.fluid[k]]
                                                    : work_.boundary_velocity[around.boundary[k - around.fluid.size()]]);
    return value;
  }
  const Near around = near(x, -1, 2.1 * l0);
  if (!around.fluid.empty()) return state_.velocity[around.fluid.front()];
  return around.wall >= 0 ? work_.boundary_velocity[around.wall] : Vector<D>::Zero();
}

template <int D>
double ProbeMoment<D>::pressure_at(const Vector<D>& x, std::int32_t body) {
  const double l0 = scene_.description.spacing;
  for (double reach : reaches) {
    const double radius = reach * l0;
    Near around = near(x, body, radius);
    const bool inside_wall = in_wall(around);
    if (around.fluid.size() < 2 * D) continue;
    std::vector<Vector<D>> offset = around.fluid_offset;
    if (inside_wall)  // the wall's value is the fluid's at its surface
      for (Vector<D>& one : offset) one += around.wall_distance * around.wall_normal;
    Vector<D> center = Vector<D>::Zero();
    for (const Vector<D>& one : offset) center += one / static_cast<double>(offset.size());
    const bool surrounded = center.norm() < 0.2 * radius;
    const std::vector<double> weight = fit_weights<D>(offset, radius, surrounded && offset.size() >= 4 * D);
    double value = 0;
    for (std::size_t k = 0; k < weight.size(); ++k) value += weight[k] * state_.pressure[around.fluid[k]];
    const bool outside = !surrounded && !inside_wall && around.fluid_distance > 0.8 * l0 && std::abs(around.wall_distance) > l0;
    return outside ? 0 : value;  // beyond a free surface
  }
  const Near around = near(x, -1, 2.1 * l0);
  if (!around.fluid.empty()) return state_.pressure[around.fluid.front()];
  return around.wall >= 0 && in_wall(around) ? state_.pressure[around.wall] : 0;
}

template <int D>
double ProbeMoment<D>::density_at(const Vector<D>& x, std::int32_t body) {
  const double l0 = scene_.description.spacing;
  const Near around = near(x, body, 2.1 * l0);
  if (around.fluid.empty() || (around.fluid_distance > 1.2 * l0 && !in_wall(around))) return 0;
  const std::vector<double> weight = fit_weights<D>(around.fluid_offset, 2.1 * l0, false);
  double value = 0;
  for (std::size_t k = 0; k < weight.size(); ++k) {
    const std::int32_t row = around.fluid[k];
    const double ratio = work_.surface[row] ? 1 : work_.number_density[row];
    value += weight[k] * ratio * scene_.density[state_.body[row]];
  }
  return value;
}

// By how much the mean of v.n over a particle's cell differs from its value at the particle, m/s: l0²/24 times the Laplacian of v.n across
// the normal. Where the scheme takes a particle's velocity for its cell's mean (leaflets, inviscid fluid) or no fit holds: 0.
template <int D>
double ProbeMoment<D>::cell_mean_excess(std::int32_t row, const Vector<D>& normal) const {
  if (!scene_.viscosity || !scene_.viscosity->corrected || state_.kind[row] != Kind::fluid || work_.surface[row] != 0) return 0;
  const double l0 = scene_.description.spacing;
  LaplacianFit<D> fit;
  std::vector<Vector<D>> place;
  std::vector<double> jump, link;
  double kinematic = -1;
  for (std::int64_t k = work_.neighbors.start[row]; k < work_.neighbors.start[row + 1]; ++k) {
    const std::int32_t j = work_.neighbors.index[k];
    if (work_.link_weight[k] == 0) continue;
    const Vector<D> r = scene_.space.difference(state_.position[row], state_.position[j]);
    const bool fluid = j >= scene_.first_fluid;
    const Vector<D> step = (fluid ? state_.velocity[j] : work_.boundary_velocity[j]) - state_.velocity[row];
    place.push_back((fluid ? 1.0 : fluid_fraction(scene_, work_, r, j)) / l0 * r);
    jump.push_back((fluid ? step : resolved_jump<D>(scene_, state_.body[row], step, work_.boundary_normal[j], kinematic)).dot(normal));
    link.push_back(work_.link_weight[k]);
    fit.add(place.back(), link.back());
  }
  if (!fit.solve(Tensor<D>::Identity() - normal * normal.transpose())) return 0;
  double sum = 0;
  for (std::size_t k = 0; k < place.size(); ++k) sum += fit.weight(place[k], link[k]) * jump[k];
  return sum / 24;
}

// Q = sum V <v.n> W(d) over the fluid near the plane, W a hat of half-width 2 l0: exact for any offset of a regular row of particles.
// <v.n> is the mean over a particle's cell: with the value at its centre alone the parabola in a pipe of 5 particles along the radius would
// carry 1.3 % too much.
template <int D>
double ProbeMoment<D>::flow_through(const Probe<D>& probe) {
  prepare_space();
  const double half_width = 2 * scene_.description.spacing;
  double flow = 0;
  for (std::size_t row = static_cast<std::size_t>(scene_.first_fluid); row < state_.size(); ++row) {
    if (probe.body >= 0 && state_.body[row] != probe.body) continue;
    const Vector<D> from = scene_.space.difference(probe.plane_point, state_.position[row]);
    const double height = from.dot(probe.plane_normal);
    if (std::abs(height) >= half_width || (from - height * probe.plane_normal).norm() > probe.plane_radius) continue;
    const double speed =
        state_.velocity[row].dot(probe.plane_normal) + cell_mean_excess(static_cast<std::int32_t>(row), probe.plane_normal);
    flow += scene_.fluid_particle_volume * speed * (1 - std::abs(height) / half_width) / half_width;
  }
  return flow;
}

template class ProbeMoment<2>;
template class ProbeMoment<3>;

}  // namespace sim
