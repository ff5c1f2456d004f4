#include "geometry/relax_particles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/place_particles.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
constexpr double support_in_spacings = 2.4;  // kernel support 2h with h = 1.2 l0

// Rows that move, and those near enough to push them.
std::vector<std::size_t> taking_part(const std::vector<Vector3d>& position, const std::vector<std::uint8_t>& mobile, double reach,
                                     const PeriodicBox& box) {
  std::vector<Vector3d> moving;
  for (std::size_t i = 0; i < position.size(); ++i)
    if (mobile[i]) moving.push_back(position[i]);
  const PointGrid grid(moving, reach, box);
  std::vector<std::uint8_t> near(position.size(), 0);
#pragma omp parallel for schedule(dynamic, 1024) if (position.size() > 4000)
  for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(position.size()); ++i) {
    bool found = mobile[i];
    if (!found) grid.for_each_near(position[i], [&](std::size_t, const Vector3d&, double) { found = true; });
    near[i] = found;
  }
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < position.size(); ++i)
    if (near[i]) rows.push_back(i);
  return rows;
}

// Neighbours of the moving rows, with a margin so that lists serve several sweeps.
struct NeighborLists {
  std::vector<std::size_t> start;
  std::vector<std::int32_t> row;
};

NeighborLists list_neighbors(const std::vector<Vector3d>& place, const std::vector<std::size_t>& rows,
                             const std::vector<std::uint8_t>& mobile, double reach, const PeriodicBox& box) {
  const PointGrid grid(place, reach, box);
  NeighborLists lists;
  lists.start.assign(rows.size() + 1, 0);
  constexpr std::ptrdiff_t block = 4096;
  const std::ptrdiff_t blocks = (std::ptrdiff_t(rows.size()) + block - 1) / block;
  std::vector<std::vector<std::int32_t>> found(blocks);
#pragma omp parallel for schedule(dynamic) if (blocks > 1)
  for (std::ptrdiff_t b = 0; b < blocks; ++b)
    for (std::size_t s = b * block; s < std::min(rows.size(), std::size_t(b + 1) * block); ++s) {
      if (!mobile[rows[s]]) continue;
      const std::size_t before = found[b].size();
      grid.for_each_near(place[s], [&](std::size_t t, const Vector3d&, double) {
        if (t != s) found[b].push_back(std::int32_t(t));
      });
      lists.start[s + 1] = found[b].size() - before;
    }
  for (std::size_t s = 0; s < rows.size(); ++s) lists.start[s + 1] += lists.start[s];
  for (const auto& part : found) lists.row.insert(lists.row.end(), part.begin(), part.end());
  return lists;
}

double farthest_move(const std::vector<Vector3d>& now, const std::vector<Vector3d>& before, const PeriodicBox& box) {
  double most = 0;
  for (std::size_t s = 0; s < now.size(); ++s) most = std::max(most, box.nearest_image(now[s] - before[s]).squaredNorm());
  return std::sqrt(most);
}

}  // namespace

double wendland(double r, double support, int dimension) {
  const double q = r / support;
  if (q >= 1) return 0;
  const double scale =
      dimension == 2 ? 7 / (std::numbers::pi * support * support) : 21 / (2 * std::numbers::pi * support * support * support);
  return scale * std::pow(1 - q, 4) * (1 + 4 * q);
}

double wendland_slope(double r, double support, int dimension) {
  const double q = r / support;
  if (q >= 1) return 0;
  const double scale =
      dimension == 2 ? 7 / (std::numbers::pi * support * support) : 21 / (2 * std::numbers::pi * support * support * support);
  return scale * 20 * q * (1 - q) * (1 - q) * (1 - q) / support;
}

void relax_particles(std::vector<Vector3d>& position, const std::vector<double>& volume, const std::vector<std::uint8_t>& mobile,
                     const Relaxation& relaxation) {
  const double spacing = relaxation.spacing, support = support_in_spacings * spacing;
  // 0.35 h² |dW/dr| = push r (1 - r/2h)³, see wendland_slope.
  const double push = 0.35 * 0.25 * 20 * wendland(0, support, relaxation.dimension);
  const bool wrapped = relaxation.periodic.active[0] || relaxation.periodic.active[1] || relaxation.periodic.active[2];
  const std::vector<std::size_t> rows = taking_part(position, mobile, support + spacing, relaxation.periodic);
  std::vector<Vector3d> place(rows.size()), next(rows.size()), listed;
  for (std::size_t s = 0; s < rows.size(); ++s) place[s] = position[rows[s]];
  NeighborLists lists;
  const double skin = 0.4 * spacing;
  for (int sweep = 0; sweep < relaxation.sweeps; ++sweep) {
    if (sweep == 0 || farthest_move(place, listed, relaxation.periodic) > 0.5 * skin) {
      lists = list_neighbors(place, rows, mobile, support + skin, relaxation.periodic);
      listed = place;
    }
    const bool project = sweep % 2 == 1 || sweep + 1 == relaxation.sweeps;
#pragma omp parallel for schedule(dynamic, 512) if (rows.size() > 4000)
    for (std::ptrdiff_t s = 0; s < std::ptrdiff_t(rows.size()); ++s) {
      next[s] = place[s];
      if (!mobile[rows[s]]) continue;
      Vector3d move = Vector3d::Zero();
      for (std::size_t k = lists.start[s]; k < lists.start[s + 1]; ++k) {
        const std::int32_t t = lists.row[k];
        const Vector3d arm = wrapped ? relaxation.periodic.nearest_image(place[t] - place[s]) : Vector3d(place[t] - place[s]);
        const double d2 = arm.squaredNorm();
        if (d2 >= support * support || d2 == 0) continue;
        const double r = std::sqrt(d2), q = 1 - r / support;
        double away = push * volume[rows[t]] * r * q * q * q;
        if (r < 0.9 * spacing) away += 0.25 * (0.9 * spacing - r);
        move -= away / r * arm;
      }
      const double length = move.norm(), most = 0.12 * spacing;
      if (length > most) move *= most / length;
      next[s] += move;
      if (project) relaxation.project(rows[s], next[s]);
    }
    place.swap(next);
  }
  for (std::size_t s = 0; s < rows.size(); ++s) position[rows[s]] = place[s];
}

Evenness measure_evenness(const std::vector<Vector3d>& position, const std::vector<double>& volume, int dimension, double spacing,
                          const PlacementOptions* periodic_domain) {
  PeriodicBox box;
  if (periodic_domain)
    for (int k = 0; k < dimension; ++k) {
      box.active[k] = periodic_domain->periodic[k];
      box.min[k] = periodic_domain->domain_min[k];
      if (box.active[k]) box.length[k] = periodic_domain->domain_max[k] - periodic_domain->domain_min[k];
    }
  const double support = support_in_spacings * spacing;
  double full = 0;
  const int reach = 3, deep = dimension == 3 ? reach : 0;
  for (int c = -deep; c <= deep; ++c)
    for (int b = -reach; b <= reach; ++b)
      for (int a = -reach; a <= reach; ++a)
        full += std::pow(spacing, dimension) * wendland(spacing * std::sqrt(a * a + b * b + c * c), support, dimension);
  Evenness result;
  result.density.resize(position.size());
  result.nearest.resize(position.size());
  const PointGrid grid(position, support, box);
#pragma omp parallel for schedule(dynamic, 512) if (position.size() > 4000)
  for (std::ptrdiff_t i = 0; i < std::ptrdiff_t(position.size()); ++i) {
    double sum = 0, nearest2 = support * support;
    grid.for_each_near(position[i], [&](std::size_t j, const Vector3d&, double d2) {
      sum += volume[j] * wendland(std::sqrt(d2), support, dimension);
      if (std::ptrdiff_t(j) != i) nearest2 = std::min(nearest2, d2);
    });
    result.density[i] = sum / full;
    result.nearest[i] = std::sqrt(nearest2);
  }
  return result;
}

}  // namespace geometry
