#include "sim/shell_law.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sim {
namespace {

constexpr double smallest_metric = 0.16;  // stretch 0.4: below, every law goes on with constant stiffness

SheetTensor identity(double factor = 1) { return {factor, factor, 0}; }

double smallest_eigenvalue(const SheetTensor& c) {
  const double half = 0.5 * (c.xx + c.yy), difference = 0.5 * (c.xx - c.yy);
  return half - std::sqrt(difference * difference + c.xy * c.xy);
}

// C^-1
SheetTensor inverse(const SheetTensor& c) {
  const double f = 1 / c.determinant();
  return {c.yy * f, c.xx * f, -c.xy * f};
}

// Hooke's law in plane stress: lambda_ps tr(e) I + 2 G e.
SheetTensor hooke(const SheetMaterial& m, const SheetTensor& e) { return identity(m.sheet_lambda * e.trace()) + e * (2 * m.shear_modulus); }

// U = sqrt(C) of a positive 2 x 2 tensor (Cayley-Hamilton).
SheetTensor square_root(const SheetTensor& c) {
  const double s = std::sqrt(c.determinant());
  return (c + identity(s)) * (1 / std::sqrt(c.trace() + 2 * s));
}

// Thickness metric of the neo-Hookean sheet: G (C33 - 1) + lambda/2 (ln C33 + ln det C) = 0, Newton in y = ln C33.
double neo_hookean_thickness(const SheetMaterial& m, double determinant) {
  const double g = m.shear_modulus, half_lambda = 0.5 * m.lame_lambda, log_area = std::log(determinant);
  double y = -log_area * half_lambda / (half_lambda + g), exponential = std::exp(y);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double step = (g * (exponential - 1) + half_lambda * (y + log_area)) / (g * exponential + half_lambda);
    y -= step;
    exponential = std::abs(step) < 1e-4 ? exponential * (1 - step + 0.5 * step * step) : std::exp(y);
    if (std::abs(step) < 1e-5) break;
  }
  return exponential;
}

// S = G (I - C^-1) + lambda ln J C^-1 with lambda ln J = G (1 - C33) from S33 = 0: S = G (I - C33 C^-1).
SheetTensor neo_hookean_stress(const SheetMaterial& m, const SheetTensor& c) {
  const double thickness = neo_hookean_thickness(m, c.determinant());
  return identity(m.shear_modulus) - inverse(c) * (m.shear_modulus * thickness);
}

SheetTensor isotropic_stress(const SheetMaterial& m, const SheetTensor& c) {
  switch (m.law) {
    case ElasticLaw::st_venant_kirchhoff:
      return hooke(m, (c - identity()) * 0.5);
    case ElasticLaw::linear:
    case ElasticLaw::corotated: {
      const SheetTensor u = square_root(c), v = inverse(u), t = hooke(m, u - identity());
      return {v.xx * t.xx + v.xy * t.xy, v.xy * t.xy + v.yy * t.yy, v.xx * t.xy + v.xy * t.yy};  // U^-1 T, coaxial
    }
    default:
      return neo_hookean_stress(m, c);
  }
}

// A beam free to contract sideways: the metric of the sideways direction at zero sideways stress (= that of the thickness).
double sideways_metric(const SheetMaterial& m, double along) {
  const double nu = m.poisson_ratio;
  switch (m.law) {
    case ElasticLaw::st_venant_kirchhoff:
      return std::max(0.05, 1 - nu * (along - 1));
    case ElasticLaw::linear:
    case ElasticLaw::corotated: {
      const double stretch = std::max(0.2, 1 - nu * (std::sqrt(along) - 1));
      return stretch * stretch;
    }
    default: {  // G (t - 1) + lambda/2 (ln C11 + 2 ln t) = 0
      const double g = m.shear_modulus, half_lambda = 0.5 * m.lame_lambda, log_along = std::log(along);
      double y = -nu * log_along;
      for (int iteration = 0; iteration < 20; ++iteration) {
        const double e = std::exp(y), step = (g * (e - 1) + half_lambda * (log_along + 2 * y)) / (g * e + 2 * half_lambda);
        y -= step;
        if (std::abs(step) < 1e-9) break;
      }
      return std::exp(y);
    }
  }
}

double fibre_strain(const SheetTensor& c, const Eigen::Vector2d& f) {
  return c.xx * f.x() * f.x() + c.yy * f.y() * f.y() + 2 * c.xy * f.x() * f.y() - 1;
}

bool has_fibre(const SheetMaterial& m, const Eigen::Vector2d& f) {
  return m.law == ElasticLaw::fibre_reinforced && m.fibre_modulus > 0 && f.squaredNorm() > 0;
}

}  // namespace

SheetMaterial sheet_material(const ElasticMaterial& material) {
  const double e = material.youngs_modulus, nu = material.poisson_ratio;
  if (!(e > 0)) throw std::invalid_argument("youngs_modulus must be > 0 Pa");
  if (!(nu > -1 && nu < 0.5)) throw std::invalid_argument("poisson_ratio must lie in (-1, 0.5)");
  if (material.fibre_modulus < 0 || material.fibre_stiffening < 0 || material.fibre_limit <= 0)
    throw std::invalid_argument("fibre_modulus and fibre_stiffening must be >= 0 and fibre_limit > 0");
  SheetMaterial m;
  m.law = material.law;
  m.youngs_modulus = e;
  m.poisson_ratio = nu;
  m.shear_modulus = e / (2 * (1 + nu));
  m.lame_lambda = nu * e / ((1 + nu) * (1 - 2 * nu));
  m.sheet_lambda = nu * e / (1 - nu * nu);
  m.fibre_modulus = material.fibre_modulus;
  m.fibre_stiffening = material.fibre_stiffening;
  m.fibre_limit = material.fibre_limit;
  return m;
}

double fibre_stress_slope(const SheetMaterial& m, double x) {
  if (x <= 0) return 0;
  const double y = std::min(x, m.fibre_limit), k2 = m.fibre_stiffening;
  return 2 * m.fibre_modulus * std::exp(k2 * y * y) * (1 + 2 * k2 * y * y);
}

double fibre_stress(const SheetMaterial& m, double x) {
  if (x <= 0) return 0;
  const double y = std::min(x, m.fibre_limit), k2 = m.fibre_stiffening, exponential = 2 * m.fibre_modulus * std::exp(k2 * y * y);
  return exponential * y + (x > y ? exponential * (1 + 2 * k2 * y * y) * (x - y) : 0.0);
}

SheetTensor sheet_stress(const SheetMaterial& m, const SheetTensor& metric, const Eigen::Vector2d& fibre, bool* limited) {
  SheetTensor c = metric;
  if (m.narrow) c.yy = sideways_metric(m, std::max(c.xx, smallest_metric));
  const double deficit = smallest_metric - smallest_eigenvalue(c);
  SheetTensor s;
  if (deficit > 0) {
    if (limited) *limited = true;
    s = isotropic_stress(m, c + identity(deficit)) - identity(0.5 * m.youngs_modulus * deficit);
  } else {
    s = isotropic_stress(m, c);
  }
  if (has_fibre(m, fibre)) {
    const double f = fibre_stress(m, fibre_strain(metric, fibre));
    s = s + SheetTensor{f * fibre.x() * fibre.x(), f * fibre.y() * fibre.y(), f * fibre.x() * fibre.y()};
  }
  return s;
}

double sheet_energy(const SheetMaterial& m, const SheetTensor& metric, const Eigen::Vector2d& fibre) {
  SheetTensor c = metric;
  if (m.narrow) c.yy = sideways_metric(m, std::max(c.xx, smallest_metric));
  const double deficit = std::max(0.0, smallest_metric - smallest_eigenvalue(c));
  c = c + identity(deficit);
  double energy = 0;
  if (m.law == ElasticLaw::neo_hookean || m.law == ElasticLaw::fibre_reinforced) {
    const double thickness = m.narrow ? c.yy : neo_hookean_thickness(m, c.determinant());
    const double log_j = 0.5 * std::log(c.determinant() * thickness);
    energy = 0.5 * m.shear_modulus * (c.trace() + thickness - 3 - 2 * log_j) + 0.5 * m.lame_lambda * log_j * log_j;
  } else {
    const SheetTensor e = m.law == ElasticLaw::st_venant_kirchhoff ? (c - identity()) * 0.5 : square_root(c) - identity();
    energy = 0.5 * hooke(m, e).dot(e);
  }
  if (deficit > 0)  // the constant-stiffness continuation below smallest_metric: isotropic, along the diagonal
    energy += -0.5 * isotropic_stress(m, c).trace() * deficit + 0.25 * m.youngs_modulus * deficit * deficit;
  if (has_fibre(m, fibre)) {
    const double x = fibre_strain(metric, fibre), y = std::min(x, m.fibre_limit), k2 = m.fibre_stiffening;
    if (x > 0) energy += 0.5 * m.fibre_modulus * (k2 > 0 ? std::expm1(k2 * y * y) / k2 : y * y);
    if (x > y) energy += 0.5 * (fibre_stress(m, y) * (x - y) + 0.5 * fibre_stress_slope(m, y) * (x - y) * (x - y));
  }
  return energy;
}

double thickness_metric(const SheetMaterial& m, const SheetTensor& metric) {
  if (m.narrow) return sideways_metric(m, std::max(metric.xx, smallest_metric));
  const SheetTensor c = metric + identity(std::max(0.0, smallest_metric - smallest_eigenvalue(metric)));
  const double ratio = m.poisson_ratio / (1 - m.poisson_ratio);
  switch (m.law) {
    case ElasticLaw::st_venant_kirchhoff:
      return std::max(0.05, 1 - ratio * (c.trace() - 2));
    case ElasticLaw::linear:
    case ElasticLaw::corotated: {
      const double stretch = std::max(0.2, 1 - ratio * (square_root(c).trace() - 2));
      return stretch * stretch;
    }
    default:
      return neo_hookean_thickness(m, c.determinant());
  }
}

double largest_tangent(const SheetMaterial& m, const SheetTensor& metric, const Eigen::Vector2d& fibre) {
  const double small_strain = m.sheet_lambda + 2 * m.shear_modulus;
  const double smallest = std::max(smallest_metric, smallest_eigenvalue(metric));
  double tangent = small_strain;
  if (m.law == ElasticLaw::st_venant_kirchhoff) {
    const double largest = metric.trace() - smallest;
    tangent *= std::max(1.0, 1.5 * largest - 0.5);
  } else if (smallest < 1) {
    tangent /= smallest;
  }
  if (has_fibre(m, fibre)) {
    const double x = fibre_strain(metric, fibre);
    tangent += x > -0.02 ? 2 * (1 + std::max(0.0, x)) * fibre_stress_slope(m, std::max(x, 1e-9)) + fibre_stress(m, x) : 0.0;
  }
  return tangent;
}

double limit_pressure(const SheetMaterial& m, double thickness, double radius) {
  if (m.law != ElasticLaw::neo_hookean) return std::numeric_limits<double>::infinity();
  return m.shear_modulus * thickness / radius;
}

}  // namespace sim
