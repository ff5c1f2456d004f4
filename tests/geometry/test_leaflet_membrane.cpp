#include "geometry/leaflet_membrane.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace geometry;
using Eigen::Vector3d;

MembraneProblem strip(int along, double length, double width) {
  MembraneProblem problem;
  for (int i = 0; i <= along; ++i)
    for (int j = 0; j < 2; ++j) {
      problem.rest.emplace_back(length * i / along, width * j, 0);
      problem.fixed.push_back(i == 0 || i == along);
    }
  for (int i = 0; i < along; ++i) {
    const int a = 2 * i;
    problem.triangles.push_back({a, a + 2, a + 3});
    problem.triangles.push_back({a, a + 3, a + 1});
  }
  problem.confine = [](Vector3d& p) { p.y() = std::round(p.y() * 1e3) / 1e3; };
  return problem;
}

// A strip held along two edges bulges into a circular arc: tension T = p R, stretch = arc / chord, T = stretch E' (stretch² - 1) / 2.
TEST(LeafletMembrane, PressurisedStripIsAnArc) {
  MembraneProblem problem = strip(40, 0.02, 1e-3);
  problem.tension_modulus = 1000;
  problem.poisson_ratio = 0.3;
  problem.pressure = 2000;
  problem.iterations = 200000;
  problem.tolerance = 1e-9;
  std::vector<Vector3d> position = problem.rest;
  for (Vector3d& p : position) p.z() = -1e-4 * std::sin(p.x() / 0.02 * 3.14159);
  relax_membrane(problem, position);
  const double modulus = 1000 / (1 - 0.09);
  double low = 0.010001, high = 10;  // radius of the arc over a chord of 20 mm
  for (int i = 0; i < 200; ++i) {
    const double radius = 0.5 * (low + high), half = std::asin(0.01 / radius), stretch = half * radius / 0.01;
    (stretch * modulus * 0.5 * (stretch * stretch - 1) > 2000 * radius ? low : high) = radius;
  }
  const double sag = low - std::sqrt(low * low - 1e-4);
  EXPECT_NEAR(position[40].z(), -sag, 0.01 * sag);  // away from the right-hand normal
}

TEST(LeafletMembrane, UnloadedMembraneStaysAtRest) {
  MembraneProblem problem = strip(10, 0.02, 1e-3);
  std::vector<Vector3d> position = problem.rest;
  relax_membrane(problem, position);
  for (std::size_t i = 0; i < position.size(); ++i) EXPECT_NEAR((position[i] - problem.rest[i]).norm(), 0, 1e-15);
}

}  // namespace
