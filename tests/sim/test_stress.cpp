#include "sim/stress.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace {

using namespace sim;

TEST(Stress, VonMisesOfTensionShearAndPressure) {
  Eigen::Matrix3d tension = Eigen::Matrix3d::Zero();
  tension(1, 1) = 5;
  EXPECT_NEAR(von_mises(tension), 5, 1e-14);
  Eigen::Matrix3d shear = Eigen::Matrix3d::Zero();
  shear(0, 1) = shear(1, 0) = 2;
  EXPECT_NEAR(von_mises(shear), 2 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(von_mises(-7 * Eigen::Matrix3d::Identity()), 0, 1e-14);
}

TEST(Stress, PrincipalStressesComeLargestFirst) {
  const Eigen::Matrix3d r = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();
  const Eigen::Matrix3d stress = r * Eigen::Vector3d(-3, 8, 1).asDiagonal() * r.transpose();
  EXPECT_LT((principal_stresses(stress) - Eigen::Vector3d(8, 1, -3)).norm(), 1e-13);
}

// The Cauchy stress turns with the body: sigma(R F) = R sigma(F) R^T.
TEST(Stress, CauchyStressIsObjective) {
  ElasticMaterial material;
  const ElasticLawPoint<3> point = law_point<3>(material, 1, Vector<3>::Zero());
  Eigen::Matrix3d f;
  f << 1.2, 0.1, 0, -0.2, 0.9, 0.3, 0, 0.1, 1.1;
  const Eigen::Matrix3d r = Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Matrix3d turned = cauchy_stress<3>(point, r * f), expected = r * cauchy_stress<3>(point, f) * r.transpose();
  EXPECT_LT((turned - expected).norm(), 1e-9 * expected.norm());
  EXPECT_NEAR(expected(0, 1), expected(1, 0), 1e-9 * expected.norm());
}

}  // namespace
