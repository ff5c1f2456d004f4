// Stress of every elastic particle as it is shown and probed.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/scene.h"

namespace sim {

// Cauchy stress, Pa, of rows [0, elastic_count + shell_count). A shell row has the stress of the face with the larger von Mises stress.
template <int D>
std::vector<Eigen::Matrix3d> elastic_stress(const Scene<D>& scene, const State<D>& state);

// Of shell rows alone, at both faces and in the middle.
struct ShellStress {
  std::vector<Eigen::Matrix3d> minus, middle, plus;
};
template <int D>
ShellStress faces_stress(const Scene<D>& scene, const State<D>& state);

// Deformation gradient's determinant of the rows of solids (1 where undeformed).
template <int D>
std::vector<double> volume_ratio(const Scene<D>& scene, const State<D>& state);

}  // namespace sim
