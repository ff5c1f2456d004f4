#include "sim/paper_elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "sim/solid_bodies.h"
#include "sim/stress.h"

namespace {

using namespace sim;

// A cube of `side` particles, l0 = 1, with the given kernel radius.
PaperElasticity<3> cube(int side, double radius, double nu, std::vector<Vector<3>>& position) {
  ElasticMaterial material;
  material.poisson_ratio = nu;
  auto scene = solid_bodies::box<3>({0, 0, 0}, Vector<3>::Constant(side), 1, material, [](const Vector<3>&) { return 0; });
  scene.scheme.elastic_kernel_radius = radius;
  position = scene.particles.position;
  return build_paper_elasticity(scene);
}

// 3 sum w x^2 y^2 / r^4 / sum w (mixed) and 3 sum w x^4 / r^4 / sum w (pure) of the cubic lattice: 1/5 and 3/5 if directions were evenly
// spread.
void lattice_moments(double radius, double& mixed, double& pure) {
  double sum = 0;
  mixed = pure = 0;
  for (int i = -5; i <= 5; ++i)
    for (int j = -5; j <= 5; ++j)
      for (int k = -5; k <= 5; ++k) {
        const double squared = i * i + j * j + k * k, r = std::sqrt(squared);
        if (r == 0 || r >= radius) continue;
        const double w = radius / r - 1;
        sum += w;
        mixed += 3 * w * i * i * j * j / (squared * squared);
        pure += 3 * w * i * i * i * i / (squared * squared);
      }
  mixed /= sum, pure /= sum;
}

// The operator on a quadratic displacement at the middle of a cube gives the moduli that the scheme simulates: with the lattice's own
// moments to round-off, with those of evenly spread directions (the closed form) to what the cubic lattice differs from them.
TEST(PaperElasticity, SimulatesTheDerivedEffectiveMaterial) {
  double mixed, pure;
  lattice_moments(4.2, mixed, pure);
  EXPECT_NEAR(mixed, 0.2, 0.02);
  EXPECT_NEAR(pure, 0.6, 0.04);
  for (const double nu : {0.3, 0.45, 0.49}) {
    std::vector<Vector<3>> position;
    const PaperElasticity<3> body = cube(17, 4.2, nu, position);
    const LameModuli own = lame_moduli(1e6, nu), expected = paper_effective_moduli(own, 3);
    EXPECT_NEAR(expected.shear_modulus, 0.7 * own.shear_modulus + 0.2 * own.lame_lambda, 1e-6);
    EXPECT_NEAR(expected.lame_lambda, 0.2 * (own.shear_modulus + own.lame_lambda), 1e-6);
    const std::size_t middle = position.size() / 2;
    const double a = 1e-6;
    const auto response = [&](int axis) {  // u_x = a s^2: lap u = 2a; grad div u = 0 for s = y, 2a for s = x
      std::vector<Vector<3>> moved = position, force(position.size());
      std::vector<Tensor<3>> rotation(position.size());
      for (auto& x : moved) x(0) += a * std::pow(x(axis) - position[middle](axis), 2);
      paper_rotations<3>(body, moved, rotation);
      paper_elastic_force<3>(body, moved, rotation, force);
      return force[middle](0) / (2 * a);
    };
    const double sum = own.lame_lambda + own.shear_modulus, shear = response(1), both = response(0);
    EXPECT_NEAR(shear / (0.5 * own.shear_modulus + mixed * sum), 1, 1e-6) << nu;
    EXPECT_NEAR(both / (own.shear_modulus + pure * sum), 1, 1e-6) << nu;
    EXPECT_NEAR(shear / expected.shear_modulus, 1, 0.1) << nu;
    EXPECT_NEAR(both / (expected.lame_lambda + 2 * expected.shear_modulus), 1, 0.1) << nu;
  }
}

// Rotations are removed (Eq 24): a rigid turn by 90 degrees makes no force and no stress.
TEST(PaperElasticity, RigidRotationMakesNoForce) {
  std::vector<Vector<3>> position;
  const PaperElasticity<3> body = cube(5, 2.1, 0.49, position);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (auto& x : position) x = turn * x;
  std::vector<Tensor<3>> rotation(position.size());
  std::vector<Vector<3>> force(position.size());
  paper_rotations<3>(body, position, rotation);
  paper_elastic_force<3>(body, position, rotation, force);
  std::vector<Eigen::Matrix3d> stress;
  paper_stress<3>(body, position, stress);
  for (std::size_t i = 0; i < position.size(); ++i) {
    EXPECT_LT(force[i].norm(), 1e-5);
    EXPECT_LT(stress[i].norm(), 1e-5);
  }
}

// Stress of a uniform stretch, inside: Eq (16) is exact on the full lattice; at a face the fixed n0 makes it too small.
TEST(PaperElasticity, StressIsHookeInsideAndTooSmallAtFaces) {
  std::vector<Vector<3>> position;
  const PaperElasticity<3> body = cube(7, 2.1, 0.3, position);
  const double stretch = 1e-4;
  for (auto& x : position) x(0) *= 1 + stretch;
  std::vector<Eigen::Matrix3d> stress;
  paper_stress<3>(body, position, stress);
  const LameModuli m = lame_moduli(1e6, 0.3);
  const double exact = (m.lame_lambda + 2 * m.shear_modulus) * stretch;
  const std::size_t middle = 7 * 7 * 7 / 2, face = 3 + 7 * 3;  // z = 0
  EXPECT_NEAR(stress[middle](0, 0), exact, 1e-3 * exact);
  EXPECT_LT(stress[face](0, 0), 0.95 * exact);
}

// Eq (20) with all forces at t + dt damps by exp(-pi omega dt) a period; the step is stable and converges.
TEST(PaperElasticity, ImplicitStepDampsAsDerived) {
  ElasticMaterial material;
  material.poisson_ratio = 0.3;
  auto scene = solid_bodies::box<2>({-2, 0}, {16, 4}, 1, material, [](const Vector<2>& x) -> std::uint8_t { return x(0) < 0 ? 3 : 0; });
  const PaperElasticity<2> body = build_paper_elasticity(scene);
  std::vector<Vector<2>> position = body.rest, velocity(body.size(), Vector<2>::Zero());
  for (std::size_t i = 0; i < body.size(); ++i)
    if (!body.fixed[i]) velocity[i](1) = 1e-3 * body.rest[i](0) * body.rest[i](0);
  const double step = 0.1;
  std::vector<double> peaks;
  double last = 0, before = 0;
  std::vector<double> times;
  for (int s = 0; s < 175; ++s) {
    const PaperStepReport report = paper_elastic_step<2>(body, {}, step, 100, position, velocity);
    ASSERT_TRUE(report.converged) << "step " << s;
    const double tip = position.back()(1) - body.rest.back()(1);
    if (last > before && last > tip && last > 0) {
      peaks.push_back(last);
      times.push_back(s * step);
    }
    before = last;
    last = tip;
  }
  ASSERT_GE(peaks.size(), 2u);
  const double period = times[1] - times[0], omega = 2 * M_PI / period;
  EXPECT_NEAR(peaks[1] / peaks[0], std::exp(-M_PI * omega * step), 0.08);
}

}  // namespace
