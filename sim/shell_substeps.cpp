// Explicit symplectic sub-steps of the shells within one step of the blood (numerics-coupling.md section 6, point 3).
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/contact_kernel.h"
#include "sim/shell_kernel.h"

namespace sim {

using namespace shell_kernel;

namespace {

constexpr int chunk = 16;  // sub-steps between looks at how far the contact search still holds
// Sub-steps: the longest relaxation time that they take. Symplectic Euler with K (x + tau v) is stable for (h w)^2 (1 + 2 tau / h) <= 4;
// along the normal, where the blood's mass moves too, (h w)^2 stays below 0.44.
constexpr double most_relaxation = 4;

template <int D>
struct Workspace {
  std::vector<Padded<D>> x, v, next_x, next_v, own, normal, mean;
  std::vector<Padded<D>> ahead;  // where x will be a relaxation time later by its speed along the normal: elastic forces are taken there
  std::vector<std::array<Padded<D>, terms<D>>> derivative;
  std::vector<std::uint8_t> limited;
  std::vector<Padded<D>> outer, axis;  // the input's external force and added normal; empty where it has none
  std::vector<double> pull;            // N, m_e N . a^n

  Workspace(const ShellElasticity<D>& shells, const ShellSubstepInput<D>& input, std::span<const Vector<D>> position,
            std::span<const Vector<D>> velocity)
      : x(shells.size()),
        v(shells.size()),
        own(shells.size()),
        normal(shells.size()),
        mean(shells.size(), Padded<D>::Zero()),
        derivative(shells.size()),
        limited(shells.size(), 0) {
    for (const Vector<D>& force : input.external_force) outer.push_back(pad<D>(force));
    for (const Vector<D>& n : input.added_normal) axis.push_back(pad<D>(n));
    for (std::size_t i = 0; i < input.added_mass.size(); ++i)
      pull.push_back(input.added_mass[i] > 0 ? input.added_mass[i] * input.added_normal[i].dot(input.reference_acceleration[i]) : 0.0);
    for (std::size_t i = 0; i < shells.size(); ++i) {
      x[i] = pad<D>(position[i]);
      v[i] = pad<D>(velocity[i]);
      for (int k = 0; k < D; ++k)
        if (shells.fixed[i] >> k & 1) v[i][k] = 0;
    }
    next_x = x;
    next_v = v;
    ahead = x;
  }
};

// One row's part of a sub-step: (m I + m_e N N^T) dV = [f_el + f_contact + F + m_e N (N . a^n) - m d V] dt; then the position with the new
// velocity.
template <int D>
void advance(const ShellElasticity<D>& shells, const Contact<D>* contact, const ShellSubstepInput<D>& input, Workspace<D>& work,
             std::int32_t i, double dt, double relaxation) {
  if (is_clamped(shells, i)) return;
  Padded<D> force = work.own[i] + gather_force(shells, work.derivative.data(), i);
  if (contact) force += contact_kernel::gather_contact(*contact, i);
  work.mean[i] += dt * force;  // sub-steps differ in length
  const double mass = shells.mass[i], damping = shells.bodies[shells.body[i]].damping;
  if (!work.outer.empty()) force += work.outer[i];
  force -= (mass * damping) * work.v[i];
  Padded<D> change = force * (dt / mass);
  if (!work.pull.empty() && input.added_mass[i] > 0) {
    const Padded<D>& n = work.axis[i];
    const double extra = input.added_mass[i];
    change += n * (work.pull[i] * dt / mass);
    change -= n * (n.dot(change) * extra / (mass + extra));
  }
  Padded<D> v = work.v[i] + change;
  if (shells.fixed[i])
    for (int k = 0; k < D; ++k)
      if (shells.fixed[i] >> k & 1) v[k] = 0;
  work.next_v[i] = v;
  work.next_x[i] = work.x[i] + v * dt;
  work.ahead[i] = work.next_x[i];
  if (relaxation > 0 && !work.axis.empty()) work.ahead[i] += (relaxation * work.axis[i].dot(v)) * work.axis[i];
}

// Largest ratio by which the added mass slows the bending dashpot down: it is scaled for the heavier rows.
template <int D>
double lightest_share(const ShellElasticity<D>& shells, const ShellSubstepInput<D>& input) {
  double least = 1e300;
  for (std::size_t i = 0; i < shells.size(); ++i) least = std::min(least, 1 + input.added_mass[i] / shells.mass[i]);
  return least;
}

// Largest sub-step that the explicit axial dashpot allows, s: half its stability limit 2 over the highest rate, which a wave with the
// signs of neighbours alternating dies out at; by Gershgorin twice a row's sum over its bonds, of which a sheet's point half across a wave.
// In a sheet of many millimetres' spacing it is the dashpot that limits the sub-step.
template <int D>
double dashpot_step_limit(const ShellElasticity<D>& shells) {
  double largest = 0;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    double sum = 0;
    for (std::int32_t p = shells.bond_start[i]; p < shells.bond_start[i + 1]; ++p) sum += shells.bond_mass[p];
    largest = std::max(largest, shells.axial_dashpot * sum / shells.mass[i]);
  }
  return largest > 0 ? (D == 2 ? 0.5 : 0.7) / largest : 1e300;
}

}  // namespace

template <int D>
ShellSubstepReport shell_substeps(const ShellElasticity<D>& shells, Contact<D>* contact, const ShellSubstepInput<D>& input,
                                  std::span<Vector<D>> position, std::span<Vector<D>> velocity, std::span<Vector<D>> mean_force) {
  ShellSubstepReport report;
  if (shells.empty() || input.duration <= 0) return report;
  if (shells.substep_factor > 0.5) throw std::invalid_argument("scheme.elastic_substep above 0.5 of l0/c is unstable; use 0.35");
  const auto rows = static_cast<std::int32_t>(shells.size());
  Workspace<D> work(shells, input, position, velocity);
  double left = input.duration;
  const double dashpot_limit = dashpot_step_limit(shells);
  while (left > 1e-9 * input.duration) {
    // Equal sub-steps; the limit is renewed each chunk, 5 % below what the present stretch allows.
    double limit = 0.95 * shell_time_step_limit<D>(shells, position);
    limit = std::min(limit, dashpot_limit);
    if (shells.bending_dashpot > 0 && !input.added_mass.empty())
      limit = std::min(limit, 0.4 * lightest_share(shells, input) / shells.bending_dashpot);
    const auto wanted = static_cast<std::int64_t>(std::ceil(left / limit - 1e-9));
    const int count = static_cast<int>(std::min<std::int64_t>(chunk, std::max<std::int64_t>(wanted, 1)));
    const double dt = left / static_cast<double>(std::max<std::int64_t>(wanted, 1));
    const double relaxation = std::min(input.relaxation, most_relaxation * dt);
    if (contact) update_contact_search<D>(*contact, shells, position);
    const auto contact_rows = contact ? static_cast<std::int32_t>(contact->rows.size()) : 0;
#pragma omp parallel if (rows > 200)
    for (int step = 0; step < count; ++step) {
#pragma omp for schedule(static)
      for (std::int32_t i = 0; i < rows; ++i)
        work.limited[i] |= differentiate_row(shells, work.ahead.data(), work.v.data(), i, work.derivative[i], work.own[i], work.normal[i]);
      if (contact_rows > 0) {
#pragma omp for schedule(static)
        for (std::int32_t r = 0; r < contact_rows; ++r)
          contact_kernel::evaluate_row(*contact, shells, work.x.data(), work.v.data(), work.normal.data(), r);
      }
#pragma omp for schedule(static)
      for (std::int32_t i = 0; i < rows; ++i) advance(shells, contact_rows > 0 ? contact : nullptr, input, work, i, dt, relaxation);
#pragma omp single
      {
        work.x.swap(work.next_x);
        work.v.swap(work.next_v);
      }
    }
    for (std::int32_t i = 0; i < rows; ++i) position[i] = work.x[i].template head<D>();
    left = count == wanted ? 0 : left - count * dt;
    report.substeps += count;
    report.substep = dt;
  }
  for (std::int32_t i = 0; i < rows; ++i) {
    velocity[i] = work.v[i].template head<D>();
    if (!mean_force.empty()) mean_force[i] = work.mean[i].template head<D>() / input.duration;
    report.limiter_hits += work.limited[i];
    report.fastest = std::max(report.fastest, velocity[i].norm());
  }
  if (contact) {
    const ContactReport found = contact_report(*contact);
    report.contacts = found.contacts;
    report.crossed = found.crossed;
    report.deepest_overlap = found.deepest_overlap;
  }
  return report;
}

#define CUSP_INSTANTIATE(D)                                                                                                                \
  template ShellSubstepReport shell_substeps<D>(const ShellElasticity<D>&, Contact<D>*, const ShellSubstepInput<D>&, std::span<Vector<D>>, \
                                                std::span<Vector<D>>, std::span<Vector<D>>);
CUSP_INSTANTIATE(2)
CUSP_INSTANTIATE(3)
#undef CUSP_INSTANTIATE

}  // namespace sim
