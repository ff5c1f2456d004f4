#include "sim/solid_dynamics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sim {

namespace {

// dv of one row: (m I + m_e N N^T)^-1 f, on the free axes (Sherman & Morrison).
template <int D>
Vector<D> acceleration_of(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, std::size_t i, Vector<D> force) {
  Vector<D> direction = Vector<D>::Zero();
  double added = 0;
  if (!input.added_mass.empty()) {
    added = input.added_mass[i];
    direction = input.added_direction[i];
    force += added * direction * direction.dot(input.reference_acceleration[i]);
  }
  for (int k = 0; k < D; ++k)
    if (solid.fixed[i] >> k & 1) force(k) = direction(k) = 0;
  const double mass = solid.mass[i];
  return (force - direction * (added / (mass + added * direction.squaredNorm()) * direction.dot(force))) / mass;
}

}  // namespace

template <int D>
SolidStepReport solid_substeps(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, std::int64_t substeps,
                               SolidMotion<D>& motion, std::span<Vector<D>> position, std::span<Vector<D>> velocity) {
  SolidStepReport report;
  report.substeps = substeps;
  const auto n = static_cast<std::int64_t>(solid.size());
  motion.force.resize(n);
  motion.other.resize(n);
  const double step = input.duration / static_cast<double>(substeps);
  for (std::int64_t s = 0; s < substeps; ++s) {
    solid_forces<D>(solid, position, motion.work, motion.force);
    std::fill(motion.other.begin(), motion.other.end(), Vector<D>::Zero());
    external_loads<D>(solid, input.loads, input.gravity, input.time + (static_cast<double>(s) + 0.5) * step, position, motion.work,
                      motion.other);
    // Symplectic Euler; damping implicit within the row, so that any coefficient is stable.
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) {
      Vector<D> force = motion.force[i] + motion.other[i];
      if (!input.external_force.empty()) force += input.external_force[i];
      velocity[i] += step * acceleration_of<D>(solid, input, i, force);
      velocity[i] /= 1 + step * solid.damping[i];
      for (int k = 0; k < D; ++k)
        if (solid.fixed[i] >> k & 1) velocity[i](k) = 0;
      position[i] += step * velocity[i];
    }
    for (std::int64_t i = 0; i < n; ++i) {
      report.load_work += step * motion.other[i].dot(velocity[i]);
      report.damping_loss += step * solid.damping[i] * solid.mass[i] * velocity[i].squaredNorm();
    }
  }
  return report;
}

template <int D>
SolidStepReport advance_solids(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion,
                               std::span<Vector<D>> position, std::span<Vector<D>> velocity, std::span<Vector<D>> mean_force) {
  SolidStepReport report;
  if (solid.size() == 0 || !(input.duration > 0)) return report;
  const std::vector<Vector<D>> before(velocity.begin(), velocity.begin() + static_cast<std::ptrdiff_t>(solid.size()));
  const double limit = solid_time_step_limit<D>(solid, position, input.substep_factor);
  const double wanted = std::ceil(input.duration / limit * (1 - 1e-12));
  if (wanted <= std::max(input.explicit_limit, 0)) {
    report = solid_substeps<D>(solid, input, std::max<std::int64_t>(1, static_cast<std::int64_t>(wanted)), motion, position, velocity);
  } else {
    report = solid_implicit_step<D>(solid, input, motion, position, velocity);
  }
  for (std::size_t i = 0; i < mean_force.size(); ++i) {
    const Vector<D> change = (velocity[i] - before[i]) / input.duration;
    mean_force[i] = solid.mass[i] * change;
    if (!input.external_force.empty()) mean_force[i] -= input.external_force[i];
    if (!input.added_mass.empty()) {
      const Vector<D>& normal = input.added_direction[i];
      mean_force[i] += input.added_mass[i] * normal * normal.dot(change - input.reference_acceleration[i]);
    }
    for (int k = 0; k < D; ++k)
      if (solid.fixed[i] >> k & 1) mean_force[i](k) = 0;
  }
  return report;
}

template <int D>
void SolidOperator<D>::factorise(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, double c) {
  if (!pattern_) pattern_ = solid_pattern(solid);
  assemble_tangent<D>(solid, *pattern_, position, work_, matrix_);
  matrix_ *= c;
  add_to_diagonal<D>(*pattern_, solid.mass, 1, matrix_);
  factorised_at_.assign(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(solid.size()));
  factorised_for_ = c;
  if (!solver_.factorise(matrix_)) throw std::runtime_error("elastic operator M + c K could not be factorised");
}

template <int D>
void SolidOperator<D>::solve(std::span<const Vector<D>> rhs, std::span<Vector<D>> solution) const {
  std::fill(solution.begin(), solution.end(), Vector<D>::Zero());
  scatter_add<D>(*pattern_, solver_.solve(gather<D>(*pattern_, rhs)), 1, solution);
}

#define SIM_INSTANTIATE(D)                                                                                                               \
  template SolidStepReport solid_substeps<D>(const SolidElasticity<D>&, const SolidStepInput<D>&, std::int64_t, SolidMotion<D>&,         \
                                             std::span<Vector<D>>, std::span<Vector<D>>);                                                \
  template SolidStepReport advance_solids<D>(const SolidElasticity<D>&, const SolidStepInput<D>&, SolidMotion<D>&, std::span<Vector<D>>, \
                                             std::span<Vector<D>>, std::span<Vector<D>>);                                                \
  template class SolidOperator<D>;
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
