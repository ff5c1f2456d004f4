// A small membrane relaxation: finds the slightly open, nearly stress-free form of a leaflet.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace geometry {

struct MembraneProblem {
  std::vector<Eigen::Vector3d> rest;                   // m, stress-free lengths
  std::vector<std::array<std::int32_t, 3>> triangles;  // pressure pushes against their right-hand normal
  std::vector<std::uint8_t> fixed;                     // a node: 1 stays
  double tension_modulus = 1000;                       // E t, N/m
  double poisson_ratio = 0.45;
  double compression_share = 0.03;  // of the stiffness that is left under compression (wrinkling)
  // Against crumpling: a spring of `bending` N/m on the second difference of three nodes in line (a, middle, b).
  std::vector<std::array<std::int32_t, 3>> lines;
  double bending = 0;
  double pressure = 0;                            // Pa
  std::function<void(Eigen::Vector3d&)> confine;  // puts a node back to where it may be
  int iterations = 6000;
  double tolerance = 1e-7;  // stop when no node moves more than this in an iteration, m
};

// Moves `position` (start: any shape) to equilibrium by dynamic relaxation with kinetic damping (Barnes 1999). Returns iterations used.
int relax_membrane(const MembraneProblem& problem, std::vector<Eigen::Vector3d>& position);

}  // namespace geometry
