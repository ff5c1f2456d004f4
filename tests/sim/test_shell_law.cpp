#include <gtest/gtest.h>

#include <cmath>

#include "sim/shell_law.h"

namespace {

sim::SheetMaterial make(sim::ElasticLaw law, double nu = 0.45) {
  sim::ElasticMaterial material;
  material.law = law;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = nu;
  return sim::sheet_material(material);
}

// S = 2 dW/dC by central differences of the energy, every law, general metrics (also beyond the fibre's limit and below the floor).
TEST(ShellLaw, StressIsDerivativeOfEnergy) {
  for (auto law : {sim::ElasticLaw::linear, sim::ElasticLaw::corotated, sim::ElasticLaw::st_venant_kirchhoff, sim::ElasticLaw::neo_hookean,
                   sim::ElasticLaw::fibre_reinforced}) {
    const sim::SheetMaterial m = make(law);
    for (const sim::SheetTensor& c :
         {sim::SheetTensor{1.1, 0.9, 0.05}, sim::SheetTensor{1.6, 1.2, -0.2}, sim::SheetTensor{0.7, 0.6, 0.1}}) {
      const Eigen::Vector2d fibre(std::cos(0.3), std::sin(0.3));
      const double h = 1e-6;
      auto energy = [&](double xx, double yy, double xy) { return sim::sheet_energy(m, {c.xx + xx, c.yy + yy, c.xy + xy}, fibre); };
      const sim::SheetTensor s = sim::sheet_stress(m, c, fibre);
      const double scale = 1e6;
      EXPECT_NEAR(s.xx, (energy(h, 0, 0) - energy(-h, 0, 0)) / h, 2e-5 * scale);
      EXPECT_NEAR(s.yy, (energy(0, h, 0) - energy(0, -h, 0)) / h, 2e-5 * scale);
      EXPECT_NEAR(s.xy, (energy(0, 0, h) - energy(0, 0, -h)) / (2 * h), 2e-5 * scale);  // dW = S_xy dC_xy
    }
  }
}

// Small strain: Hooke's law in plane stress, E and nu.
TEST(ShellLaw, SmallStrainIsPlaneStress) {
  const double nu = 0.3, e = 1e-5;
  for (auto law : {sim::ElasticLaw::corotated, sim::ElasticLaw::st_venant_kirchhoff, sim::ElasticLaw::neo_hookean}) {
    const sim::SheetTensor s = sim::sheet_stress(make(law, nu), {1 + 2 * e, 1 - 2 * nu * e, 0}, Eigen::Vector2d::Zero());
    EXPECT_NEAR(s.xx, 1e6 * e, 1e-3 * 1e6 * e);
    EXPECT_NEAR(s.yy, 0, 1e-3 * 1e6 * e);
  }
}

// Uniaxial Cauchy stress of the nearly incompressible neo-Hookean sheet: G (lambda^2 - 1/lambda); beam: G (lambda^2 - 1/lambda^2).
TEST(ShellLaw, NeoHookeanClosedForm) {
  const sim::SheetMaterial m = make(sim::ElasticLaw::neo_hookean, 0.4999);
  for (double stretch : {0.8, 1.2, 1.5}) {
    const double g = m.shear_modulus;
    const sim::SheetTensor s = sim::sheet_stress(m, {stretch * stretch, 1 / stretch, 0}, Eigen::Vector2d::Zero());
    EXPECT_NEAR(s.xx * stretch * stretch, g * (stretch * stretch - 1 / stretch), 2e-3 * g);
    const sim::SheetTensor strain = sim::sheet_stress(m, {stretch * stretch, 1, 0}, Eigen::Vector2d::Zero());
    EXPECT_NEAR(strain.xx * stretch * stretch, g * (stretch * stretch - 1 / (stretch * stretch)), 2e-3 * g);
  }
}

// Fibre stress 2 k1 x exp(k2 x^2), straight beyond the limit with the slope there.
TEST(ShellLaw, FibreStressAndItsContinuation) {
  const sim::SheetMaterial m = make(sim::ElasticLaw::fibre_reinforced);
  EXPECT_EQ(sim::fibre_stress(m, -0.1), 0);
  EXPECT_NEAR(sim::fibre_stress(m, 0.2), 2 * 0.8e6 * 0.2 * std::exp(5 * 0.04), 1);
  const double slope = sim::fibre_stress_slope(m, 0.35);
  EXPECT_NEAR(sim::fibre_stress(m, 0.5), sim::fibre_stress(m, 0.35) + 0.15 * slope, 1e-3);
}

// Below stretch 0.4 stiffness stays finite and the flag is raised; an inverted metric gives a finite stress.
TEST(ShellLaw, LimitedUnderExtremeCompression) {
  const sim::SheetMaterial m = make(sim::ElasticLaw::neo_hookean);
  bool limited = false;
  const sim::SheetTensor s = sim::sheet_stress(m, {-0.3, 0.9, 0}, Eigen::Vector2d::Zero(), &limited);
  EXPECT_TRUE(limited);
  EXPECT_TRUE(std::isfinite(s.xx) && s.xx < -1e6);
  limited = false;
  sim::sheet_stress(m, {0.2, 0.9, 0}, Eigen::Vector2d::Zero(), &limited);
  EXPECT_FALSE(limited);
}

// The pressure at which an isotropic leaflet of 0.5 mm and 12 mm radius has no equilibrium: about 14 kPa at 1 MPa.
TEST(ShellLaw, LimitPressure) {
  EXPECT_NEAR(sim::limit_pressure(make(sim::ElasticLaw::neo_hookean, 0.49), 0.5e-3, 12e-3), 13.98e3, 20);
  EXPECT_TRUE(std::isinf(sim::limit_pressure(make(sim::ElasticLaw::fibre_reinforced), 0.5e-3, 12e-3)));
}

TEST(ShellLaw, RefusesImpossibleConstants) {
  sim::ElasticMaterial material;
  material.poisson_ratio = 0.5;
  EXPECT_THROW(sim::sheet_material(material), std::invalid_argument);
}

}  // namespace
