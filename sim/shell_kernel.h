// Inside shells: one particle's kinematics, its energy's derivatives, and the gathering of forces. Used by the force, energy, stress and
// sub-step routines, so that each formula stands once.
#pragma once

#include <cmath>
#include <cstring>

#include "sim/shell.h"

namespace sim::shell_kernel {

template <int D>
constexpr int terms = ShellElasticity<D>::terms;

// Deformed tangents and second derivatives of one particle: value[0..D-2] = a_a, then H11 (H22 H12).
template <int D>
struct Kinematics {
  std::array<Padded<D>, terms<D>> value;
  Padded<D> normal;       // unit
  SheetTensor metric;     // C
  SheetTensor curvature;  // kappa = n . H - kappa0
  double area_ratio = 1;  // current over rest area
};

// Through registers alone: a vector put together number by number could only be read again once all its stores are done.
inline Padded<3> cross(const Padded<3>& a, const Padded<3>& b) {
  typedef double Four __attribute__((vector_size(32)));
  Four u, v;
  std::memcpy(&u, a.data(), sizeof u);
  std::memcpy(&v, b.data(), sizeof v);
  const Four product = __builtin_shufflevector(u, u, 1, 2, 0, 3) * __builtin_shufflevector(v, v, 2, 0, 1, 3) -
                       __builtin_shufflevector(u, u, 2, 0, 1, 3) * __builtin_shufflevector(v, v, 1, 2, 0, 3);
  Padded<3> result;
  std::memcpy(result.data(), &product, sizeof product);
  return result;
}

inline Padded<2> normal_of(const std::array<Padded<2>, 2>& b, double& length) {
  length = std::sqrt(b[0].squaredNorm());
  return Padded<2>(-b[0].y(), b[0].x()) / std::max(length, 1e-300);
}
inline Padded<3> normal_of(const std::array<Padded<3>, 5>& b, double& length) {
  const Padded<3> n = cross(b[0], b[1]);
  length = std::sqrt(n.squaredNorm());
  return n / std::max(length, 1e-300);
}

template <int D>
bool is_clamped(const ShellElasticity<D>& shells, std::int32_t i) {
  return (shells.fixed[i] & ((1 << D) - 1)) == (1 << D) - 1;
}

// Normal, metric and curvature from the fitted terms (a clamped particle's normal is its rest normal).
template <int D>
void complete(const ShellElasticity<D>& shells, std::int32_t i, Kinematics<D>& k) {
  const auto& b = k.value;
  const SheetTensor& rest = shells.rest_curvature[i];
  k.normal = normal_of(b, k.area_ratio);
  if (is_clamped(shells, i)) k.normal = pad<D>(shells.normal[i]);
  if constexpr (D == 2) {
    k.metric = {b[0].squaredNorm(), 1, 0};
    k.curvature = {k.normal.dot(b[1]) - rest.xx, 0, 0};
  } else {
    k.metric = {b[0].squaredNorm(), b[1].squaredNorm(), b[0].dot(b[1])};
    k.curvature = {k.normal.dot(b[2]) - rest.xx, k.normal.dot(b[3]) - rest.yy, k.normal.dot(b[4]) - rest.xy};
  }
}

// a_a = sum g d, H = sum q d; C = a.a; kappa = n.H - kappa0.
template <int D>
Kinematics<D> kinematics(const ShellElasticity<D>& shells, const Padded<D>* x, std::int32_t i) {
  constexpr int count = terms<D>;
  std::array<Padded<D>, count> sum;
  for (auto& b : sum) b.setZero();
  if (is_clamped(shells, i))
    for (int a = 0; a < D - 1; ++a) sum[a] = shells.held_tangent[i][a];
  const Padded<D> center = x[i];
  const double* fit = &shells.fit[static_cast<std::size_t>(shells.start[i]) * count];
  for (std::int32_t p = shells.start[i]; p < shells.start[i + 1]; ++p, fit += count) {
    const Padded<D> d = x[shells.neighbor[p]] - center;
    for (int t = 0; t < count; ++t) sum[t] += fit[t] * d;
  }
  Kinematics<D> k;
  k.value = sum;
  complete(shells, i, k);
  return k;
}

// gamma_k,ab = (a_a . H_kb + a_b . H_ka) / 2: derivative of the strain along tangent k.
inline SheetTensor strain_gradient(const Kinematics<2>& k, int) { return {k.value[0].dot(k.value[1]), 0, 0}; }
inline SheetTensor strain_gradient(const Kinematics<3>& k, int direction) {
  const auto& b = k.value;
  const Padded<3>& h1 = direction == 0 ? b[2] : b[4];
  const Padded<3>& h2 = direction == 0 ? b[4] : b[3];
  return {b[0].dot(h1), b[1].dot(h2), 0.5 * (b[0].dot(h2) + b[1].dot(h1))};
}

inline SheetTensor plane_stress_hooke(const SheetMaterial& m, const SheetTensor& e) {
  const double l = m.sheet_lambda * e.trace(), g = 2 * m.shear_modulus;
  return {l + g * e.xx, l + g * e.yy, g * e.xy};
}

// tau : d gamma_k added to the derivatives.
inline void add_strain_gradient(const Kinematics<2>& k, int, const SheetTensor& tau, std::array<Padded<2>, 2>& out) {
  out[0] += tau.xx * k.value[1];
  out[1] += tau.xx * k.value[0];
}
inline void add_strain_gradient(const Kinematics<3>& k, int direction, const SheetTensor& tau, std::array<Padded<3>, 5>& out) {
  const auto& b = k.value;
  const int first = direction == 0 ? 2 : 4, second = direction == 0 ? 4 : 3;  // H_k1, H_k2
  out[0] += tau.xx * b[first] + tau.xy * b[second];
  out[1] += tau.xy * b[first] + tau.yy * b[second];
  out[first] += tau.xx * b[0] + tau.xy * b[1];
  out[second] += tau.xy * b[0] + tau.yy * b[1];
}

// Dual tangents a^a of the current surface times -(y . a^a) n: what a change of the normal does (dn = -a^a (n . da_a)).
inline void add_normal_change(const Kinematics<2>& k, const Padded<2>& y, std::array<Padded<2>, 2>& out) {
  out[0] -= (y.dot(k.value[0]) / k.metric.xx) * k.normal;
}
inline void add_normal_change(const Kinematics<3>& k, const Padded<3>& y, std::array<Padded<3>, 5>& out) {
  const double y1 = y.dot(k.value[0]), y2 = y.dot(k.value[1]), f = 1 / k.metric.determinant();
  out[0] -= ((k.metric.yy * y1 - k.metric.xy * y2) * f) * k.normal;
  out[1] -= ((k.metric.xx * y2 - k.metric.xy * y1) * f) * k.normal;
}

// The held rows behind a clamp's face store no energy.
template <int D>
bool idle(const ShellElasticity<D>& shells, std::int32_t i) {
  return shells.membrane_weight[i] == 0;
}

// Derivatives of one particle's energy by its fitted terms, N m (a_a) and N m2 (H): force = sum derivative * fit. Returns whether the law
// was limited.
template <int D>
bool energy_derivatives(const ShellElasticity<D>& shells, std::int32_t i, const Kinematics<D>& k, std::array<Padded<D>, terms<D>>& out) {
  const ShellBody& body = shells.bodies[shells.body[i]];
  const SheetMaterial& material = body.material;
  const double volume = shells.area[i] * body.thickness * shells.stiffness_scale[i];
  const double z = body.bending_thickness / (2 * std::sqrt(3.0));
  bool limited = false;
  const SheetTensor upper = sheet_stress(material, k.metric - k.curvature * (2 * z), shells.fibre[i], &limited);
  const SheetTensor lower = sheet_stress(material, k.metric + k.curvature * (2 * z), shells.fibre[i], &limited);
  SheetTensor n = (upper + lower) * (0.5 * volume * shells.bending_weight[i]);
  if (shells.membrane_weight[i] != shells.bending_weight[i])
    n = n + sheet_stress(material, k.metric, shells.fibre[i]) * (volume * (shells.membrane_weight[i] - shells.bending_weight[i]));
  const SheetTensor m = (lower - upper) * (0.5 * z * volume * shells.bending_weight[i]);
  const auto& b = k.value;
  Padded<D> y;  // derivative by the normal
  if constexpr (D == 2) {
    out[0] = n.xx * b[0];
    out[1] = m.xx * k.normal;
    y = m.xx * b[1];
  } else {
    out[0] = n.xx * b[0] + n.xy * b[1];
    out[1] = n.xy * b[0] + n.yy * b[1];
    out[2] = m.xx * k.normal;
    out[3] = m.yy * k.normal;
    out[4] = 2 * m.xy * k.normal;
    y = m.xx * b[2] + m.yy * b[3] + 2 * m.xy * b[4];
  }
  if (is_clamped(shells, i)) return limited;
  const double cell = volume * (D == 3 ? shells.area[i] : shells.area[i] * shells.area[i]) / 12;
  for (int direction = 0; direction < D - 1; ++direction)
    add_strain_gradient(k, direction, plane_stress_hooke(material, strain_gradient(k, direction)) * cell, out);
  add_normal_change(k, y, out);
  return limited;
}

// Elastic force on row j: minus what its pairs as a neighbour carry, plus what it owns.
template <int D>
Padded<D> gather_force(const ShellElasticity<D>& shells, const std::array<Padded<D>, terms<D>>* derivative, std::int32_t j) {
  constexpr int count = terms<D>;
  std::array<Padded<D>, count> sum;  // one chain per term: the additions overlap
  const double* fit = &shells.fit_sum[static_cast<std::size_t>(j) * count];
  for (int a = 0; a < count; ++a) sum[a] = fit[a] * derivative[j][a];
  fit = shells.reverse_fit.data() + static_cast<std::size_t>(shells.reverse_start[j]) * count;
  for (std::int32_t s = shells.reverse_start[j]; s < shells.reverse_start[j + 1]; ++s, fit += count) {
    const auto& t = derivative[shells.reverse_owner[s]];
    for (int a = 0; a < count; ++a) sum[a] -= fit[a] * t[a];
  }
  Padded<D> force = sum[0];
  for (int a = 1; a < count; ++a) force += sum[a];
  return force;
}

// Axial dashpot f = mass eta (closing speed) and, outside stretches 0.4 to 1.8, a spring of 0.5 E h (numerics-elastic.md 3(iii).3).
template <int D>
Padded<D> bond_force(const ShellElasticity<D>& shells, const Padded<D>* x, const Padded<D>* v, std::int32_t i, bool& limited) {
  Padded<D> force = Padded<D>::Zero();
  const double eta = shells.axial_dashpot;
  const ShellBody& body = shells.bodies[shells.body[i]];
  const double spring = 0.5 * body.material.youngs_modulus * body.thickness * (D == 3 ? 1.0 : 1 / body.spacing);
  for (std::int32_t p = shells.bond_start[i]; p < shells.bond_start[i + 1]; ++p) {
    const std::int32_t j = shells.bond[p];
    const Padded<D> d = x[j] - x[i];
    const double squared = d.squaredNorm(), rest = shells.bond_length[p];
    if (eta > 0) force += (shells.bond_mass[p] * eta * (v[j] - v[i]).dot(d) / std::max(squared, 1e-4 * rest * rest)) * d;
    const double ratio = squared / (rest * rest);
    if (ratio > 3.24 || ratio < 0.16) {
      limited = true;
      const double length = std::max(std::sqrt(squared), 0.01 * rest);
      force += (spring * (length - (ratio > 1 ? 1.8 : 0.4) * rest) / length) * d;
    }
  }
  return force;
}

// Viscous bending: the moment beta dn.H/dt, beta = eta m s^4 / 16, whose force on a row of the alternating wave (dn.H/dt = 4 v / s^2) is
// eta m v. Waves of length L die out at about eta (2 s / L)^4: it is there for those that blood and elastic sub-steps see differently.
template <int D>
void add_bending_dashpot(const ShellElasticity<D>& shells, const Padded<D>* v, std::int32_t i, const Padded<D>& normal,
                         std::array<Padded<D>, terms<D>>& derivative) {
  constexpr int count = terms<D>, first = D - 1;
  std::array<double, count> rate{};
  const double* fit = &shells.fit[static_cast<std::size_t>(shells.start[i]) * count];
  for (std::int32_t p = shells.start[i]; p < shells.start[i + 1]; ++p, fit += count) {
    const double jump = (v[shells.neighbor[p]] - v[i]).dot(normal);
    for (int t = first; t < count; ++t) rate[t] += fit[t] * jump;
  }
  const double s2 = D == 3 ? shells.area[i] : shells.area[i] * shells.area[i];
  const double beta = shells.bending_dashpot * shells.mass[i] * s2 * s2 / (D == 3 ? 32 : 16);
  for (int t = first; t < count; ++t) derivative[t] += (beta * rate[t] * (t == 4 ? 2 : 1)) * normal;
}

// Everything one row owns: derivatives, the bond force on it and its normal. Returns whether a limiter acted.
template <int D>
bool differentiate_row(const ShellElasticity<D>& shells, const Padded<D>* x, const Padded<D>* v, std::int32_t i,
                       std::array<Padded<D>, terms<D>>& derivative, Padded<D>& own, Padded<D>& normal) {
  if (idle(shells, i)) {
    for (auto& t : derivative) t.setZero();
    own.setZero();
    normal = pad<D>(shells.normal[i]);
    return false;
  }
  const Kinematics<D> k = kinematics(shells, x, i);
  normal = k.normal;
  bool limited = energy_derivatives(shells, i, k, derivative);
  if (shells.bending_dashpot > 0 && !is_clamped(shells, i)) add_bending_dashpot(shells, v, i, k.normal, derivative);
  own = bond_force(shells, x, v, i, limited);
  return limited;
}

}  // namespace sim::shell_kernel
