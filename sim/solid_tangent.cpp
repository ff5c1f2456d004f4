#include "sim/solid_tangent.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "sim/solid_cell.h"

namespace sim {

namespace {

// Derivatives of component k at a row as a linear map of the nodes' displacements: one matrix (fit_size x nodes) per component.
template <int D>
using ComponentMap = Eigen::Matrix<double, fit_size<D>, Eigen::Dynamic>;

template <int D>
int local_index(std::span<const std::int32_t> nodes, std::int32_t row) {
  return static_cast<int>(std::find(nodes.begin(), nodes.end(), row) - nodes.begin());
}

template <int D>
std::array<ComponentMap<D>, D> component_maps(const SolidElasticity<D>& solid, std::size_t i, std::span<const std::int32_t> nodes) {
  std::array<ComponentMap<D>, D> maps;
  for (auto& map : maps) map.setZero(fit_size<D>, static_cast<Eigen::Index>(nodes.size()));
  const int own = local_index<D>(nodes, static_cast<std::int32_t>(i));
  for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
    const SolidFit& fit = solid.fits[f];
    for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
      const int other = solid.neighbor[l] < 0 ? -1 : local_index<D>(nodes, solid.neighbor[l]);
      for (int k = 0; k < D; ++k) {
        if (!(fit.components >> k & 1)) continue;
        maps[k].col(own) -= solid.shape[l];
        if (other >= 0) maps[k].col(other) += solid.shape[l];
      }
    }
  }
  return maps;
}

// c sum_l w_l (de_l/du)(de_l/du)^T of each fit, added to the diagonal component blocks.
template <int D>
void add_residual_stiffness(const SolidElasticity<D>& solid, std::size_t i, std::span<const std::int32_t> nodes,
                            const std::array<ComponentMap<D>, D>& maps, Eigen::MatrixXd& element) {
  const auto count = static_cast<Eigen::Index>(nodes.size());
  const int own = local_index<D>(nodes, static_cast<std::int32_t>(i));
  for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
    const SolidFit& fit = solid.fits[f];
    const int lead = std::countr_zero(fit.components);
    Eigen::MatrixXd e(fit.count, count);
    for (std::int64_t l = 0; l < fit.count; ++l) {
      const std::int64_t link = fit.first + l;
      e.row(l) = -monomials<D>(solid.offset[link]).transpose() * maps[lead];
      e(l, own) -= 1;
      if (solid.neighbor[link] >= 0) e(l, local_index<D>(nodes, solid.neighbor[link])) += 1;
      e.row(l) *= std::sqrt(fit.residual_stiffness * solid.weight[link]);
    }
    const Eigen::MatrixXd block = e.transpose() * e;
    for (int k = 0; k < D; ++k)
      if (fit.components >> k & 1) element.block(k * count, k * count, count, count) += block;
  }
}

template <int D>
double shared_stiffness(const SolidElasticity<D>& solid, std::size_t i) {
  const LameModuli& m = solid.law[i].moduli;
  return solid.volume[i] * (m.lame_lambda - plane_stress_lambda(m));
}

// d theta / d u over the nodes, component by component.
template <int D>
Eigen::VectorXd volumetric_slope(const SolidElasticity<D>& solid, std::size_t i, std::span<const std::int32_t> nodes,
                                 const Derivatives<D>& y) {
  const auto maps = component_maps(solid, i, nodes);
  const Tensor<D> gradient = volumetric_strain_gradient<D>(solid.law[i].law, deformation_gradient<D>(y));
  Eigen::VectorXd slope(static_cast<Eigen::Index>(D * nodes.size()));
  for (int k = 0; k < D; ++k)
    slope.segment(k * static_cast<Eigen::Index>(nodes.size()), static_cast<Eigen::Index>(nodes.size())) =
        maps[k].template topRows<D>().transpose() * gradient.row(k).transpose();
  return slope;
}

// Tangent of one particle's energy; index k * nodes + node.
template <int D>
Eigen::MatrixXd element_tangent(const SolidElasticity<D>& solid, std::size_t i, std::span<const std::int32_t> nodes,
                                const std::vector<Derivatives<D>>& derivatives) {
  const auto count = static_cast<Eigen::Index>(nodes.size());
  const bool shared = shares_volume(solid, i);
  const ElasticLawPoint<D>& law = solid.law[i];
  CellHessian<D> hessian = solid.volume[i] * cell_hessian<D>(law, solid.cell_moment[i], shared, derivatives[i]);
  Eigen::MatrixXd element = Eigen::MatrixXd::Zero(D * count, D * count);
  if (shared) {
    const std::size_t j = solid.partner[i];
    const Tensor<D> f_i = deformation_gradient<D>(derivatives[i]), f_j = deformation_gradient<D>(derivatives[j]);
    const double mean = (volumetric_strain<D>(law.law, f_i) + volumetric_strain<D>(law.law, f_j)) / 2;
    const double coefficient = (shared_stiffness(solid, i) + shared_stiffness(solid, j)) / 2;
    hessian.template topLeftCorner<D * D, D * D>() += coefficient * mean * volumetric_strain_hessian<D>(law.law, f_i);
    if (i < j) {
      const Eigen::VectorXd slope =
          (volumetric_slope(solid, i, nodes, derivatives[i]) + volumetric_slope(solid, j, nodes, derivatives[j])) / 2;
      element += 2 * coefficient * slope * slope.transpose();
    }
  }
  const auto maps = component_maps(solid, i, nodes);
  for (int k = 0; k < D; ++k)
    for (int m = 0; m < D; ++m) {
      Eigen::Matrix<double, fit_size<D>, fit_size<D>> block;
      for (int a = 0; a < fit_size<D>; ++a)
        for (int b = 0; b < fit_size<D>; ++b) block(a, b) = hessian(k + D * a, m + D * b);
      element.block(k * count, m * count, count, count) += maps[k].transpose() * (block * maps[m]);
    }
  add_residual_stiffness<D>(solid, i, nodes, maps, element);
  return element;
}

template <int D>
void scatter_element(const SolidPattern<D>& pattern, std::span<const std::int32_t> nodes, const Eigen::MatrixXd& element,
                     Eigen::SparseMatrix<double>& lower) {
  const auto count = static_cast<Eigen::Index>(nodes.size());
  for (Eigen::Index b = 0; b < count; ++b)
    for (int m = 0; m < D; ++m) {
      const std::int32_t column = pattern.dof[nodes[b] * D + m];
      if (column < 0) continue;
      const int* begin = lower.innerIndexPtr() + lower.outerIndexPtr()[column];
      const int* end = lower.innerIndexPtr() + lower.outerIndexPtr()[column + 1];
      for (Eigen::Index a = 0; a < count; ++a)
        for (int k = 0; k < D; ++k) {
          const std::int32_t row = pattern.dof[nodes[a] * D + k];
          if (row < column) continue;
          lower.valuePtr()[std::lower_bound(begin, end, row) - lower.innerIndexPtr()] += element(k * count + a, m * count + b);
        }
    }
}

template <int D>
std::span<const std::int32_t> nodes_of(const SolidPattern<D>& pattern, std::size_t i) {
  return {pattern.node.data() + pattern.node_begin[i], static_cast<std::size_t>(pattern.node_begin[i + 1] - pattern.node_begin[i])};
}

// Rows that the energy of row i depends on through its own fits.
template <int D>
std::vector<std::int32_t> fit_rows(const SolidElasticity<D>& solid, std::size_t i) {
  std::vector<std::int32_t> rows{static_cast<std::int32_t>(i)};
  for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f)
    for (std::int64_t l = solid.fits[f].first; l < solid.fits[f].first + solid.fits[f].count; ++l)
      if (solid.neighbor[l] >= 0 && std::find(rows.begin(), rows.end(), solid.neighbor[l]) == rows.end()) rows.push_back(solid.neighbor[l]);
  return rows;
}

}  // namespace

template <int D>
SolidPattern<D> solid_pattern(const SolidElasticity<D>& solid) {
  const std::size_t n = solid.size();
  SolidPattern<D> pattern;
  pattern.dof.assign(n * D, -1);
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < D; ++k)
      if (!(solid.fixed[i] >> k & 1)) pattern.dof[i * D + k] = pattern.dofs++;
  pattern.node_begin.assign(1, 0);
  std::vector<std::vector<std::int32_t>> meets(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::int32_t> nodes = fit_rows(solid, i);
    if (shares_volume(solid, i))
      for (const std::int32_t row : fit_rows(solid, solid.partner[i]))
        if (std::find(nodes.begin(), nodes.end(), row) == nodes.end()) nodes.push_back(row);
    for (const std::int32_t a : nodes)
      for (const std::int32_t b : nodes)
        if (b >= a) meets[a].push_back(b);
    pattern.node.insert(pattern.node.end(), nodes.begin(), nodes.end());
    pattern.node_begin.push_back(static_cast<std::int64_t>(pattern.node.size()));
    if (i % 512 == 511 || i + 1 == n)  // keep the lists short while they grow
      for (auto& list : meets) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
      }
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t a = 0; a < n; ++a)
    for (const std::int32_t b : meets[a])
      for (int k = 0; k < D; ++k)
        for (int m = 0; m < D; ++m) {
          const std::int32_t column = pattern.dof[a * D + k], row = pattern.dof[b * D + m];
          if (column >= 0 && row >= column) entries.emplace_back(row, column, 0.0);
        }
  pattern.lower.resize(pattern.dofs, pattern.dofs);
  pattern.lower.setFromTriplets(entries.begin(), entries.end());
  pattern.lower.makeCompressed();
  return pattern;
}

template <int D>
void assemble_tangent(const SolidElasticity<D>& solid, const SolidPattern<D>& pattern, std::span<const Vector<D>> position,
                      SolidWork<D>& work, Eigen::SparseMatrix<double>& lower) {
  if (lower.nonZeros() != pattern.lower.nonZeros() || lower.rows() != pattern.lower.rows()) lower = pattern.lower;
  std::fill_n(lower.valuePtr(), lower.nonZeros(), 0.0);
  solid_derivatives<D>(solid, position, work);
  constexpr std::int64_t batch = 256;  // elements are made in parallel and added in order: the same sums for any number of threads
  std::vector<Eigen::MatrixXd> elements(batch);
  const auto n = static_cast<std::int64_t>(solid.size());
  for (std::int64_t first = 0; first < n; first += batch) {
    const std::int64_t last = std::min(first + batch, n);
#pragma omp parallel for schedule(dynamic, 8)
    for (std::int64_t i = first; i < last; ++i)
      if (solid.fit_begin[i] < solid.fit_begin[i + 1])
        elements[i - first] = element_tangent(solid, i, nodes_of(pattern, i), work.derivatives);
    for (std::int64_t i = first; i < last; ++i)
      if (solid.fit_begin[i] < solid.fit_begin[i + 1]) scatter_element(pattern, nodes_of(pattern, i), elements[i - first], lower);
  }
}

template <int D>
void add_to_diagonal(const SolidPattern<D>& pattern, std::span<const double> value, double coefficient,
                     Eigen::SparseMatrix<double>& lower) {
  for (std::size_t i = 0; i < value.size(); ++i)
    for (int k = 0; k < D; ++k)
      if (const std::int32_t dof = pattern.dof[i * D + k]; dof >= 0)
        lower.valuePtr()[lower.outerIndexPtr()[dof]] += coefficient * value[i];  // the diagonal comes first in its column
}

template <int D>
Eigen::VectorXd gather(const SolidPattern<D>& pattern, std::span<const Vector<D>> rows) {
  Eigen::VectorXd values(pattern.dofs);
  for (std::size_t i = 0; i * D < pattern.dof.size(); ++i)
    for (int k = 0; k < D; ++k)
      if (pattern.dof[i * D + k] >= 0) values(pattern.dof[i * D + k]) = rows[i](k);
  return values;
}

template <int D>
void scatter_add(const SolidPattern<D>& pattern, const Eigen::VectorXd& values, double scale, std::span<Vector<D>> rows) {
  for (std::size_t i = 0; i * D < pattern.dof.size(); ++i)
    for (int k = 0; k < D; ++k)
      if (pattern.dof[i * D + k] >= 0) rows[i](k) += scale * values(pattern.dof[i * D + k]);
}

#define SIM_INSTANTIATE(D)                                                                                                        \
  template SolidPattern<D> solid_pattern<D>(const SolidElasticity<D>&);                                                           \
  template void assemble_tangent<D>(const SolidElasticity<D>&, const SolidPattern<D>&, std::span<const Vector<D>>, SolidWork<D>&, \
                                    Eigen::SparseMatrix<double>&);                                                                \
  template void add_to_diagonal<D>(const SolidPattern<D>&, std::span<const double>, double, Eigen::SparseMatrix<double>&);        \
  template Eigen::VectorXd gather<D>(const SolidPattern<D>&, std::span<const Vector<D>>);                                         \
  template void scatter_add<D>(const SolidPattern<D>&, const Eigen::VectorXd&, double, std::span<Vector<D>>);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
