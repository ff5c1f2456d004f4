#include "sim/solid_cell.h"

namespace sim {

namespace {

// Column of Derivatives that holds d2u/dx_a dx_b.
template <int D>
constexpr int second_column(int a, int b) {
  if (a == b) return D + a;
  if constexpr (D == 2) return 4;
  return 6 + (a + b - 1);  // xy, xz, yz
}

// d_k F: column b is d2u / dx_b dx_k.
template <int D>
Tensor<D> gradient_of_deformation(const Derivatives<D>& y, int k) {
  Tensor<D> d;
  for (int b = 0; b < D; ++b) d.col(b) = y.col(second_column<D>(b, k));
  return d;
}

template <int D>
Tensor<D> symmetric(const Tensor<D>& t) {
  return 0.5 * (t + t.transpose());
}

// E_k = sym(F^T d_kF) and the stress 2 G E_k + lambda_h tr(E_k) I that belongs to it.
template <int D>
struct CellGradient {
  Tensor<D> f;  // F, or I for the linear law
  Tensor<D> d, strain, stress;
};
template <int D>
CellGradient<D> cell_gradient(const ElasticLawPoint<D>& law, const Derivatives<D>& y, int k) {
  CellGradient<D> c;
  c.f = law.law == ElasticLaw::linear ? Tensor<D>(Tensor<D>::Identity()) : deformation_gradient<D>(y);
  c.d = gradient_of_deformation<D>(y, k);
  c.strain = symmetric<D>(c.f.transpose() * c.d);
  c.stress = 2 * law.moduli.shear_modulus * c.strain + plane_stress_lambda(law.moduli) * c.strain.trace() * Tensor<D>::Identity();
  return c;
}

// The law of psi(F): with lambda_h where the volumetric strain is shared.
template <int D>
ElasticLawPoint<D> pointwise_law(ElasticLawPoint<D> law, bool shared) {
  if (shared) law.moduli.lame_lambda = plane_stress_lambda(law.moduli);
  return law;
}

}  // namespace

template <int D>
FitRow<D> monomials(const Vector<D>& r) {
  FitRow<D> m;
  m.template head<D>() = r;
  for (int a = 0; a < D; ++a) {
    m(second_column<D>(a, a)) = r(a) * r(a) / 2;
    for (int b = a + 1; b < D; ++b) m(second_column<D>(a, b)) = r(a) * r(b);
  }
  return m;
}

template <int D>
Tensor<D> deformation_gradient(const Derivatives<D>& y) {
  return Tensor<D>::Identity() + y.template leftCols<D>();
}

template <int D>
Tensor<D> deformation_gradient(const Derivatives<D>& y, const Vector<D>& offset) {
  Tensor<D> f = deformation_gradient<D>(y);
  for (int k = 0; k < D; ++k) f += gradient_of_deformation<D>(y, k) * offset(k);
  return f;
}

template <int D>
double cell_energy(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& y) {
  double energy = energy_density<D>(pointwise_law<D>(law, shared), deformation_gradient<D>(y));
  for (int k = 0; k < D; ++k) {
    const CellGradient<D> c = cell_gradient<D>(law, y, k);
    energy += cell_moment / 2 * c.stress.cwiseProduct(c.strain).sum();
  }
  return energy;
}

template <int D>
Derivatives<D> cell_stress(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& y) {
  Derivatives<D> t = Derivatives<D>::Zero();
  t.template leftCols<D>() = first_piola_kirchhoff<D>(pointwise_law<D>(law, shared), deformation_gradient<D>(y));
  for (int k = 0; k < D; ++k) {
    const CellGradient<D> c = cell_gradient<D>(law, y, k);
    if (law.law != ElasticLaw::linear) t.template leftCols<D>() += cell_moment * c.d * c.stress;
    const Tensor<D> along = cell_moment * c.f * c.stress;
    for (int b = 0; b < D; ++b) t.col(second_column<D>(b, k)) += along.col(b);
  }
  return t;
}

template <int D>
CellHessian<D> cell_hessian(const ElasticLawPoint<D>& law, double cell_moment, bool shared, const Derivatives<D>& y) {
  constexpr int size = D * fit_size<D>;
  CellHessian<D> hessian = CellHessian<D>::Zero();
  hessian.template topLeftCorner<D * D, D * D>() = elastic_tangent<D>(pointwise_law<D>(law, shared), deformation_gradient<D>(y));
  const bool linear = law.law == ElasticLaw::linear;
  const double g2 = 2 * law.moduli.shear_modulus, lambda = plane_stress_lambda(law.moduli);
  for (int k = 0; k < D; ++k) {
    const CellGradient<D> c = cell_gradient<D>(law, y, k);
    for (int column = 0; column < size; ++column) {
      Derivatives<D> dy = Derivatives<D>::Zero();
      dy.data()[column] = 1;
      const Tensor<D> df = linear ? Tensor<D>(Tensor<D>::Zero()) : Tensor<D>(dy.template leftCols<D>());
      const Tensor<D> dd = gradient_of_deformation<D>(dy, k);
      const Tensor<D> de = symmetric<D>(df.transpose() * c.d + c.f.transpose() * dd);
      const Tensor<D> ds = g2 * de + lambda * de.trace() * Tensor<D>::Identity();
      Derivatives<D> dt = Derivatives<D>::Zero();
      if (!linear) dt.template leftCols<D>() = dd * c.stress + c.d * ds;
      const Tensor<D> along = df * c.stress + c.f * ds;
      for (int b = 0; b < D; ++b) dt.col(second_column<D>(b, k)) += along.col(b);
      hessian.col(column) += cell_moment * Eigen::Map<const Eigen::Matrix<double, size, 1>>(dt.data());
    }
  }
  return hessian;
}

#define SIM_INSTANTIATE(D)                                                                                \
  template FitRow<D> monomials<D>(const Vector<D>&);                                                      \
  template Tensor<D> deformation_gradient<D>(const Derivatives<D>&);                                      \
  template Tensor<D> deformation_gradient<D>(const Derivatives<D>&, const Vector<D>&);                    \
  template double cell_energy<D>(const ElasticLawPoint<D>&, double, bool, const Derivatives<D>&);         \
  template Derivatives<D> cell_stress<D>(const ElasticLawPoint<D>&, double, bool, const Derivatives<D>&); \
  template CellHessian<D> cell_hessian<D>(const ElasticLawPoint<D>&, double, bool, const Derivatives<D>&);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
