// The implicit step of solid_dynamics.h.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/solid_dynamics.h"

namespace sim {

namespace {

// One implicit problem: x = guess + s^2 a with M a = f(x, v), v = drift + s a, where s = d h is common to both stages of TR-BDF2.
template <int D>
class Stage {
 public:
  Stage(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion, double s, double time)
      : solid_(solid), input_(input), motion_(motion), s_(s), time_(time) {}

  // All forces on the rows at a position and velocity, with the added mass's reference.
  void forces(std::span<const Vector<D>> position, std::span<const Vector<D>> velocity, std::vector<Vector<D>>& force) {
    force.resize(solid_.size());
    solid_forces<D>(solid_, position, motion_.work, force);
    external_loads<D>(solid_, input_.loads, input_.gravity, time_, position, motion_.work, force);
    solid_damping<D>(solid_, velocity, force);
    for (std::size_t i = 0; i < solid_.size(); ++i) {
      if (!input_.external_force.empty()) force[i] += input_.external_force[i];
      if (!input_.added_mass.empty()) {
        const Vector<D>& normal = input_.added_direction[i];
        force[i] += input_.added_mass[i] * normal * normal.dot(input_.reference_acceleration[i]);
      }
    }
  }

  // M a of a row: mass and, along its direction, added mass.
  Vector<D> inertia(std::size_t i, const Vector<D>& acceleration) const {
    Vector<D> result = solid_.mass[i] * acceleration;
    if (!input_.added_mass.empty())
      result += input_.added_mass[i] * input_.added_direction[i] * input_.added_direction[i].dot(acceleration);
    return result;
  }

  Vector<D> acceleration(std::size_t i, Vector<D> force) const {
    Vector<D> direction = Vector<D>::Zero();
    const double added = input_.added_mass.empty() ? 0 : input_.added_mass[i];
    if (added > 0) direction = input_.added_direction[i];
    for (int k = 0; k < D; ++k)
      if (solid_.fixed[i] >> k & 1) force(k) = direction(k) = 0;
    return (force - direction * (added / (solid_.mass[i] + added * direction.squaredNorm()) * direction.dot(force))) / solid_.mass[i];
  }

  // Newton's method with a factor that is kept as long as it converges. Position is the first guess and the result; returns false where it
  // does not converge.
  bool solve(const std::vector<Vector<D>>& guess, const std::vector<Vector<D>>& drift, std::span<Vector<D>> position,
             std::span<Vector<D>> velocity, double extent, SolidStepReport& report) {
    bool fresh = false;
    if (motion_.factorised_for != s_)
      fresh = factorise(position, report);
    else if (motion_.factor_lost)
      factorise(std::vector<Vector<D>>(motion_.factorised_at), report);  // the run was continued
    double previous = 1e300;
    std::vector<Vector<D>> residual(solid_.size());
    for (int iteration = 0; iteration < 60; ++iteration) {
      for (std::size_t i = 0; i < solid_.size(); ++i) velocity[i] = drift[i] + (position[i] - guess[i]) / s_;
      forces(position, velocity, residual);
      double moved = 0;
      for (std::size_t i = 0; i < solid_.size(); ++i) {
        residual[i] = s_ * s_ * residual[i] - inertia(i, position[i] - guess[i]);
        moved = std::max(moved, (position[i] - guess[i]).template lpNorm<Eigen::Infinity>());
      }
      const Eigen::VectorXd step = motion_.solver.solve(gather<D>(*motion_.pattern, residual));
      if (!step.allFinite()) return false;
      ++report.newton_iterations;
      scatter_add<D>(*motion_.pattern, step, 1, position);
      const double change = step.template lpNorm<Eigen::Infinity>();
      if (change <= std::max({input_.tolerance * moved, 8e-16 * extent, 1e-13 * solid_.spacing})) {
        for (std::size_t i = 0; i < solid_.size(); ++i) velocity[i] = drift[i] + (position[i] - guess[i]) / s_;
        return true;
      }
      if (change > 2 * solid_.spacing && fresh) return false;
      if (change > 0.3 * previous || iteration % 12 == 11) {  // the factor has aged
        if (fresh && change > previous && iteration > 8) return false;
        fresh = factorise(position, report);
        previous = 1e300;
      } else {
        previous = change;
      }
    }
    return false;
  }

 private:
  // M (1 + damping s) + added mass + s^2 K at the position.
  bool factorise(std::span<const Vector<D>> position, SolidStepReport& report) {
    const SolidPattern<D>& pattern = *motion_.pattern;
    assemble_tangent<D>(solid_, pattern, position, motion_.work, motion_.matrix);
    motion_.matrix *= s_ * s_;
    for (std::size_t i = 0; i < solid_.size(); ++i) {
      Tensor<D> block = solid_.mass[i] * (1 + s_ * solid_.damping[i]) * Tensor<D>::Identity();
      if (!input_.added_mass.empty()) block += input_.added_mass[i] * input_.added_direction[i] * input_.added_direction[i].transpose();
      for (int k = 0; k < D; ++k)
        for (int m = 0; m <= k; ++m) {
          const std::int32_t row = pattern.dof[i * D + k], column = pattern.dof[i * D + m];
          if (row >= 0 && column >= 0) motion_.matrix.coeffRef(row, column) += block(k, m);
        }
    }
    ++report.factorisations;
    motion_.factorised_at.assign(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(solid_.size()));
    motion_.factor_lost = false;
    if (!motion_.solver.factorise(motion_.matrix)) throw std::runtime_error("implicit elastic step: the matrix M + s^2 K is singular");
    motion_.factorised_for = s_;
    return true;
  }

  const SolidElasticity<D>& solid_;
  const SolidStepInput<D>& input_;
  SolidMotion<D>& motion_;
  double s_, time_;
};

// The books of a step of size h from time t: work of loads and gravity, and what mass-proportional damping takes, by the trapezoidal rule.
template <int D>
void account_step(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion, double t, double h,
                  std::span<const Vector<D>> x0, std::span<const Vector<D>> v0, std::span<const Vector<D>> x1,
                  std::span<const Vector<D>> v1, SolidStepReport& report) {
  for (int end = 0; end < 2; ++end) {
    motion.other.assign(solid.size(), Vector<D>::Zero());
    external_loads<D>(solid, input.loads, input.gravity, t + end * h, end ? x1 : x0, motion.work, motion.other);
    for (std::size_t i = 0; i < solid.size(); ++i) report.load_work += 0.5 * motion.other[i].dot(x1[i] - x0[i]);
  }
  for (std::size_t i = 0; i < solid.size(); ++i)
    report.damping_loss += 0.5 * h * solid.damping[i] * solid.mass[i] * (v0[i].squaredNorm() + v1[i].squaredNorm());
}

// One TR-BDF2 step of size h from time t. False where a stage does not converge; position and velocity are then as before.
template <int D>
bool tr_bdf2(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion, double t, double h,
             std::span<Vector<D>> position, std::span<Vector<D>> velocity, SolidStepReport& report) {
  const std::size_t n = solid.size();
  const double gamma = 2 - std::sqrt(2.0), d = gamma / 2, s = d * h;
  double extent = 0;
  for (const Vector<D>& x : solid.rest) extent = std::max(extent, x.template lpNorm<Eigen::Infinity>());
  const std::vector<Vector<D>> x0(position.begin(), position.begin() + static_cast<std::ptrdiff_t>(n));
  const std::vector<Vector<D>> v0(velocity.begin(), velocity.begin() + static_cast<std::ptrdiff_t>(n));
  const auto undo = [&] {
    std::copy(x0.begin(), x0.end(), position.begin());
    std::copy(v0.begin(), v0.end(), velocity.begin());
    motion.factorised_for = 0;
    return false;
  };
  std::vector<Vector<D>> guess(n), drift(n), force;

  Stage<D> start(solid, input, motion, s, t);
  start.forces(x0, v0, force);
  Stage<D> trapezoid(solid, input, motion, s, t + gamma * h);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector<D> a0 = start.acceleration(i, force[i]);
    drift[i] = v0[i] + s * a0;
    guess[i] = x0[i] + 2 * s * v0[i] + s * s * a0;
    for (int k = 0; k < D; ++k)
      if (solid.fixed[i] >> k & 1) drift[i](k) = 0, guess[i](k) = x0[i](k);
    position[i] = x0[i];
  }
  if (!trapezoid.solve(guess, drift, position, velocity, extent, report)) return undo();

  const double c1 = 1 / (gamma * (2 - gamma)), c0 = (1 - gamma) * (1 - gamma) / (gamma * (2 - gamma));
  Stage<D> backward(solid, input, motion, s, t + h);
  for (std::size_t i = 0; i < n; ++i) {
    drift[i] = c1 * velocity[i] - c0 * v0[i];
    guess[i] = c1 * position[i] - c0 * x0[i] + s * drift[i];
    for (int k = 0; k < D; ++k)
      if (solid.fixed[i] >> k & 1) drift[i](k) = 0, guess[i](k) = x0[i](k);
  }
  if (!backward.solve(guess, drift, position, velocity, extent, report)) return undo();
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < D; ++k)
      if (solid.fixed[i] >> k & 1) velocity[i](k) = 0;
  ++report.substeps;
  account_step<D>(solid, input, motion, t, h, x0, v0, position, velocity, report);
  return true;
}

}  // namespace

template <int D>
SolidStepReport solid_implicit_step(const SolidElasticity<D>& solid, const SolidStepInput<D>& input, SolidMotion<D>& motion,
                                    std::span<Vector<D>> position, std::span<Vector<D>> velocity) {
  SolidStepReport report;
  report.implicit = true;
  if (!motion.pattern) motion.pattern = solid_pattern(solid);
  double done = 0, h = input.duration;
  while (done < input.duration * (1 - 1e-12)) {
    h = std::min(h, input.duration - done);
    if (tr_bdf2<D>(solid, input, motion, input.time + done, h, position, velocity, report)) {
      done += h;
      continue;
    }
    h /= 2;
    if (h < input.duration / 256)
      throw std::runtime_error("implicit elastic step did not converge at t = " + std::to_string(input.time + done) +
                               " s, even with a 256th of the step: the body is overloaded or moves too fast");
  }
  return report;
}

template SolidStepReport solid_implicit_step<2>(const SolidElasticity<2>&, const SolidStepInput<2>&, SolidMotion<2>&, std::span<Vector<2>>,
                                                std::span<Vector<2>>);
template SolidStepReport solid_implicit_step<3>(const SolidElasticity<3>&, const SolidStepInput<3>&, SolidMotion<3>&, std::span<Vector<3>>,
                                                std::span<Vector<3>>);

}  // namespace sim
