#include "sim/contact.h"

#include <algorithm>
#include <cmath>

#include "sim/contact_kernel.h"
#include "sim/shell_kernel.h"

namespace sim {
namespace {

constexpr double reach_in_spacings = 2.0, wall_reach_in_spacings = 2.0, skin_in_spacings = 0.5;
constexpr double initial_share = 0.9;  // of the initial gap: what touches at the start does not push (numerics-coupling.md 4)
constexpr std::size_t votes = 1500;    // particles of a body that vote on the side

// On which side of body b body a starts: vote of its particles, near ones counting most.
template <int D>
std::int8_t starting_side(const ShellElasticity<D>& shells, const ShellBody& a, const ShellBody& b) {
  const std::int32_t step_a = 1 + a.count / votes, step_b = 1 + b.count / votes;
  double vote = 0;
  for (std::int32_t i = a.first; i < a.first + a.count; i += step_a)
    for (std::int32_t j = b.first; j < b.first + b.count; j += step_b) {
      const Vector<D> d = shells.rest_position[i] - shells.rest_position[j];
      const double distance = std::max(d.norm(), 0.1 * b.spacing);
      vote += shells.normal[j].dot(d) / std::pow(distance, D + 1);
    }
  return vote > 0 ? 1 : vote < 0 ? -1 : 0;
}

template <int D>
std::vector<Padded<D>> padded(std::span<const Vector<D>> values) {
  std::vector<Padded<D>> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) result[i] = pad<D>(values[i]);
  return result;
}

// Contact distances: at most the setting and 0.9 of the initial gap; held rows and rows that start behind the surface are exempt.
template <int D>
void limit_by_initial_gaps(Contact<D>& contact, const ShellElasticity<D>& shells, double distance, double wall_distance) {
  const std::int32_t columns = contact.bodies + 1;
  contact.limit.assign(shells.size() * columns, distance);
  for (std::size_t i = 0; i < shells.size(); ++i) {
    contact.limit[i * columns + contact.bodies] = wall_distance;
    if (shell_kernel::is_clamped(shells, static_cast<std::int32_t>(i)))
      std::fill_n(contact.limit.begin() + static_cast<std::ptrdiff_t>(i) * columns, columns, 0.0);
  }
  update_contact_search<D>(contact, shells, shells.rest_position);
  const auto x = padded<D>(shells.rest_position), normal = padded<D>(shells.normal);
  const std::vector<Padded<D>> still(shells.size(), Padded<D>::Zero());
  for (const auto& row : contact.rows) {
    const auto seen = contact_kernel::see(contact, row, x.data(), still.data(), normal.data());
    if (seen.total == 0 || seen.fade == 0) continue;
    const bool wall = row.other == contact.bodies;
    const double gap = seen.gap * (wall ? 1.0 : contact.side[shells.body[row.particle] * contact.bodies + row.other]);
    double& limit = contact.limit[static_cast<std::size_t>(row.particle) * columns + row.other];
    limit = std::min(limit, std::max(0.0, initial_share * gap));
  }
  contact.searched_position.clear();  // exempt rows drop out of the next search
}

}  // namespace

template <int D>
Contact<D> build_contact(const SceneDescription<D>& description, const ShellElasticity<D>& shells, const ContactSettings& settings) {
  Contact<D> contact;
  contact.settings = settings;
  contact.bodies = static_cast<std::int32_t>(shells.bodies.size());
  const double l0 = description.spacing;
  if (contact.settings.distance <= 0) contact.settings.distance = 0.5 * l0;
  if (contact.settings.wall_distance <= 0) contact.settings.wall_distance = 0.5 * l0;
  for (const ShellBody& body : shells.bodies) contact.spacing = std::max(contact.spacing, body.spacing);
  contact.reach = std::max(reach_in_spacings * contact.spacing, 1.6 * contact.settings.distance);
  contact.wall_reach = wall_reach_in_spacings * l0;
  contact.skin = skin_in_spacings * contact.spacing;
  contact.side.assign(static_cast<std::size_t>(contact.bodies) * contact.bodies, 0);
  for (std::int32_t a = 0; a < contact.bodies; ++a)
    for (std::int32_t b = 0; b < contact.bodies; ++b)
      if (a != b) contact.side[a * contact.bodies + b] = starting_side(shells, shells.bodies[a], shells.bodies[b]);
  const InitialParticles<D>& particles = description.particles;
  for (std::size_t i = 0; i < particles.kind.size(); ++i)
    if (particles.kind[i] == Kind::wall && particles.depth[i] <= l0 && particles.normal[i].squaredNorm() > 0.5) {
      contact.wall.position.push_back(particles.position[i]);
      contact.wall.normal.push_back(particles.normal[i].normalized());
      contact.wall.depth.push_back(particles.depth[i]);
    }
  if (!contact.wall.position.empty() && !shells.empty())
    contact.wall_grid = std::make_shared<const PointGrid<D>>(contact.wall.position, contact.wall_reach);
  if (!shells.empty()) limit_by_initial_gaps(contact, shells, contact.settings.distance, contact.settings.wall_distance);
  return contact;
}

namespace {

template <int D>
bool moved(const Contact<D>& contact, std::span<const Vector<D>> position) {
  if (contact.searched_position.size() != position.size()) return true;
  for (std::size_t i = 0; i < position.size(); ++i)
    if ((position[i] - contact.searched_position[i]).squaredNorm() > 0.25 * contact.skin * contact.skin) return true;
  return false;
}

template <int D>
void append_rows(Contact<D>& contact, const ShellElasticity<D>& shells, std::int32_t i, std::vector<std::int32_t>& found) {
  std::sort(found.begin(), found.end());
  const std::int32_t columns = contact.bodies + 1;
  for (std::size_t k = 0; k < found.size();) {
    const std::int32_t other = shells.body[found[k]], first = static_cast<std::int32_t>(contact.candidate.size());
    const bool engaged = contact.limit[static_cast<std::size_t>(i) * columns + other] > 0;
    for (; k < found.size() && shells.body[found[k]] == other; ++k)
      if (engaged) contact.candidate.push_back(found[k]);
    if (engaged) contact.rows.push_back({i, other, first, static_cast<std::int32_t>(contact.candidate.size())});
  }
}

template <int D>
void append_wall_row(Contact<D>& contact, const Vector<D>& x, std::int32_t i) {
  if (!contact.wall_grid || contact.limit[static_cast<std::size_t>(i) * (contact.bodies + 1) + contact.bodies] <= 0) return;
  const auto first = static_cast<std::int32_t>(contact.candidate.size());
  contact.wall_grid->for_each_near(x, contact.wall_reach + 0.5 * contact.skin,
                                   [&](std::int32_t j, double) { contact.candidate.push_back(j); });
  std::sort(contact.candidate.begin() + first, contact.candidate.end());
  const auto last = static_cast<std::int32_t>(contact.candidate.size());
  if (last > first) contact.rows.push_back({i, contact.bodies, first, last});
}

template <int D>
void reverse_candidates(Contact<D>& contact, std::size_t shell_rows) {
  contact.reverse_start.assign(shell_rows + 1, 0);
  for (const auto& row : contact.rows)
    if (row.other != contact.bodies)
      for (std::int32_t c = row.first; c < row.last; ++c) ++contact.reverse_start[contact.candidate[c] + 1];
  for (std::size_t j = 0; j < shell_rows; ++j) contact.reverse_start[j + 1] += contact.reverse_start[j];
  contact.reverse_candidate.resize(contact.reverse_start.back());
  contact.reverse_row.resize(contact.reverse_start.back());
  auto next = contact.reverse_start;
  for (std::size_t r = 0; r < contact.rows.size(); ++r) {
    const auto& row = contact.rows[r];
    if (row.other == contact.bodies) continue;
    for (std::int32_t c = row.first; c < row.last; ++c) {
      const std::int32_t slot = next[contact.candidate[c]]++;
      contact.reverse_candidate[slot] = c;
      contact.reverse_row[slot] = static_cast<std::int32_t>(r);
    }
  }
}

}  // namespace

template <int D>
void update_contact_search(Contact<D>& contact, const ShellElasticity<D>& shells, std::span<const Vector<D>> position) {
  if (!moved(contact, position)) return;
  contact.searched_position.assign(position.begin(), position.end());
  contact.rows.clear();
  contact.candidate.clear();
  contact.row_start.assign(1, 0);
  const PointGrid<D> grid(position, contact.reach + contact.skin);
  std::vector<std::int32_t> found;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(position.size()); ++i) {
    if (!shell_kernel::is_clamped(shells, i)) {
      found.clear();
      grid.for_each_near(position[i], contact.reach + contact.skin, [&](std::int32_t j, double) {
        if (shells.body[j] != shells.body[i] && contact.side[shells.body[i] * contact.bodies + shells.body[j]] != 0) found.push_back(j);
      });
      append_rows(contact, shells, i, found);
      append_wall_row(contact, position[i], i);
    }
    contact.row_start.push_back(static_cast<std::int32_t>(contact.rows.size()));
  }
  reverse_candidates(contact, position.size());
  contact.share.assign(contact.candidate.size(), 0);
  contact.row_force.assign(contact.rows.size(), Padded<D>::Zero());
  contact.row_overlap.assign(contact.rows.size(), 0);
  contact.row_acts.assign(contact.rows.size(), 0);
}

template <int D>
ContactReport contact_report(const Contact<D>& contact) {
  ContactReport report;
  for (std::size_t r = 0; r < contact.rows.size(); ++r) {
    if (contact.row_overlap[r] <= 0) continue;
    ++report.contacts;
    report.deepest_overlap = std::max(report.deepest_overlap, contact.row_overlap[r]);
    const auto& row = contact.rows[r];
    if (contact.row_overlap[r] > contact.limit[static_cast<std::size_t>(row.particle) * (contact.bodies + 1) + row.other]) ++report.crossed;
  }
  return report;
}

template <int D>
ContactReport add_contact_forces(Contact<D>& contact, const ShellElasticity<D>& shells, std::span<const Vector<D>> position,
                                 std::span<const Vector<D>> velocity, std::span<const Vector<D>> normal, std::span<Vector<D>> force) {
  update_contact_search(contact, shells, position);
  const auto x = padded<D>(position), v = padded<D>(velocity), n = padded<D>(normal);
  const auto rows = static_cast<std::int32_t>(contact.rows.size()), particles = static_cast<std::int32_t>(position.size());
#pragma omp parallel if (rows > 200)
  {
#pragma omp for schedule(static)
    for (std::int32_t r = 0; r < rows; ++r) contact_kernel::evaluate_row(contact, shells, x.data(), v.data(), n.data(), r);
#pragma omp for schedule(static)
    for (std::int32_t j = 0; j < particles; ++j) force[j] += contact_kernel::gather_contact(contact, j).template head<D>();
  }
  return contact_report(contact);
}

#define CUSP_INSTANTIATE(D)                                                                                            \
  template Contact<D> build_contact<D>(const SceneDescription<D>&, const ShellElasticity<D>&, const ContactSettings&); \
  template void update_contact_search<D>(Contact<D>&, const ShellElasticity<D>&, std::span<const Vector<D>>);          \
  template ContactReport contact_report<D>(const Contact<D>&);                                                         \
  template ContactReport add_contact_forces<D>(Contact<D>&, const ShellElasticity<D>&, std::span<const Vector<D>>,     \
                                               std::span<const Vector<D>>, std::span<const Vector<D>>, std::span<Vector<D>>);
CUSP_INSTANTIATE(2)
CUSP_INSTANTIATE(3)
#undef CUSP_INSTANTIATE

}  // namespace sim
