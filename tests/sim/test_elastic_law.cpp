#include "sim/elastic_law.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "sim/stress.h"

namespace {

using namespace sim;
constexpr ElasticLaw laws[] = {ElasticLaw::linear, ElasticLaw::corotated, ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean,
                               ElasticLaw::fibre_reinforced};

template <int D>
ElasticLawPoint<D> make_point(ElasticLaw law, double poisson_ratio, bool plane_stress = false) {
  ElasticMaterial material;
  material.law = law;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = poisson_ratio;
  material.plane_stress = plane_stress;
  return law_point<D>(material, 1, Vector<D>::Ones());
}

template <int D>
Tensor<D> some_deformation(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Tensor<D> f = Tensor<D>::Identity();
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) f(a, b) += uniform(random);
  return f;
}

// P and the tangent are the derivatives of the energy: central differences, step 1e-6, error O(1e-9) relative.
template <int D>
void check_derivatives(const ElasticLawPoint<D>& point, const Tensor<D>& f) {
  const Tensor<D> p = first_piola_kirchhoff<D>(point, f);
  const ElasticTangent<D> t = elastic_tangent<D>(point, f);
  const double h = 1e-6;
  for (int c = 0; c < D * D; ++c) {
    Tensor<D> up = f, down = f;
    up.data()[c] += h;
    down.data()[c] -= h;
    const double slope = (energy_density<D>(point, up) - energy_density<D>(point, down)) / (2 * h);
    EXPECT_NEAR(p.data()[c], slope, 1e-6 * (p.norm() + 1e6));
    const Tensor<D> dp = (first_piola_kirchhoff<D>(point, up) - first_piola_kirchhoff<D>(point, down)) / (2 * h);
    for (int r = 0; r < D * D; ++r) EXPECT_NEAR(t(r, c), dp.data()[r], 1e-6 * t.norm());
  }
}

TEST(ElasticLaw, StressAndTangentAreDerivativesOfTheEnergy) {
  for (const ElasticLaw law : laws)
    for (unsigned seed = 1; seed < 5; ++seed) {
      SCOPED_TRACE("law " + std::to_string(static_cast<int>(law)) + " seed " + std::to_string(seed));
      check_derivatives<2>(make_point<2>(law, 0.45), some_deformation<2>(seed, 0.3));
      check_derivatives<2>(make_point<2>(law, 0.45, true), some_deformation<2>(seed, 0.3));
      check_derivatives<3>(make_point<3>(law, 0.45), some_deformation<3>(seed, 0.3));
    }
  Tensor<3> inverted = Tensor<3>::Identity();
  inverted(2, 2) = -0.1;
  check_derivatives<3>(make_point<3>(ElasticLaw::neo_hookean, 0.45), inverted);
}

TEST(ElasticLaw, VolumetricStrainHasItsDerivatives) {
  for (const ElasticLaw law : laws) {
    const Tensor<3> f = some_deformation<3>(7, 0.3);
    const Tensor<3> gradient = volumetric_strain_gradient<3>(law, f);
    const ElasticTangent<3> hessian = volumetric_strain_hessian<3>(law, f);
    for (int c = 0; c < 9; ++c) {
      Tensor<3> up = f, down = f;
      up.data()[c] += 1e-6;
      down.data()[c] -= 1e-6;
      EXPECT_NEAR(gradient.data()[c], (volumetric_strain<3>(law, up) - volumetric_strain<3>(law, down)) / 2e-6, 1e-7);
      const Tensor<3> change = (volumetric_strain_gradient<3>(law, up) - volumetric_strain_gradient<3>(law, down)) / 2e-6;
      for (int r = 0; r < 9; ++r) EXPECT_NEAR(hessian(r, c), change.data()[r], 1e-6);
    }
  }
}

// All laws share Hooke's small-strain limit (without fibres): P = lambda tr(eps) I + 2 G eps.
TEST(ElasticLaw, SmallStrainIsHooke) {
  const double size = 1e-6;
  for (const ElasticLaw law : {ElasticLaw::linear, ElasticLaw::corotated, ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
    const ElasticLawPoint<3> point = make_point<3>(law, 0.3);
    const Tensor<3> f = some_deformation<3>(3, size);
    const Tensor<3> strain = 0.5 * (f + f.transpose()) - Tensor<3>::Identity();
    const Tensor<3> hooke = point.moduli.lame_lambda * strain.trace() * Tensor<3>::Identity() + 2 * point.moduli.shear_modulus * strain;
    EXPECT_LT((first_piola_kirchhoff<3>(point, f) - hooke).norm(), 1e-5 * hooke.norm());
    const ElasticLawPoint<2> sheet = make_point<2>(law, 0.3, true);
    Tensor<2> stretch = Tensor<2>::Identity();
    stretch(0, 0) += size;
    stretch(1, 1) -= 0.3 * size;  // free contraction: sigma_xx = E eps, sigma_yy = 0
    EXPECT_NEAR(first_piola_kirchhoff<2>(sheet, stretch)(0, 0), 1e6 * size, 1e-5);
    EXPECT_NEAR(first_piola_kirchhoff<2>(sheet, stretch)(1, 1), 0, 1e-5);
  }
}

TEST(ElasticLaw, RotationMakesNoStressExceptInTheLinearLaw) {
  const Tensor<3> r = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (const ElasticLaw law : laws) {
    const double p = first_piola_kirchhoff<3>(make_point<3>(law, 0.49), r).norm();
    if (law == ElasticLaw::linear)
      EXPECT_GT(p, 1e5);
    else
      EXPECT_LT(p, 1e-5);
  }
  const Tensor<3> f = r * Eigen::Vector3d(1.3, 0.8, 1.1).asDiagonal();
  EXPECT_LT((polar_rotation<3>(f) - r).norm(), 1e-14);
  const Tensor<3> mirrored = r * Eigen::Vector3d(1.3, 0.8, -0.1).asDiagonal();
  EXPECT_LT((polar_rotation<3>(mirrored) - r).norm(), 1e-12);
}

// cases.csv S1: exact uniaxial Cauchy stress of the neo-Hookean law, lateral stretch and volume ratio given there.
TEST(ElasticLaw, UniaxialNeoHookeanReference) {
  const double rows[][3] = {{1.1, 0.954331, 100237}, {1.2, 0.914399, 201966}, {1.5, 0.819241, 526270}};
  const ElasticLawPoint<3> point = make_point<3>(ElasticLaw::neo_hookean, 0.49);
  for (const auto& row : rows) {
    const Tensor<3> f = Eigen::Vector3d(row[0], row[1], row[1]).asDiagonal();
    const Eigen::Matrix3d stress = cauchy_stress<3>(point, f);
    EXPECT_NEAR(stress(0, 0), row[2], 20);  // the lateral stretch has six digits: 2 lambda 5e-7 = 16 Pa
    EXPECT_NEAR(stress(1, 1), 0, 20);
    EXPECT_NEAR(von_mises(stress), row[2], 20);
    // plane stress with the exact in-plane stretches finds the same third stretch
    Tensor<2> plane = Tensor<2>::Zero();
    plane.diagonal() << row[0], row[1];
    const ElasticLawPoint<2> sheet = make_point<2>(ElasticLaw::neo_hookean, 0.49, true);
    EXPECT_NEAR(thickness_stretch(sheet, plane), row[1], 3e-6);
    EXPECT_NEAR(cauchy_stress<2>(sheet, plane)(0, 0), row[2], 20);
  }
}

// Simple shear (cases.csv S1): tau = G gamma, sigma_xx - sigma_yy = G gamma^2; plane strain keeps a stress across.
TEST(ElasticLaw, SimpleShearReference) {
  const ElasticLawPoint<2> point = make_point<2>(ElasticLaw::neo_hookean, 0.49);
  Tensor<2> f = Tensor<2>::Identity();
  f(0, 1) = 0.5;
  const Eigen::Matrix3d stress = cauchy_stress<2>(point, f);
  EXPECT_NEAR(stress(0, 1), 167785, 1);
  EXPECT_NEAR(stress(0, 0) - stress(1, 1), 0.25 * point.moduli.shear_modulus, 1e-6);
  Tensor<2> stretch = Tensor<2>::Identity();
  stretch(0, 0) = 1 + 1e-7;
  EXPECT_NEAR(cauchy_stress<2>(point, stretch)(2, 2), point.moduli.lame_lambda * 1e-7, 1e-5);
}

// Fibre stress along the fibre against its closed form 2 psi' lambda, below, at and beyond the limit.
TEST(ElasticLaw, FibreStiffensExponentiallyThenLinearly) {
  ElasticMaterial material;
  material.law = ElasticLaw::fibre_reinforced;
  const ElasticLawPoint<3> with = law_point<3>(material, 1, Vector<3>::UnitX());
  const ElasticLawPoint<3> without = law_point<3>(material, 1, Vector<3>::Zero());
  const auto fibre_stress = [&](double stretch) {
    const Tensor<3> f = Eigen::Vector3d(stretch, 1, 1).asDiagonal();
    return (first_piola_kirchhoff<3>(with, f) - first_piola_kirchhoff<3>(without, f))(0, 0);
  };
  EXPECT_DOUBLE_EQ(fibre_stress(0.9), 0);
  const double e = 1.1 * 1.1 - 1;
  EXPECT_NEAR(fibre_stress(1.1), 2 * 0.8e6 * e * std::exp(5 * e * e) * 1.1, 1e-4);
  const double slope = 0.8e6 * std::exp(5 * 0.35 * 0.35) * (1 + 10 * 0.35 * 0.35);
  const double first = 0.8e6 * 0.35 * std::exp(5 * 0.35 * 0.35) + slope * (1.3 * 1.3 - 1.35);
  EXPECT_NEAR(fibre_stress(1.3), 2 * first * 1.3, 1e-3);
}

TEST(ElasticLaw, ImpossibleConstantsAreRefused) {
  EXPECT_THROW(lame_moduli(0, 0.3), std::invalid_argument);
  EXPECT_THROW(lame_moduli(1e6, 0.5), std::invalid_argument);
  EXPECT_THROW(lame_moduli(1e6, -1), std::invalid_argument);
  EXPECT_THROW(lame_moduli(std::nan(""), 0.3), std::invalid_argument);
}

}  // namespace
