// Stress of elastic solids as it is shown, and values at any point of the rest configuration.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/solid.h"

namespace sim {

// Cauchy stress of every row, Pa, full 3x3 tensors (stress.h gives von Mises and principal values). The pressure-like part
// (lambda - lambda_h) theta uses the column's mean where the row shares its volumetric strain, otherwise a linear least-squares smoothing
// of theta over the particle's neighbours: exact for linear fields, and free of the noise that a large lambda makes of small differences.
// Rows that are held entirely have no stress of their own: 0. work is refreshed for these positions.
template <int D>
void solid_stress(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work,
                  std::vector<Eigen::Matrix3d>& cauchy);

// A point of the rest configuration, on the surface too. row -1: the point lies in a part that is held, far from any free particle.
template <int D>
struct SolidPoint {
  std::int32_t row = -1;                 // nearest free particle of the body
  bool held = false;                     // a held particle is nearer: displacement 0
  Vector<D> offset = Vector<D>::Zero();  // m
};
// body -1: any body. Throws std::invalid_argument where there is no such body.
template <int D>
SolidPoint<D> locate_in_solid(const SolidElasticity<D>& solid, std::int32_t body, const Vector<D>& rest_point);

// Displacement there, m: u_i + Y m(offset), exact for quadratic displacements. work.derivatives must stand for these positions.
template <int D>
Vector<D> displacement_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Vector<D>> position,
                          const SolidWork<D>& work);

// A vector field of the rows (velocity) there, from the same fit.
template <int D>
Vector<D> interpolate_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Vector<D>> field);

// Cauchy stress there, Pa: linear least squares over the nearest particle's neighbourhood, so exact for linear stress, on the surface too.
template <int D>
Eigen::Matrix3d stress_at(const SolidElasticity<D>& solid, const SolidPoint<D>& point, std::span<const Eigen::Matrix3d> cauchy);

}  // namespace sim
