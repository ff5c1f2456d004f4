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

TEST(Rheology, ManyRatesAtOnceGiveWhatEachGives) {
  for (const HerschelBulkley& blood : {HerschelBulkley{0.0089721, 0.8601, 0.0175}, HerschelBulkley{0.01, 1, 0},
                                       HerschelBulkley{0.02, 0.4, 0}, HerschelBulkley{0.001, 1.7, 0.1}}) {
    std::vector<double> rates{0, 1e-13}, each;
    for (double rate = 1e-11; rate < 1e8; rate *= 1.0173) rates.push_back(rate);
    for (double rate : rates) each.push_back(herschel_bulkley_viscosity(blood, rate, 1e6));
    viscosities(blood, rates, 1e6);
    for (std::size_t k = 0; k < each.size(); ++k) EXPECT_NEAR(rates[k], each[k], 3e-15 * each[k]) << k;
  }
  std::vector<double> rates{0, 2.0, 400};
  viscosities(Casson{0.004, 0.005}, rates, 1000);
  EXPECT_EQ(rates[1], casson_viscosity({0.004, 0.005}, 2.0, 1000));
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
