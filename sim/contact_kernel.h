// Inside contact: one row's penalty force and the gathering of reactions; shared by contact.cpp and the shells' sub-steps.
#pragma once

#include <algorithm>
#include <cmath>

#include "sim/contact.h"

namespace sim::contact_kernel {

// Smooth compact weight (1 - r^2/R^2)^2, 0 beyond R.
inline double smooth_weight(double squared, double reach) {
  const double u = 1 - squared / (reach * reach);
  return u > 0 ? u * u : 0.0;
}

// Smooth surface of the other body as seen from x: gap f(x) = sum w (n_j . (x - x_j) - depth_j) / sum w, mean normal, mean velocity, and
// `fade`, which falls from 1 to 0 where x passes beyond the other body's edge.
template <int D>
struct Seen {
  double total = 0, gap = 0, fade = 0;
  Padded<D> normal, velocity;
};

template <int D>
Seen<D> see(Contact<D>& contact, const typename Contact<D>::Row& row, const Padded<D>* x, const Padded<D>* v, const Padded<D>* normal) {
  Seen<D> seen;
  const Padded<D> here = x[row.particle];
  const bool wall = row.other == contact.bodies;
  const double reach = wall ? contact.wall_reach : contact.reach;
  Padded<D> mean = Padded<D>::Zero(), direction = Padded<D>::Zero(), velocity = Padded<D>::Zero();
  for (std::int32_t c = row.first; c < row.last; ++c) {
    const std::int32_t j = contact.candidate[c];
    Padded<D> other, n;
    if (wall) {
      other.setZero();
      n.setZero();
      other.template head<D>() = contact.wall.position[j];
      n.template head<D>() = contact.wall.normal[j];
    } else {
      other = x[j];
      n = normal[j];
    }
    const Padded<D> d = here - other;
    const double w = smooth_weight(d.squaredNorm(), reach);
    contact.share[c] = w;
    if (w == 0) continue;
    seen.total += w;
    mean += w * d;
    direction += w * n;
    seen.gap += w * (n.dot(d) - (wall ? contact.wall.depth[j] : 0.0));
    if (!wall) velocity += w * v[j];
  }
  const double length = direction.norm();
  if (seen.total <= 0 || length < 1e-3 * seen.total) {
    seen.total = 0;
    return seen;
  }
  seen.gap /= seen.total;
  mean /= seen.total;
  seen.normal = direction / length;
  seen.velocity = velocity / seen.total;
  const double beyond = (mean - seen.normal * seen.normal.dot(mean)).norm() / reach;
  seen.fade = wall ? 1.0 : std::clamp((0.6 - beyond) / 0.3, 0.0, 1.0);
  return seen;
}

// Penalty p = k A o (1 + (o/d)^2), o = d - s gap > 0, plus damping of the approach; never pulls; and the film's resistance. k is halved
// between leaflets since both sides push. Forces stay along the other surface's normal.
template <int D>
void evaluate_row(Contact<D>& contact, const ShellElasticity<D>& shells, const Padded<D>* x, const Padded<D>* v, const Padded<D>* normal,
                  std::int32_t index) {
  const auto& row = contact.rows[index];
  contact.row_force[index].setZero();
  contact.row_overlap[index] = 0;
  contact.row_acts[index] = 0;
  const Seen<D> seen = see(contact, row, x, v, normal);
  if (seen.total == 0 || seen.fade == 0) return;
  const bool wall = row.other == contact.bodies;
  const std::int32_t i = row.particle;
  const double side = wall ? 1.0 : contact.side[shells.body[i] * contact.bodies + row.other];
  const double distance = contact.limit[static_cast<std::size_t>(i) * (contact.bodies + 1) + row.other];
  const double gap = side * seen.gap, overlap = distance - gap;
  const double separating = side * seen.normal.dot(v[i] - seen.velocity);
  double push = 0;
  if (overlap > 0) {
    const double stiffness = contact.settings.stiffness * shells.area[i] * (wall ? 1.0 : 0.5) * seen.fade;
    const double relative = overlap / distance;
    push = stiffness * overlap * (1 + std::min(relative * relative, 9.0));
    if (contact.settings.damping > 0) push -= contact.settings.damping * 2 * std::sqrt(stiffness * shells.mass[i]) * separating;
    push = std::max(push, 0.0);
    contact.row_overlap[index] = overlap;
  }
  if (!wall && contact.settings.film > 0)
    push -= std::clamp(3 - 2 * gap / distance, 0.0, 1.0) * 0.5 * contact.settings.film * shells.area[i] * seen.fade * separating;
  if (push == 0) return;
  contact.row_acts[index] = 1;
  contact.row_force[index] = (side * push) * seen.normal;
  const double factor = 1 / seen.total;
  for (std::int32_t c = row.first; c < row.last; ++c) contact.share[c] *= factor;
}

// Force on shell row j: its own rows, minus its shares of the rows that lean on it.
template <int D>
Padded<D> gather_contact(const Contact<D>& contact, std::int32_t j) {
  Padded<D> force = Padded<D>::Zero();
  for (std::int32_t r = contact.row_start[j]; r < contact.row_start[j + 1]; ++r) force += contact.row_force[r];
  for (std::int32_t s = contact.reverse_start[j]; s < contact.reverse_start[j + 1]; ++s) {
    const std::int32_t r = contact.reverse_row[s];
    if (contact.row_acts[r]) force -= contact.share[contact.reverse_candidate[s]] * contact.row_force[r];
  }
  return force;
}

}  // namespace sim::contact_kernel
