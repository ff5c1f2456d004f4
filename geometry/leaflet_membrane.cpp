#include "geometry/leaflet_membrane.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace geometry {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector3d;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

struct RestTriangle {
  Matrix2d inverse;  // of the rest edges in the triangle's plane
  double area;
};

RestTriangle rest_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d e = (b - a).normalized(), normal = (b - a).cross(c - a).normalized(), f = normal.cross(e);
  Matrix2d edges;
  edges << (b - a).dot(e), (c - a).dot(e), (b - a).dot(f), (c - a).dot(f);
  return {edges.inverse(), 0.5 * edges.determinant()};
}

// Second Piola-Kirchhoff tension, N/m: St Venant-Kirchhoff in plane stress, with little resistance to compression along each principal
// direction.
Matrix2d tension(const Matrix2d& strain, const MembraneProblem& problem) {
  const double half_trace = 0.5 * strain.trace(), half_difference = 0.5 * (strain(0, 0) - strain(1, 1));
  const double radius = std::hypot(half_difference, strain(0, 1));
  const double modulus = problem.tension_modulus / (1 - problem.poisson_ratio * problem.poisson_ratio);
  double first = modulus * ((half_trace + radius) + problem.poisson_ratio * (half_trace - radius));
  double second = modulus * ((half_trace - radius) + problem.poisson_ratio * (half_trace + radius));
  if (first < 0) first *= problem.compression_share;
  if (second < 0) second *= problem.compression_share;
  Matrix2d result = 0.5 * (first + second) * Matrix2d::Identity();
  if (radius > 0) {
    Matrix2d deviator;
    deviator << half_difference, strain(0, 1), strain(0, 1), -half_difference;
    result += 0.5 * (first - second) / radius * deviator;
  }
  return result;
}

}  // namespace

int relax_membrane(const MembraneProblem& problem, std::vector<Vector3d>& position) {
  const std::size_t nodes = position.size();
  std::vector<RestTriangle> rest;
  std::vector<double> mass(nodes, 0);  // of the relaxation, a multiple of the stiffness so that a step of 1 is stable
  const double modulus = problem.tension_modulus / (1 - problem.poisson_ratio * problem.poisson_ratio);
  for (const auto& t : problem.triangles) {
    rest.push_back(rest_triangle(problem.rest[t[0]], problem.rest[t[1]], problem.rest[t[2]]));
    const Matrix2d& g = rest.back().inverse;  // rows: gradients of the second and third node's shape functions
    const Eigen::Vector2d g1 = g.row(0), g2 = g.row(1), g0 = -g1 - g2;
    mass[t[0]] += 3 * modulus * rest.back().area * g0.squaredNorm();
    mass[t[1]] += 3 * modulus * rest.back().area * g1.squaredNorm();
    mass[t[2]] += 3 * modulus * rest.back().area * g2.squaredNorm();
  }
  for (const auto& line : problem.lines)
    for (auto node : line) mass[node] += 8 * problem.bending;
  std::vector<Vector3d> velocity(nodes, Vector3d::Zero()), force(nodes);
  double last_energy = 0;
  for (int iteration = 0; iteration < problem.iterations; ++iteration) {
    std::fill(force.begin(), force.end(), Vector3d::Zero());
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const auto& t = problem.triangles[k];
      Matrix32 edges;
      edges.col(0) = position[t[1]] - position[t[0]];
      edges.col(1) = position[t[2]] - position[t[0]];
      const Matrix32 gradient = edges * rest[k].inverse;
      const Matrix2d strain = 0.5 * (gradient.transpose() * gradient - Matrix2d::Identity());
      const Matrix32 pull = -rest[k].area * gradient * tension(strain, problem) * rest[k].inverse.transpose();
      const Vector3d push = -problem.pressure / 6 * Vector3d(edges.col(0).cross(edges.col(1)));
      force[t[1]] += pull.col(0) + push;
      force[t[2]] += pull.col(1) + push;
      force[t[0]] += push - pull.col(0) - pull.col(1);
    }
    for (const auto& [a, middle, b] : problem.lines) {
      const Vector3d pull = problem.bending * (position[a] - 2 * position[middle] + position[b]);
      force[a] -= pull;
      force[middle] += 2 * pull;
      force[b] -= pull;
    }
    double energy = 0, farthest = 0;
    for (std::size_t i = 0; i < nodes; ++i) {
      if (problem.fixed[i]) continue;
      velocity[i] += force[i] / mass[i];
      Vector3d next = position[i] + velocity[i];
      problem.confine(next);
      velocity[i] = next - position[i];  // what the confinement takes away is no speed
      position[i] = next;
      energy += mass[i] * velocity[i].squaredNorm();
      farthest = std::max(farthest, velocity[i].squaredNorm());
    }
    if (energy < last_energy) {  // past a peak of kinetic energy: start again from rest
      std::fill(velocity.begin(), velocity.end(), Vector3d::Zero());
      energy = 0;
      if (farthest < problem.tolerance * problem.tolerance) return iteration + 1;
    }
    last_energy = energy;
  }
  return problem.iterations;
}

}  // namespace geometry
