#include "sim/elastic_law.h"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

namespace sim {

namespace {

constexpr double small_volume_ratio = 0.05;  // J below which ln J is continued by a polynomial

// ln J with its first two derivatives; below small_volume_ratio its Taylor polynomial there, so that inverted cells keep a finite force.
struct VolumeLog {
  double value, first, second;
};
VolumeLog volume_log(double volume_ratio) {
  const double j0 = small_volume_ratio;
  if (volume_ratio >= j0) return {std::log(volume_ratio), 1 / volume_ratio, -1 / (volume_ratio * volume_ratio)};
  const double x = (volume_ratio - j0) / j0;
  return {std::log(j0) + x - x * x / 2, (1 - x) / j0, -1 / (j0 * j0)};
}

template <int D>
using Flat = Eigen::Matrix<double, D * D, 1>;
template <int D>
Flat<D> flat(const Tensor<D>& t) {
  return Eigen::Map<const Flat<D>>(t.data());
}

template <int D>
Tensor<D> green_lagrange_strain(const Tensor<D>& f) {
  return 0.5 * (f.transpose() * f - Tensor<D>::Identity());
}

// d cof(F)/dF: eps_acm eps_bep F_mp in 3-D, constant in 2-D.
template <int D>
ElasticTangent<D> cofactor_derivative(const Tensor<D>& f) {
  ElasticTangent<D> t = ElasticTangent<D>::Zero();
  if constexpr (D == 2) {
    t(0, 3) = t(3, 0) = 1;
    t(1, 2) = t(2, 1) = -1;
  } else {
    const auto levi_civita = [](int a, int b, int c) { return (a - b) * (b - c) * (c - a) / 2; };
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c)
          for (int e = 0; e < 3; ++e) {
            if (a == c || b == e) continue;
            const int m = 3 - a - c, p = 3 - b - e;
            t(a + 3 * b, c + 3 * e) = levi_civita(a, c, m) * levi_civita(b, e, p) * f(m, p);
          }
  }
  return t;
}

// dR/dF of the polar decomposition: dR = R W, (tr(S) I - S) w = axial(R^T dF - dF^T R).
template <int D>
ElasticTangent<D> rotation_derivative(const Tensor<D>& f) {
  const Tensor<D> r = polar_rotation<D>(f);
  const Tensor<D> s = r.transpose() * f;
  ElasticTangent<D> t;
  for (int column = 0; column < D * D; ++column) {
    Tensor<D> df = Tensor<D>::Zero();
    df.data()[column] = 1;
    const Tensor<D> a = r.transpose() * df;
    Tensor<D> w = Tensor<D>::Zero();
    if constexpr (D == 2) {
      const double trace = std::abs(s.trace()) > 1e-8 ? s.trace() : 1e-8;
      w(1, 0) = (a(1, 0) - a(0, 1)) / trace;
      w(0, 1) = -w(1, 0);
    } else {
      const Eigen::Vector3d axial(a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1));
      const Eigen::Matrix3d m = s.trace() * Eigen::Matrix3d::Identity() - s;
      const Eigen::Vector3d x = m.fullPivLu().solve(axial);
      w << 0, -x(2), x(1), x(2), 0, -x(0), -x(1), x(0), 0;
    }
    const Tensor<D> dr = r * w;
    t.col(column) = flat<D>(dr);
  }
  return t;
}

// The part of the law that carries G.
template <int D>
double shear_energy(ElasticLaw law, double g, const Tensor<D>& f) {
  const Tensor<D> identity = Tensor<D>::Identity();
  switch (law) {
    case ElasticLaw::linear: {
      const Tensor<D> strain = 0.5 * (f + f.transpose()) - identity;
      return g * strain.squaredNorm();
    }
    case ElasticLaw::corotated:
      return g * (f - polar_rotation<D>(f)).squaredNorm();
    case ElasticLaw::st_venant_kirchhoff:
      return g * green_lagrange_strain<D>(f).squaredNorm();
    default:
      return g / 2 * (f.squaredNorm() - D - 2 * volume_log(f.determinant()).value);
  }
}

template <int D>
Tensor<D> shear_stress(ElasticLaw law, double g, const Tensor<D>& f) {
  switch (law) {
    case ElasticLaw::linear:
      return g * (f + f.transpose() - 2 * Tensor<D>::Identity());
    case ElasticLaw::corotated:
      return 2 * g * (f - polar_rotation<D>(f));
    case ElasticLaw::st_venant_kirchhoff:
      return 2 * g * f * green_lagrange_strain<D>(f);
    default:
      return g * (f - volume_log(f.determinant()).first * cofactor<D>(f));
  }
}

template <int D>
ElasticTangent<D> shear_tangent(ElasticLaw law, double g, const Tensor<D>& f) {
  using T = ElasticTangent<D>;
  const T identity = T::Identity();
  if (law == ElasticLaw::linear || law == ElasticLaw::st_venant_kirchhoff) {
    const bool linear = law == ElasticLaw::linear;
    const Tensor<D> strain = linear ? Tensor<D>::Zero() : green_lagrange_strain<D>(f);
    T t;
    for (int column = 0; column < D * D; ++column) {
      Tensor<D> df = Tensor<D>::Zero();
      df.data()[column] = 1;
      const Tensor<D> a = linear ? df : Tensor<D>(f.transpose() * df);
      const Tensor<D> dp = g * (linear ? Tensor<D>(a + a.transpose()) : Tensor<D>(2 * df * strain + f * (a + a.transpose())));
      t.col(column) = flat<D>(dp);
    }
    return t;
  }
  if (law == ElasticLaw::corotated) return 2 * g * (identity - rotation_derivative<D>(f));
  const VolumeLog log = volume_log(f.determinant());
  const Flat<D> c = flat<D>(cofactor<D>(f));
  return g * (identity - log.second * c * c.transpose() - log.first * cofactor_derivative<D>(f));
}

bool logarithmic(ElasticLaw law) { return law == ElasticLaw::neo_hookean || law == ElasticLaw::fibre_reinforced; }

// Fibre energy psi(I4) with its derivatives in I4; zero in compression, linear in stress beyond the limit.
struct FibreEnergy {
  double value = 0, first = 0, second = 0;
};
template <int D>
FibreEnergy fibre_energy(const ElasticLawPoint<D>& point, double i4) {
  const double k1 = point.fibre_modulus, k2 = point.fibre_stiffening;
  const auto exponential = [&](double e) {
    const double grown = std::exp(k2 * e * e);
    const double value = k2 > 0 ? k1 / (2 * k2) * std::expm1(k2 * e * e) : k1 * e * e / 2;
    return FibreEnergy{value, k1 * e * grown, k1 * grown * (1 + 2 * k2 * e * e)};
  };
  const double e = i4 - 1;
  if (e <= 0) return {};
  if (e <= point.fibre_limit) return exponential(e);
  const FibreEnergy end = exponential(point.fibre_limit);
  const double beyond = e - point.fibre_limit;
  return {end.value + end.first * beyond + end.second * beyond * beyond / 2, end.first + end.second * beyond, end.second};
}

template <int D>
bool has_fibre(const ElasticLawPoint<D>& point) {
  return point.law == ElasticLaw::fibre_reinforced && point.fibre.squaredNorm() > 0;
}

// ln lambda_3 in plane stress for the logarithmic laws: root of G (e^2s - 1) + lambda (ln J2 + s), by Newton (monotone, convex).
double log_thickness_stretch(const LameModuli& m, double log_area) {
  double s = -m.lame_lambda / (m.lame_lambda + 2 * m.shear_modulus) * log_area;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const double grown = std::exp(2 * s);
    const double step = (m.shear_modulus * (grown - 1) + m.lame_lambda * (log_area + s)) / (2 * m.shear_modulus * grown + m.lame_lambda);
    s -= step;
    if (std::abs(step) < 1e-15 * (1 + std::abs(s))) break;
  }
  return s;
}

}  // namespace

LameModuli lame_moduli(double youngs_modulus, double poisson_ratio) {
  if (!(youngs_modulus > 0) || !std::isfinite(youngs_modulus))
    throw std::invalid_argument("youngs_modulus must be positive (Pa), got " + std::to_string(youngs_modulus));
  if (!(poisson_ratio > -1 && poisson_ratio < 0.5))
    throw std::invalid_argument("poisson_ratio must lie in (-1, 0.5), got " + std::to_string(poisson_ratio));
  return {poisson_ratio * youngs_modulus / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)), youngs_modulus / (2 * (1 + poisson_ratio))};
}

double plane_stress_lambda(const LameModuli& m) { return 2 * m.shear_modulus * m.lame_lambda / (m.lame_lambda + 2 * m.shear_modulus); }

template <int D>
ElasticLawPoint<D> law_point(const ElasticMaterial& material, double stiffness_scale, const Vector<D>& fibre) {
  if (!(stiffness_scale > 0)) throw std::invalid_argument("stiffness scale must be positive, got " + std::to_string(stiffness_scale));
  ElasticLawPoint<D> point;
  point.law = material.law;
  point.moduli = lame_moduli(stiffness_scale * material.youngs_modulus, material.poisson_ratio);
  point.plane_stress = D == 2 && material.plane_stress;
  if (material.law == ElasticLaw::fibre_reinforced) {
    if (!(material.fibre_modulus >= 0) || !(material.fibre_stiffening >= 0) || !(material.fibre_limit >= 0))
      throw std::invalid_argument("fibre_modulus, fibre_stiffening and fibre_limit must not be negative");
    point.fibre_modulus = stiffness_scale * material.fibre_modulus;
    point.fibre_stiffening = material.fibre_stiffening;
    point.fibre_limit = material.fibre_limit;
    if (fibre.norm() > 0) point.fibre = fibre.normalized();
  }
  return point;
}

template <int D>
Tensor<D> cofactor(const Tensor<D>& m) {
  Tensor<D> c;
  if constexpr (D == 2) {
    c << m(1, 1), -m(1, 0), -m(0, 1), m(0, 0);
  } else {
    c.col(0) = m.col(1).cross(m.col(2));
    c.col(1) = m.col(2).cross(m.col(0));
    c.col(2) = m.col(0).cross(m.col(1));
  }
  return c;
}

template <int D>
Tensor<D> polar_rotation(const Tensor<D>& f) {
  if constexpr (D == 2) {
    const double x = f(0, 0) + f(1, 1), y = f(1, 0) - f(0, 1), length = std::hypot(x, y);
    if (length < 1e-300) return Tensor<D>::Identity();
    Tensor<D> r;
    r << x / length, -y / length, y / length, x / length;
    return r;
  } else {
    // Newton's iteration R <- (R + R^-T)/2 (Higham 1986) converges quadratically for det > 0.
    if (f.determinant() > 1e-3 * std::pow(f.squaredNorm() / 3, 1.5)) {
      Tensor<D> r = f;
      for (int iteration = 0; iteration < 20; ++iteration) {
        const Tensor<D> next = 0.5 * (r + cofactor<D>(r) / r.determinant());
        const double change = (next - r).squaredNorm();
        r = next;
        if (change < 1e-30) return r;
      }
    }
    const Eigen::JacobiSVD<Tensor<D>> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Tensor<D> u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
    return u * svd.matrixV().transpose();
  }
}

template <int D>
double volumetric_strain(ElasticLaw law, const Tensor<D>& f) {
  switch (law) {
    case ElasticLaw::linear:
      return f.trace() - D;
    case ElasticLaw::corotated:
      return polar_rotation<D>(f).cwiseProduct(f).sum() - D;
    case ElasticLaw::st_venant_kirchhoff:
      return (f.squaredNorm() - D) / 2;
    default:
      return volume_log(f.determinant()).value;
  }
}

template <int D>
Tensor<D> volumetric_strain_gradient(ElasticLaw law, const Tensor<D>& f) {
  switch (law) {
    case ElasticLaw::linear:
      return Tensor<D>::Identity();
    case ElasticLaw::corotated:
      return polar_rotation<D>(f);
    case ElasticLaw::st_venant_kirchhoff:
      return f;
    default:
      return volume_log(f.determinant()).first * cofactor<D>(f);
  }
}

template <int D>
ElasticTangent<D> volumetric_strain_hessian(ElasticLaw law, const Tensor<D>& f) {
  switch (law) {
    case ElasticLaw::linear:
      return ElasticTangent<D>::Zero();
    case ElasticLaw::corotated:
      return rotation_derivative<D>(f);
    case ElasticLaw::st_venant_kirchhoff:
      return ElasticTangent<D>::Identity();
    default: {
      const VolumeLog log = volume_log(f.determinant());
      const Flat<D> c = flat<D>(cofactor<D>(f));
      return log.second * c * c.transpose() + log.first * cofactor_derivative<D>(f);
    }
  }
}

double thickness_stretch(const ElasticLawPoint<2>& point, const Tensor<2>& f) {
  if (!point.plane_stress) return 1;
  const LameModuli& m = point.moduli;
  const double ratio = m.lame_lambda / (m.lame_lambda + 2 * m.shear_modulus);
  if (logarithmic(point.law)) return std::exp(log_thickness_stretch(m, volume_log(f.determinant()).value));
  const double strain = -ratio * volumetric_strain<2>(point.law, f);
  return point.law == ElasticLaw::st_venant_kirchhoff ? std::sqrt(std::max(1 + 2 * strain, 1e-6)) : std::max(1 + strain, 1e-3);
}

template <int D>
double energy_density(const ElasticLawPoint<D>& point, const Tensor<D>& f) {
  const LameModuli& m = point.moduli;
  double energy = shear_energy<D>(point.law, m.shear_modulus, f);
  double theta = volumetric_strain<D>(point.law, f);
  double lambda = m.lame_lambda;
  if (point.plane_stress && logarithmic(point.law)) {
    const double s = log_thickness_stretch(m, theta);
    energy += m.shear_modulus / 2 * (std::expm1(2 * s) - 2 * s);
    theta += s;
  } else if (point.plane_stress) {
    lambda = plane_stress_lambda(m);
  }
  energy += lambda / 2 * theta * theta;
  if (has_fibre(point)) energy += fibre_energy(point, (f * point.fibre).squaredNorm()).value;
  return energy;
}

template <int D>
Tensor<D> first_piola_kirchhoff(const ElasticLawPoint<D>& point, const Tensor<D>& f) {
  const LameModuli& m = point.moduli;
  double theta = volumetric_strain<D>(point.law, f);
  double lambda = m.lame_lambda;
  if (point.plane_stress && logarithmic(point.law))
    theta += log_thickness_stretch(m, theta);  // the derivative along lambda_3 vanishes: no further term
  else if (point.plane_stress)
    lambda = plane_stress_lambda(m);
  Tensor<D> p = shear_stress<D>(point.law, m.shear_modulus, f) + lambda * theta * volumetric_strain_gradient<D>(point.law, f);
  if (has_fibre(point)) {
    const Vector<D> fa = f * point.fibre;
    p += 2 * fibre_energy(point, fa.squaredNorm()).first * fa * point.fibre.transpose();
  }
  return p;
}

template <int D>
ElasticTangent<D> elastic_tangent(const ElasticLawPoint<D>& point, const Tensor<D>& f) {
  const LameModuli& m = point.moduli;
  double theta = volumetric_strain<D>(point.law, f);
  double lambda = m.lame_lambda, effective = m.lame_lambda;  // of theta itself, of its change
  if (point.plane_stress && logarithmic(point.law)) {
    const double s = log_thickness_stretch(m, theta);
    const double thinning = 2 * m.shear_modulus * std::exp(2 * s);
    effective = lambda * thinning / (thinning + lambda);
    theta += s;
  } else if (point.plane_stress) {
    lambda = effective = plane_stress_lambda(m);
  }
  const Flat<D> gradient = flat<D>(volumetric_strain_gradient<D>(point.law, f));
  ElasticTangent<D> t = shear_tangent<D>(point.law, m.shear_modulus, f) + effective * gradient * gradient.transpose();
  if (point.law != ElasticLaw::linear) t += lambda * theta * volumetric_strain_hessian<D>(point.law, f);
  if (has_fibre(point)) {
    const Vector<D> fa = f * point.fibre;
    const FibreEnergy fibre = fibre_energy(point, fa.squaredNorm());
    const Tensor<D> outer = fa * point.fibre.transpose();
    t += 4 * fibre.second * flat<D>(outer) * flat<D>(outer).transpose();
    for (int b = 0; b < D; ++b)
      for (int e = 0; e < D; ++e)
        for (int a = 0; a < D; ++a) t(a + D * b, a + D * e) += 2 * fibre.first * point.fibre(b) * point.fibre(e);
  }
  return t;
}

template <int D>
double wave_speed(const ElasticLawPoint<D>& point, double density) {
  const LameModuli& m = point.moduli;
  double modulus = (point.plane_stress ? plane_stress_lambda(m) : m.lame_lambda) + 2 * m.shear_modulus;
  if (has_fibre(point)) modulus += 4 * point.fibre_modulus;  // slope 4 psi'' of the fibre stress at I4 = 1
  return std::sqrt(modulus / density);
}

#define SIM_INSTANTIATE(D)                                                                    \
  template ElasticLawPoint<D> law_point<D>(const ElasticMaterial&, double, const Vector<D>&); \
  template double energy_density<D>(const ElasticLawPoint<D>&, const Tensor<D>&);             \
  template Tensor<D> first_piola_kirchhoff<D>(const ElasticLawPoint<D>&, const Tensor<D>&);   \
  template ElasticTangent<D> elastic_tangent<D>(const ElasticLawPoint<D>&, const Tensor<D>&); \
  template double volumetric_strain<D>(ElasticLaw, const Tensor<D>&);                         \
  template Tensor<D> volumetric_strain_gradient<D>(ElasticLaw, const Tensor<D>&);             \
  template ElasticTangent<D> volumetric_strain_hessian<D>(ElasticLaw, const Tensor<D>&);      \
  template Tensor<D> polar_rotation<D>(const Tensor<D>&);                                     \
  template Tensor<D> cofactor<D>(const Tensor<D>&);                                           \
  template double wave_speed<D>(const ElasticLawPoint<D>&, double);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
