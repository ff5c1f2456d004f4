// Energy of one particle's cell as a function of the displacement's derivatives there, with its first and second derivatives. Pure.
#pragma once

#include "sim/elastic_law.h"
#include "sim/solid.h"

namespace sim {

template <int D>
using CellHessian = Eigen::Matrix<double, D * fit_size<D>, D * fit_size<D>>;

// Energy per rest volume, J/m^3, of a cell with second moment m = l^2/12:
//   psi(F) + m/2 sum_k [2G |E_k|^2 + lambda_h tr^2 E_k],   F = I + grad u, E_k = sym(F^T d_k F) (the linear law: sym(d_k F)),
// the cell's mean of psi to second order; lambda_h = plane_stress_lambda keeps bending free of volumetric locking
// (numerics-elastic.md 3(ii), with the gradient of Green's strain for sym(R^T d_k F): equal at small strain, exactly differentiable).
// shared: psi(F) itself is taken with lambda_h too; the rest, (lambda - lambda_h)/2 theta^2, belongs to the column's mean.
template <int D>
double cell_energy(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& derivatives);

// d(cell_energy)/d(derivatives), Pa and Pa m.
template <int D>
Derivatives<D> cell_stress(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& derivatives);

// Second derivatives; index k + D a for component k, coefficient a.
template <int D>
CellHessian<D> cell_hessian(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& derivatives);

// F = I + grad u of a particle's derivatives, and at an offset from it.
template <int D>
Tensor<D> deformation_gradient(const Derivatives<D>& derivatives);
template <int D>
Tensor<D> deformation_gradient(const Derivatives<D>& derivatives, const Vector<D>& offset);

}  // namespace sim
