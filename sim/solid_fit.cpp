#include "sim/solid_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/solid_neighbors.h"

namespace sim {

namespace {

constexpr double deficient_below = 2e-3;   // eigenvalue of the quadratic part relative to the weight; a lattice's surface has 9e-3
constexpr double flat_below = 1e-4;        // of the linear part
constexpr double residual_penalty = 0.02;  // alpha of numerics-elastic.md 3(ii)

// What one fit is made of before it is solved.
template <int D>
struct Links {
  std::vector<std::int32_t> neighbor;
  std::vector<Vector<D>> offset;
  std::vector<double> weight;
  QuadraticFit<D> fit;
};

// Everything around a row within a radius, for one displacement component: particles free along it, and clamp points that hold it.
template <int D>
Links<D> links_of(const SolidElasticity<D>& solid, const std::vector<ClampPoint<D>>& clamps, std::span<const std::int32_t> rows,
                  std::span<const std::int32_t> points, std::size_t i, int component, double radius) {
  Links<D> links;
  const auto add = [&](std::int32_t neighbor, const Vector<D>& offset) {
    const double distance = offset.norm();
    if (distance >= radius) return;
    links.neighbor.push_back(neighbor);
    links.offset.push_back(offset);
    links.weight.push_back(fit_weight(distance, radius, solid.spacing));
  };
  for (const std::int32_t j : rows)
    if (static_cast<std::size_t>(j) != i && solid.body[j] == solid.body[i] && !(solid.fixed[j] >> component & 1))
      add(j, solid.rest[j] - solid.rest[i]);
  for (const std::int32_t p : points)
    if (clamps[p].body == solid.body[i] && (clamps[p].axes >> component & 1)) add(-1, clamps[p].position - solid.rest[i]);
  return links;
}

// Widens the radius where the particles are too few or badly placed for a quadratic fit; keeps the widest that helped.
template <int D>
Links<D> solved_links(const SolidElasticity<D>& solid, const std::vector<ClampPoint<D>>& clamps, std::span<const std::int32_t> rows,
                      std::span<const std::int32_t> points, std::size_t i, int component, double radius) {
  Links<D> best;
  for (const double widening : {1.0, 1.25, 1.5}) {
    Links<D> links = links_of(solid, clamps, rows, points, i, component, widening * radius);
    links.fit = quadratic_fit<D>(links.offset, links.weight, solid.spacing);
    const bool good = !links.fit.flat && !links.fit.deficient;
    if (good || best.neighbor.empty() || (best.fit.flat && !links.fit.flat)) best = std::move(links);
    if (good) break;
  }
  return best;
}

// True where something is held along some axes only (a roller): then each component has fits of its own, everywhere.
template <int D>
bool holds_single_axes(const SolidElasticity<D>& solid, const std::vector<ClampPoint<D>>& clamps) {
  constexpr std::uint8_t all = (1 << D) - 1;
  const auto partial = [](std::uint8_t axes) { return axes != 0 && axes != all; };
  return std::any_of(solid.fixed.begin(), solid.fixed.end(), partial) ||
         std::any_of(clamps.begin(), clamps.end(), [&](const ClampPoint<D>& clamp) { return partial(clamp.axes); });
}

// The fits of a free row, as sets of components.
template <int D>
std::vector<std::uint8_t> component_groups(const SolidElasticity<D>& solid, std::size_t i, bool separate) {
  constexpr std::uint8_t all = (1 << D) - 1;
  std::vector<std::uint8_t> groups;
  for (int k = 0; k < D && separate; ++k)
    if (!(solid.fixed[i] >> k & 1)) groups.push_back(static_cast<std::uint8_t>(1 << k));
  if (!separate && solid.fixed[i] == 0) groups.push_back(all);
  return groups;
}
// The row on the other side of a two-layer sheet: the link closest to the direction across, or -1.
template <int D>
std::int32_t row_across(const Links<D>& links, double spacing) {
  if (!links.fit.deficient) return -1;
  std::int32_t found = -1;
  double best = 0.8;
  for (std::size_t l = 0; l < links.neighbor.size(); ++l) {
    const double length = links.offset[l].norm(), cosine = std::abs(links.offset[l].dot(links.fit.across)) / length;
    if (links.neighbor[l] < 0 || length > 1.6 * spacing || cosine <= best) continue;
    best = cosine;
    found = links.neighbor[l];
  }
  return found;
}

double young_from(const LameModuli& m) {
  return m.shear_modulus * (3 * m.lame_lambda + 2 * m.shear_modulus) / (m.lame_lambda + m.shear_modulus);
}

// c = 3 alpha E V / sum w |R|^2
template <int D>
double residual_stiffness(const SolidElasticity<D>& solid, const Links<D>& links, std::size_t i) {
  double sum = 0;
  for (std::size_t l = 0; l < links.weight.size(); ++l) sum += links.weight[l] * links.offset[l].squaredNorm();
  return 3 * residual_penalty * young_from(solid.law[i].moduli) * solid.volume[i] / sum;
}

template <int D>
void index_incoming(SolidElasticity<D>& solid) {
  solid.incoming_begin.assign(solid.size() + 1, 0);
  for (const std::int32_t j : solid.neighbor)
    if (j >= 0) ++solid.incoming_begin[j + 1];
  for (std::size_t i = 0; i < solid.size(); ++i) solid.incoming_begin[i + 1] += solid.incoming_begin[i];
  solid.incoming.resize(solid.incoming_begin.back());
  std::vector<std::int64_t> next(solid.incoming_begin.begin(), solid.incoming_begin.end() - 1);
  for (std::size_t l = 0; l < solid.neighbor.size(); ++l)
    if (solid.neighbor[l] >= 0) solid.incoming[next[solid.neighbor[l]]++] = static_cast<std::int64_t>(l);
}

}  // namespace

double fit_weight(double distance, double radius, double spacing) {
  return distance < radius ? radius / std::max(distance, 0.4 * spacing) - 1 : 0;
}

template <int D>
QuadraticFit<D> quadratic_fit(std::span<const Vector<D>> offsets, std::span<const double> weights, double spacing) {
  constexpr int quadratic = fit_size<D> - D;
  using Quadratic = Eigen::Matrix<double, quadratic, quadratic>;
  QuadraticFit<D> fit;
  Eigen::Matrix<double, fit_size<D>, fit_size<D>> moment = decltype(moment)::Zero();
  std::vector<FitRow<D>> m(offsets.size());
  double total = 0;
  for (std::size_t l = 0; l < offsets.size(); ++l) {
    m[l] = monomials<D>(offsets[l] / spacing);
    moment += weights[l] * m[l] * m[l].transpose();
    total += weights[l];
  }
  const Tensor<D> linear = moment.template topLeftCorner<D, D>();
  const Eigen::SelfAdjointEigenSolver<Tensor<D>> principal(linear);
  if (offsets.empty() || principal.eigenvalues()(0) < flat_below * total) {
    fit.flat = true;
    return fit;
  }
  const Tensor<D> inverse = linear.inverse();
  const Eigen::Matrix<double, quadratic, D> coupling = moment.template bottomLeftCorner<quadratic, D>();
  const Quadratic schur = moment.template bottomRightCorner<quadratic, quadratic>() - coupling * inverse * coupling.transpose();
  const Eigen::SelfAdjointEigenSolver<Quadratic> modes(schur);
  Quadratic pseudo_inverse = Quadratic::Zero();
  fit.smallest_eigenvalue = modes.eigenvalues()(0) / total;
  for (int mode = quadratic - 1; mode >= 0; --mode) {
    const Eigen::Matrix<double, quadratic, 1> v = modes.eigenvectors().col(mode);
    if (modes.eigenvalues()(mode) >= deficient_below * total) {
      pseudo_inverse += v * v.transpose() / modes.eigenvalues()(mode);
      continue;
    }

    Tensor<D> form = Tensor<D>::Zero();
    for (int k = 0; k < D; ++k) form(k, k) = v(k);
    if constexpr (D == 2) {
      form(0, 1) = form(1, 0) = v(2);
    } else {
      form(0, 1) = form(1, 0) = v(3);
      form(0, 2) = form(2, 0) = v(4);
      form(1, 2) = form(2, 1) = v(5);
    }
    const Eigen::SelfAdjointEigenSolver<Tensor<D>> axes(form);
    const int largest = std::abs(axes.eigenvalues()(0)) > std::abs(axes.eigenvalues()(D - 1)) ? 0 : D - 1;
    fit.across = axes.eigenvectors().col(largest);
    fit.deficient = true;
  }
  fit.shape.resize(offsets.size());
  for (std::size_t l = 0; l < offsets.size(); ++l) {
    const Vector<D> first = weights[l] * m[l].template head<D>();
    const Eigen::Matrix<double, quadratic, 1> second =
        pseudo_inverse * (weights[l] * m[l].template tail<quadratic>() - coupling * inverse * first);
    fit.shape[l].template head<D>() = inverse * (first - coupling.transpose() * second) / spacing;
    fit.shape[l].template tail<quadratic>() = second / (spacing * spacing);
  }
  return fit;
}

template <int D>
void build_fits(SolidElasticity<D>& solid, const std::vector<ClampPoint<D>>& clamps, double kernel_radius,
                const std::vector<std::string>& body_names) {
  const std::size_t n = solid.size();
  const double radius = kernel_radius * solid.spacing;
  std::vector<Vector<D>> clamp_position;
  for (const ClampPoint<D>& clamp : clamps) clamp_position.push_back(clamp.position);
  const NeighborTable rows = points_within<D>(solid.rest, solid.rest, 1.5 * radius);
  const NeighborTable points = points_within<D>(solid.rest, clamp_position, 1.5 * radius);

  const bool separate = holds_single_axes(solid, clamps);
  std::vector<std::vector<std::uint8_t>> groups(n);
  std::vector<std::vector<Links<D>>> links(n);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(n); ++i) {
    groups[i] = component_groups(solid, i, separate);
    for (const std::uint8_t group : groups[i])
      links[i].push_back(solved_links(solid, clamps, rows.of(i), points.of(i), i, std::countr_zero(group), radius));
  }

  std::vector<std::int64_t> flat(body_names.size(), 0), members(body_names.size(), 0);
  solid.partner.assign(n, -1);
  solid.fit_begin.assign(1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    ++members[solid.body[i]];
    for (std::size_t g = 0; g < groups[i].size(); ++g) {
      Links<D>& link = links[i][g];
      if (link.fit.flat) {
        ++flat[solid.body[i]];
        continue;
      }
      if (solid.partner[i] < 0) solid.partner[i] = row_across(link, solid.spacing);
      SolidFit fit{static_cast<std::int32_t>(i), groups[i][g], static_cast<std::int64_t>(solid.neighbor.size()),
                   static_cast<std::int64_t>(link.neighbor.size()), residual_stiffness(solid, link, i)};
      solid.fits.push_back(fit);
      solid.neighbor.insert(solid.neighbor.end(), link.neighbor.begin(), link.neighbor.end());
      solid.offset.insert(solid.offset.end(), link.offset.begin(), link.offset.end());
      solid.weight.insert(solid.weight.end(), link.weight.begin(), link.weight.end());
      solid.shape.insert(solid.shape.end(), link.fit.shape.begin(), link.fit.shape.end());
    }
    solid.fit_begin.push_back(static_cast<std::int64_t>(solid.fits.size()));
    links[i].clear();
  }
  for (std::size_t b = 0; b < body_names.size(); ++b)
    if (flat[b] > 0)
      throw std::invalid_argument("elastic body '" + body_names[b] + "': " + std::to_string(flat[b]) + " of " + std::to_string(members[b]) +
                                  " particles have too few neighbours for a strain (a part one particle thick): use a smaller spacing, or "
                                  "a 'shell' shape for a thin body");
  for (std::size_t i = 0; i < n; ++i)  // a column has two ends
    if (solid.partner[i] >= 0 && solid.partner[solid.partner[i]] != static_cast<std::int32_t>(i)) solid.partner[i] = -1;
  index_incoming(solid);
}

#define SIM_INSTANTIATE(D)                                                                                \
  template QuadraticFit<D> quadratic_fit<D>(std::span<const Vector<D>>, std::span<const double>, double); \
  template void build_fits<D>(SolidElasticity<D>&, const std::vector<ClampPoint<D>>&, double, const std::vector<std::string>&);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
