#include "sim/rheology.h"

#include <gtest/gtest.h>

namespace sim {
namespace {

TEST(Rheology, ShearRateOfSimpleShearIsItsSlope) {
  Tensor<3> gradient = Tensor<3>::Zero();
  gradient(0, 1) = 42;
  EXPECT_DOUBLE_EQ(shear_rate<3>(gradient), 42);
  Tensor<2> turning;
  turning << 0, -3, 3, 0;  // rigid rotation: no shear
  EXPECT_EQ(shear_rate<2>(turning), 0);
}

TEST(Rheology, StressIsYieldStressPlusPowerLaw) {
  const HerschelBulkley blood{0.0089721, 0.8601, 0.0175};
  for (double rate : {0.1, 1.0, 30.0, 500.0})
    EXPECT_NEAR(herschel_bulkley_viscosity(blood, rate, 1e9) * rate, 0.0175 + 0.0089721 * std::pow(rate, 0.8601), 1e-14);
}

TEST(Rheology, CassonStressIsTheSquareOfSummedRoots) {
  const Casson blood{0.004, 0.005};
  for (double rate : {0.1, 10.0, 300.0})
    EXPECT_NEAR(std::sqrt(casson_viscosity(blood, rate, 1e9) * rate), std::sqrt(0.005) + std::sqrt(0.004 * rate), 1e-13);
}

TEST(Rheology, AtRestBloodIsCappedAndWaterIsNot) {
  EXPECT_EQ(viscosity(HerschelBulkley{0.009, 0.86, 0.0175}, 0, 1000), 1000);
  EXPECT_EQ(viscosity(HerschelBulkley{0.009, 0.86, 0}, 0, 1000), 1000);  // the power law alone diverges too where its index is below 1
  EXPECT_EQ(viscosity(HerschelBulkley{0.009, 1, 0}, 0, 1000), 0.009);
  EXPECT_EQ(viscosity(Casson{0.004, 0}, 0, 1000), 0.004);
  EXPECT_EQ(viscosity(Newtonian{0.001}, 0, 1000), 0.001);
}

}  // namespace
}  // namespace sim
