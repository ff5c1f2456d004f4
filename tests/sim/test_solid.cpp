#include "sim/solid.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "sim/solid_bodies.h"
#include "sim/solid_fit.h"
#include "sim/solid_surface.h"
#include "sim/solid_tangent.h"

namespace {

using namespace sim;
using solid_bodies::box;

template <int D>
std::uint8_t nothing_fixed(const Vector<D>&) {
  return 0;
}

ElasticMaterial material(ElasticLaw law, double poisson_ratio) {
  ElasticMaterial m;
  m.law = law;
  m.poisson_ratio = poisson_ratio;
  return m;
}

template <int D>
Vector<D> corner(double value) {
  return Vector<D>::Constant(value);
}

// A box of 5 x 4 (x 3) cells clamped at x < 0; `jitter` in spacings.
template <int D>
SolidElasticity<D> clamped_box(ElasticLaw law, double poisson_ratio, double jitter = 0, int layers = 3) {
  Vector<D> low = corner<D>(0), high = corner<D>(layers);
  low(0) = -2;
  high(0) = 5;
  auto scene = box<D>(low, high, 1, material(law, poisson_ratio), [](const Vector<D>& x) -> std::uint8_t { return x(0) < 0 ? 7 : 0; });
  for (auto& mask : scene.particles.fixed) mask &= (1 << D) - 1;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-jitter, jitter);
  for (auto& x : scene.particles.position)
    for (int k = 0; k < D; ++k) x(k) += jitter > 0 ? uniform(random) : 0;
  return build_solids(scene);
}

template <int D>
std::vector<Vector<D>> displaced(const SolidElasticity<D>& solid, double size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vector<D>> position = solid.rest;
  for (std::size_t i = 0; i < position.size(); ++i)
    for (int k = 0; k < D; ++k)
      if (!(solid.fixed[i] >> k & 1)) position[i](k) += uniform(random);
  return position;
}

// Forces are minus the gradient of the energy, the tangent minus the gradient of the forces (central differences).
template <int D>
void check_derivatives(const SolidElasticity<D>& solid) {
  std::vector<Vector<D>> position = displaced(solid, 0.05), force(solid.size()), up(solid.size()), down(solid.size());
  SolidWork<D> work;
  solid_forces<D>(solid, position, work, force);
  const SolidPattern<D> pattern = solid_pattern(solid);
  Eigen::SparseMatrix<double> lower;
  assemble_tangent<D>(solid, pattern, position, work, lower);
  const Eigen::SparseMatrix<double> full = lower.template selfadjointView<Eigen::Lower>();
  double largest = 0;
  for (const auto& f : force) largest = std::max(largest, f.norm());
  const double h = 1e-5;
  for (std::size_t i = 0; i < solid.size(); i += 5)
    for (int k = 0; k < D; ++k) {
      const std::int32_t dof = pattern.dof[i * D + k];
      if (dof < 0) continue;
      const double x = position[i](k);
      position[i](k) = x + h;
      const double e_up = solid_energy<D>(solid, position, work);
      solid_forces<D>(solid, position, work, up);
      position[i](k) = x - h;
      const double e_down = solid_energy<D>(solid, position, work);
      solid_forces<D>(solid, position, work, down);
      position[i](k) = x;
      EXPECT_NEAR(force[i](k), -(e_up - e_down) / (2 * h), 1e-6 * largest);
      const Eigen::VectorXd slope = (gather<D>(pattern, down) - gather<D>(pattern, up)) / (2 * h);
      EXPECT_LT((slope - full.col(dof)).norm(), 1e-6 * full.col(dof).norm());
    }
}

TEST(Solid, ForcesAndTangentAreDerivativesOfTheEnergy) {
  check_derivatives<2>(clamped_box<2>(ElasticLaw::neo_hookean, 0.45));
  check_derivatives<2>(clamped_box<2>(ElasticLaw::st_venant_kirchhoff, 0.3, 0.1));
  check_derivatives<2>(clamped_box<2>(ElasticLaw::corotated, 0.49, 0, 2));  // two layers share their volumetric strain
  check_derivatives<2>(clamped_box<2>(ElasticLaw::neo_hookean, 0.49, 0, 2));
  check_derivatives<3>(clamped_box<3>(ElasticLaw::linear, 0.4));
  check_derivatives<3>(clamped_box<3>(ElasticLaw::neo_hookean, 0.49, 0, 2));
}

// A fit through scattered points reproduces any quadratic field, with second derivatives.
TEST(Solid, FitIsExactForQuadraticFields) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::vector<Vector<3>> offsets;
  std::vector<double> weights;
  for (int l = 0; l < 30; ++l) {
    offsets.push_back({uniform(random), uniform(random), uniform(random)});
    weights.push_back(0.5 + std::abs(uniform(random)));
  }
  const QuadraticFit<3> fit = quadratic_fit<3>(offsets, weights, 1);
  EXPECT_FALSE(fit.deficient);
  const auto field = [](const Vector<3>& x) { return 3 * x(0) - 2 * x(2) + x(0) * x(0) + 5 * x(1) * x(2); };
  FitRow<3> y = FitRow<3>::Zero();
  for (std::size_t l = 0; l < offsets.size(); ++l) y += field(offsets[l]) * fit.shape[l];
  FitRow<3> expected;
  expected << 3, 0, -2, 2, 0, 0, 0, 0, 5;
  EXPECT_LT((y - expected).norm(), 1e-12);
}

// Rigid motion by 90 degrees makes no force; momentum and angular momentum are conserved at any deformation.
TEST(Solid, RigidMotionMakesNoForceAndMomentumIsConserved) {
  const auto scene = box<3>({0, 0, 0}, {5, 4, 3}, 1, material(ElasticLaw::neo_hookean, 0.49), nothing_fixed<3>);
  const SolidElasticity<3> solid = build_solids(scene);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d(1, 2, 2).normalized()).toRotationMatrix();
  std::vector<Vector<3>> position = solid.rest, force(solid.size());
  for (auto& x : position) x = turn * x + Eigen::Vector3d(10, 0, 0);
  SolidWork<3> work;
  solid_forces<3>(solid, position, work, force);
  for (const auto& f : force) EXPECT_LT(f.norm(), 1e-6);  // E l0^2 = 1e6
  position = displaced(solid, 0.1);
  solid_forces<3>(solid, position, work, force);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < solid.size(); ++i) {
    sum += force[i];
    moment += position[i].cross(force[i]);
  }
  EXPECT_LT(sum.norm(), 1e-6);
  EXPECT_LT(moment.norm(), 1e-5);
}

// Uniform stretch: the internal forces are exactly the tractions on the faces, spread by the fitted displacement (patch test).
TEST(Solid, UniformStressBalancesSurfaceTractionsExactly) {
  const auto scene = box<2>({0, 0}, {6, 4}, 1, material(ElasticLaw::neo_hookean, 0.49), nothing_fixed<2>);
  const SolidElasticity<2> solid = build_solids(scene);
  Tensor<2> f;
  f << 1.1, 0.2, -0.05, 0.97;
  const Tensor<2> p = first_piola_kirchhoff<2>(solid.law[0], f);
  std::vector<Vector<2>> position = solid.rest, force(solid.size());
  for (auto& x : position) x = f * x;
  SolidWork<2> work;
  solid_forces<2>(solid, position, work, force);
  for (std::size_t i = 0; i < solid.size(); ++i)
    for (const SurfacePiece<2>& piece : surface_pieces<2>(solid, i)) add_force_at<2>(solid, i, piece.offset, p * piece.area, force);
  for (const auto& residual : force) EXPECT_LT(residual.norm(), 1e-7 * p.norm());
}

TEST(Solid, StepLimitIsSafeAndMeasured) {
  const SolidElasticity<2> solid = clamped_box<2>(ElasticLaw::neo_hookean, 0.45);
  const double crossing = solid.spacing / solid.wave_speed[0];
  EXPECT_GT(solid.rest_step_limit, 0.4 * crossing);
  EXPECT_LT(solid.rest_step_limit, 0.8 * crossing);
  const double limit = solid_time_step_limit<2>(solid, solid.rest, 0.35);
  EXPECT_NEAR(limit, 0.35 * crossing, 1e-9 * crossing);
  std::vector<Vector<2>> squeezed = solid.rest;
  for (auto& x : squeezed) x(1) *= 0.5;
  EXPECT_LT(solid_time_step_limit<2>(solid, squeezed, 0.35), 0.6 * limit);
  EXPECT_THROW(solid_time_step_limit<2>(solid, solid.rest, 0.6), std::invalid_argument);
}

TEST(Solid, OneLayerIsRefusedWithItsName) {
  const auto scene = box<3>({0, 0, 0}, {8, 8, 1}, 1, material(ElasticLaw::linear, 0.3), nothing_fixed<3>);
  try {
    build_solids(scene);
    FAIL() << "a sheet of one layer has no strain across";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'solid'"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("shell"), std::string::npos);
  }
}

// Two bodies that touch do not pull each other.
TEST(Solid, BodiesAreNotBonded) {
  auto scene = box<2>({0, 0}, {4, 3}, 1, material(ElasticLaw::neo_hookean, 0.3), nothing_fixed<2>);
  const auto other = box<2>({4, 0}, {8, 3}, 1, material(ElasticLaw::neo_hookean, 0.3), nothing_fixed<2>);
  scene.bodies.push_back(other.bodies[0]);
  for (std::size_t i = 0; i < other.particles.size(); ++i)
    solid_bodies::add_particle<2>(scene, other.particles.position[i], other.particles.volume[i], 0, other.particles.surface_area[i],
                                  other.particles.depth[i]);
  const SolidElasticity<2> solid = build_solids(scene);
  std::vector<Vector<2>> position = solid.rest, force(solid.size());
  for (std::size_t i = 0; i < solid.size(); ++i)
    if (solid.body[i] == 1) position[i] += Vector<2>(0.7, 0.3);
  SolidWork<2> work;
  solid_forces<2>(solid, position, work, force);
  for (const auto& f : force) EXPECT_LT(f.norm(), 1e-7);
}

TEST(Solid, NoElasticBodyCostsNothing) {
  SceneDescription<3> scene;
  scene.spacing = 1;
  const SolidElasticity<3> solid = build_solids(scene);
  EXPECT_EQ(solid.size(), 0u);
  EXPECT_EQ(solid.neighbor.capacity(), 0u);
}

}  // namespace
