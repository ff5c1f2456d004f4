#include "sim/solid_consistency.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sim/solid_surface.h"
#include "sim/solid_tangent.h"

namespace sim {

namespace {

// sum over surface pieces minus sum over particles, for the displacement component `axis`, row by row.
template <int D>
std::vector<Vector<D>> mismatch(const SolidElasticity<D>& solid, int axis) {
  std::vector<Vector<D>> sum(solid.size(), Vector<D>::Zero());
  for (std::size_t i = 0; i < solid.size(); ++i) {
    const SurfacePieces<D> pieces = surface_pieces<D>(solid, i);
    for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
      const SolidFit& fit = solid.fits[f];
      if (!(fit.components >> axis & 1)) continue;
      std::array<bool, SurfacePieces<D>::most> held{};
      for (int p = 0; p < pieces.count; ++p) {
        held[p] = held_there(solid, fit, pieces.piece[p]);
        if (!held[p]) sum[i] += pieces.piece[p].area;
      }
      for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
        Vector<D> change = -solid.volume[i] * solid.shape[l].template head<D>();
        for (int p = 0; p < pieces.count; ++p)
          if (!held[p]) change += extrapolation_weight<D>(solid, l, pieces.piece[p].offset) * pieces.piece[p].area;
        sum[i] -= change;
        if (solid.neighbor[l] >= 0) sum[solid.neighbor[l]] += change;
      }
    }
  }
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (solid.fixed[i] >> axis & 1) sum[i].setZero();
  return sum;
}

// Residual operator of one fit with the uncorrected shapes: row l gives e_l of a scalar field over [the particle itself, its links].
template <int D>
Eigen::MatrixXd residual_operator(const SolidElasticity<D>& solid, const std::vector<FitRow<D>>& uncorrected, const SolidFit& fit) {
  Eigen::MatrixXd shape(fit_size<D>, fit.count), monomial(fit.count, fit_size<D>);
  for (std::int64_t l = 0; l < fit.count; ++l) {
    shape.col(l) = uncorrected[fit.first + l];
    monomial.row(l) = monomials<D>(solid.offset[fit.first + l]).transpose();
  }
  Eigen::MatrixXd e(fit.count, fit.count + 1);
  e.rightCols(fit.count) = Eigen::MatrixXd::Identity(fit.count, fit.count) - monomial * shape;
  e.col(0) = -e.rightCols(fit.count).rowwise().sum();
  return e;
}

template <int D>
Eigen::SparseMatrix<double> multiplier_matrix(const SolidElasticity<D>& solid, const std::vector<FitRow<D>>& uncorrected, int axis,
                                              const std::vector<std::int32_t>& number, std::int32_t unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  double trace = 0;
  for (const SolidFit& fit : solid.fits) {
    if (!(fit.components >> axis & 1)) continue;
    const Eigen::MatrixXd e = residual_operator<D>(solid, uncorrected, fit);
    Eigen::VectorXd weight(fit.count);
    for (std::int64_t l = 0; l < fit.count; ++l) weight(l) = solid.weight[fit.first + l] * solid.volume[fit.row] * solid.volume[fit.row];
    const Eigen::MatrixXd block = e.transpose() * weight.asDiagonal() * e;
    std::vector<std::int32_t> index{number[fit.row]};
    for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l)
      index.push_back(solid.neighbor[l] < 0 ? -1 : number[solid.neighbor[l]]);
    for (std::int64_t a = 0; a <= fit.count; ++a)
      for (std::int64_t b = 0; b <= fit.count; ++b)
        if (index[b] >= 0 && index[a] >= index[b]) entries.emplace_back(index[a], index[b], block(a, b));
    trace += block.trace();
  }
  // Quadratic fields leave no residual: a small diagonal fixes what they are.
  for (std::int32_t u = 0; u < unknowns; ++u) entries.emplace_back(u, u, 1e-10 * trace / std::max(unknowns, 1));
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

template <int D>
void apply_multipliers(SolidElasticity<D>& solid, const std::vector<FitRow<D>>& uncorrected, int axis,
                       const std::vector<std::int32_t>& number, const Eigen::MatrixXd& multiplier) {
  for (const SolidFit& fit : solid.fits) {
    if (!(fit.components >> axis & 1)) continue;
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(fit.count + 1, D);
    if (number[fit.row] >= 0) field.row(0) = multiplier.row(number[fit.row]);
    for (std::int64_t l = 0; l < fit.count; ++l)
      if (const std::int32_t j = solid.neighbor[fit.first + l]; j >= 0 && number[j] >= 0) field.row(l + 1) = multiplier.row(number[j]);
    const Eigen::MatrixXd change = residual_operator<D>(solid, uncorrected, fit) * field;
    for (std::int64_t l = 0; l < fit.count; ++l)
      solid.shape[fit.first + l].template head<D>() += solid.volume[fit.row] * solid.weight[fit.first + l] * change.row(l).transpose();
  }
}

}  // namespace

template <int D>
double make_consistent(SolidElasticity<D>& solid) {
  bool separate = false;  // some particle is held along one axis only: every component has its own fits
  for (const SolidFit& fit : solid.fits) separate = separate || fit.components != (1 << D) - 1;
  const std::vector<FitRow<D>> uncorrected = solid.shape;
  double left = 0;
  for (int axis = 0; axis < (separate ? D : 1); ++axis) {
    std::vector<std::int32_t> number(solid.size(), -1);
    std::int32_t unknowns = 0;
    for (std::size_t i = 0; i < solid.size(); ++i)
      if (!(solid.fixed[i] >> axis & 1)) number[i] = unknowns++;
    SymmetricSolver solver(1e-4, 200, true);
    if (unknowns == 0 || !solver.factorise(multiplier_matrix(solid, uncorrected, axis, number, unknowns))) continue;
    // The surface weights change with the gradients: a few rounds.
    double before = 1e300;
    for (int round = 0; round < (solver.direct() ? 12 : 3); ++round) {
      const std::vector<Vector<D>> wanted = mismatch(solid, axis);
      double remaining = 0;
      for (const Vector<D>& sum : wanted) remaining = std::max(remaining, sum.norm() / std::pow(solid.spacing, D - 1));
      if (remaining < 1e-12 || remaining > 0.9 * before) {
        left = std::max(left, remaining);
        break;
      }
      before = remaining;
      Eigen::MatrixXd multiplier(unknowns, D);
      for (int k = 0; k < D; ++k) {
        Eigen::VectorXd rhs(unknowns);
        for (std::size_t i = 0; i < solid.size(); ++i)
          if (number[i] >= 0) rhs(number[i]) = wanted[i](k);
        multiplier.col(k) = solver.solve(rhs);
      }
      apply_multipliers(solid, uncorrected, axis, number, multiplier);
    }
  }
  return left;
}

template double make_consistent<2>(SolidElasticity<2>&);
template double make_consistent<3>(SolidElasticity<3>&);

}  // namespace sim
