#include "sim/solid_consistency.h"

#include <Eigen/Sparse>
#include <algorithm>
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
    for (const SurfacePiece<D>& piece : pieces) sum[i] += piece.area;
    for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
      const SolidFit& fit = solid.fits[f];
      if (!(fit.components >> axis & 1)) continue;
      for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
        Vector<D> change = -solid.volume[i] * solid.shape[l].template head<D>();
        for (const SurfacePiece<D>& piece : pieces) change += extrapolation_weight<D>(solid, l, piece.offset) * piece.area;
        sum[i] -= change;
        if (solid.neighbor[l] >= 0) sum[solid.neighbor[l]] += change;
      }
    }
  }
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (solid.fixed[i] >> axis & 1) sum[i].setZero();
  return sum;
}

// Residual operator of one fit: row l gives e_l of a scalar field over [the particle itself, its links].
template <int D>
Eigen::MatrixXd residual_operator(const SolidElasticity<D>& solid, const SolidFit& fit) {
  Eigen::MatrixXd shape(fit_size<D>, fit.count), monomial(fit.count, fit_size<D>);
  for (std::int64_t l = 0; l < fit.count; ++l) {
    shape.col(l) = solid.shape[fit.first + l];
    monomial.row(l) = monomials<D>(solid.offset[fit.first + l]).transpose();
  }
  Eigen::MatrixXd e(fit.count, fit.count + 1);
  e.rightCols(fit.count) = Eigen::MatrixXd::Identity(fit.count, fit.count) - monomial * shape;
  e.col(0) = -e.rightCols(fit.count).rowwise().sum();
  return e;
}

template <int D>
Eigen::SparseMatrix<double> multiplier_matrix(const SolidElasticity<D>& solid, int axis, const std::vector<std::int32_t>& number,
                                              std::int32_t unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  double trace = 0;
  for (const SolidFit& fit : solid.fits) {
    if (!(fit.components >> axis & 1)) continue;
    const Eigen::MatrixXd e = residual_operator<D>(solid, fit);
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
void apply_multipliers(SolidElasticity<D>& solid, int axis, const std::vector<std::int32_t>& number, const Eigen::MatrixXd& multiplier) {
  for (const SolidFit& fit : solid.fits) {
    if (!(fit.components >> axis & 1)) continue;
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(fit.count + 1, D);
    if (number[fit.row] >= 0) field.row(0) = multiplier.row(number[fit.row]);
    for (std::int64_t l = 0; l < fit.count; ++l)
      if (const std::int32_t j = solid.neighbor[fit.first + l]; j >= 0 && number[j] >= 0) field.row(l + 1) = multiplier.row(number[j]);
    const Eigen::MatrixXd change = residual_operator<D>(solid, fit) * field;
    for (std::int64_t l = 0; l < fit.count; ++l)
      solid.shape[fit.first + l].template head<D>() += solid.volume[fit.row] * solid.weight[fit.first + l] * change.row(l).transpose();
  }
}

}  // namespace

template <int D>
double make_consistent(SolidElasticity<D>& solid) {
  bool separate = false;  // some particle is held along one axis only: every component has its own fits
  for (const SolidFit& fit : solid.fits) separate = separate || fit.components != (1 << D) - 1;
  double left = 0;
  for (int axis = 0; axis < (separate ? D : 1); ++axis) {
    std::vector<std::int32_t> number(solid.size(), -1);
    std::int32_t unknowns = 0;
    for (std::size_t i = 0; i < solid.size(); ++i)
      if (!(solid.fixed[i] >> axis & 1)) number[i] = unknowns++;
    SymmetricSolver solver;
    if (unknowns == 0 || !solver.factorise(multiplier_matrix(solid, axis, number, unknowns))) continue;
    const std::vector<Vector<D>> wanted = mismatch(solid, axis);
    Eigen::MatrixXd multiplier(unknowns, D);
    for (int k = 0; k < D; ++k) {
      Eigen::VectorXd rhs(unknowns);
      for (std::size_t i = 0; i < solid.size(); ++i)
        if (number[i] >= 0) rhs(number[i]) = wanted[i](k);
      multiplier.col(k) = solver.solve(rhs);
    }
    apply_multipliers(solid, axis, number, multiplier);
    for (const Vector<D>& remaining : mismatch(solid, axis)) left = std::max(left, remaining.norm() / std::pow(solid.spacing, D - 1));
  }
  return left;
}

template double make_consistent<2>(SolidElasticity<2>&);
template double make_consistent<3>(SolidElasticity<3>&);

}  // namespace sim
