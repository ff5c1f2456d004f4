#include "sim/valve_metrics.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "tests/sim/valve_sheets.h"

namespace {

using namespace valve_sheets;

sim::ValveMoment at_rest(const sim::ValveSheet& sheet) {
  sim::ValveMoment moment;
  moment.position = sheet.rest;
  moment.velocity.assign(sheet.size(), Vector3d::Zero());
  moment.von_mises.assign(sheet.size(), 0), moment.principal = moment.von_mises;
  return moment;
}

double figure(const std::vector<sim::NamedValue>& values, const std::string& name) {
  for (const sim::NamedValue& value : values)
    if (value.name == name) return value.value;
  ADD_FAILURE() << name << " is missing";
  return NAN;
}

TEST(ValveMetrics, TipsOfDoorsAreTheMiddlesOfTheirFreeEdges) {
  const double radius = 10e-3, length = 8e-3;
  for (double angle : {0.3, 1.0}) {
    const sim::ValveSheet sheet = doors(radius, length, 8e-3, angle, 0.5e-3).build(radius, 0.5e-3, 0.5e-3);
    ASSERT_EQ(sheet.leaflets.size(), 3u);
    const double reach = radius - length * std::cos(angle);
    for (const auto& leaflet : sheet.leaflets) {
      ASSERT_GE(leaflet.tip, 0);
      EXPECT_NEAR((sheet.rest[leaflet.tip] - Vector3d(0, 0, length * std::sin(angle)) - reach * leaflet.outward).norm(), 0, 1e-9);
    }
    const auto values = sim::valve_metrics(sheet, at_rest(sheet), sim::Newtonian{3.5e-3});
    EXPECT_NEAR(figure(values, "tip_separation"), std::sqrt(3.0) * reach, 1e-9);  // corners of an equilateral triangle
    EXPECT_NEAR(figure(values, "m_mode.first"), 0.5 * std::sqrt(3.0) * reach, 1e-9);
    EXPECT_NEAR(figure(values, "m_mode.second"), -0.5 * std::sqrt(3.0) * reach, 1e-9);
  }
}

// A door that turns at rate w about its hinge: its tip moves outwards at w length sin(angle).
TEST(ValveMetrics, TipSpeedOfATurningDoor) {
  const double radius = 10e-3, length = 8e-3, angle = 0.7, rate = 30;
  const sim::ValveSheet sheet = doors(radius, length, 8e-3, angle, 0.5e-3).build(radius, 0.5e-3, 0.5e-3);
  sim::ValveMoment moment = at_rest(sheet);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const Vector3d& out = sheet.leaflets[sheet.leaflet[i]].outward;
    const double inwards = radius - out.dot(sheet.rest[i]), up = sheet.rest[i].z();
    moment.velocity[i] = rate * (up * out + inwards * Vector3d::UnitZ());
  }
  EXPECT_NEAR(figure(sim::valve_metrics(sheet, moment, sim::Newtonian{}), "tip_speed"), rate * length * std::sin(angle), 1e-9);
  for (auto& velocity : moment.velocity) velocity *= -1;
  EXPECT_NEAR(figure(sim::valve_metrics(sheet, moment, sim::Newtonian{}), "tip_speed"), -rate * length * std::sin(angle), 1e-9);
}

// Couette flow u = g z over a resting sheet; mu g on it, with Herschel-Bulkley m g^n + tau0.
TEST(ValveMetrics, WallShearStressOfCouetteFlow) {
  const double l0 = 1e-3, h = 0.5e-3, g = 150;
  Parts parts;
  add_sheet(parts, 0, {-6e-3, -6e-3, 0}, {l0, 0, 0}, {0, l0, 0}, 13, 13);
  const sim::ValveSheet sheet = parts.build(12e-3, l0, h);
  sim::ValveMoment moment = at_rest(sheet);
  for (int k = 0; k < 4; ++k)
    for (int j = -8; j <= 8; ++j)
      for (int i = -8; i <= 8; ++i) {
        const double height = h / 2 + (k + 0.4) * l0;
        moment.blood_position.emplace_back(i * l0 + 0.2e-3, j * l0 - 0.1e-3, height);
        moment.blood_velocity.emplace_back(g * (height - h / 2), 0, 0);
        moment.blood_position.emplace_back(i * l0, j * l0, -height);  // half as fast on the other side
        moment.blood_velocity.emplace_back(0, 0.5 * g * (height - h / 2), 0);
      }
  for (const double value : sim::wall_shear_stress(sheet, moment, sim::Newtonian{3.5e-3})) EXPECT_NEAR(value, 3.5e-3 * g, 1e-9);
  const sim::HerschelBulkley blood{0.009, 0.86, 0.0175};
  for (const double value : sim::wall_shear_stress(sheet, moment, blood)) EXPECT_NEAR(value, 0.009 * std::pow(g, 0.86) + 0.0175, 1e-9);
  // A sheet that moves with the blood at its face feels the difference alone.
  for (auto& velocity : moment.velocity) velocity = Vector3d(0.02, 0, 0);
  for (auto& velocity : moment.blood_velocity) velocity += Vector3d(0.02, 0, 0);
  for (const double value : sim::wall_shear_stress(sheet, moment, sim::Newtonian{3.5e-3})) EXPECT_NEAR(value, 3.5e-3 * g, 1e-9);
}

// Stretched by 1.2 along x and 0.9 along y, then turned: the largest principal strain is 0.2; sheared by k: sqrt of the larger
// eigenvalue of C.
TEST(ValveMetrics, MembraneStrainOfAHomogeneousDeformation) {
  Parts parts;
  add_sheet(parts, 0, {0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}, 6, 6);
  const sim::ValveSheet sheet = parts.build(12e-3, 1e-3, 0.5e-3);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vector3d> now = sheet.rest;
  for (Vector3d& x : now) x = turn * Vector3d(1.2 * x.x(), 0.9 * x.y(), 0);
  for (const double strain : sim::membrane_strain(sheet, now)) EXPECT_NEAR(strain, 0.2, 1e-12);
  const double k = 0.4, c = 1 + k * k / 2 + k * std::sqrt(1 + k * k / 4);
  now = sheet.rest;
  for (Vector3d& x : now) x.x() += k * x.y();
  for (const double strain : sim::membrane_strain(sheet, now)) EXPECT_NEAR(strain, std::sqrt(c) - 1, 1e-12);
}

TEST(ValveMetrics, JetSpeedLooksBetweenAnnulusAndBeyondTheCommissures) {
  std::vector<Vector3d> position, velocity;
  const sim::ValveFrame valve = frame(12e-3);  // annulus at z = -5 mm, looked at up to 12 + 15 mm above it
  for (int i = 0; i < 2000; ++i) {
    const double z = -15e-3 + 60e-3 * i / 1999;
    position.emplace_back(0, 0, z);
    velocity.emplace_back(0, 0, z > -5e-3 && z < 22e-3 ? 1.3 : 9.0);
  }
  EXPECT_NEAR(sim::jet_speed(valve, position, velocity), 1.3, 1e-12);
}

// Plug flow of speed v through an opening A: the effective orifice area is A.
TEST(ValveMetrics, EffectiveOrificeAreaOfPlugFlow) {
  EXPECT_NEAR(sim::effective_orifice_area(2e-4 * 1.1, 1.1, 2.5e-4, 1e-3), 2e-4, 1e-18);
  EXPECT_EQ(sim::effective_orifice_area(-1e-5, 1.1, 2.5e-4, 1e-3), 0);
  EXPECT_EQ(sim::effective_orifice_area(1e-6, 0.1, 2.5e-4, 1e-3), 0);
  EXPECT_EQ(sim::effective_orifice_area(1e-5, 1.1, 3.9e-6, 1e-3), 0);  // closed, and the flow rings
  EXPECT_GT(sim::effective_orifice_area(1e-5, 1.1, 4.1e-6, 1e-3), 0);
}

// Stress by region: one value a region, set by hand; the clamp's is never reported.
TEST(ValveMetrics, StressIsReportedByRegionAndNeverAtTheClamp) {
  const sim::ValveSheet sheet = doors(12e-3, 10e-3, 18e-3, 0.5, 0.5e-3).build(12e-3, 0.5e-3, 0.5e-3);
  sim::ValveMoment moment = at_rest(sheet);
  int of_region[5] = {};
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    ++of_region[static_cast<int>(sheet.region[i])];
    moment.von_mises[i] = sheet.region[i] == sim::LeafletRegion::clamp ? 1e9 : 1e5 * static_cast<int>(sheet.region[i]) + sheet.leaflet[i];
    const double from_hinge = (sheet.rest[i] - (12e-3 * sheet.leaflets[sheet.leaflet[i]].outward)).dot(Vector3d::UnitZ()) / std::sin(0.5);
    if (std::abs(from_hinge - 1e-3) > 1e-6) {  // max(h, 2 l0)
      EXPECT_EQ(sheet.region[i] == sim::LeafletRegion::clamp, from_hinge < 1e-3);
    }
  }
  for (const int count : of_region) EXPECT_GT(count, 3);
  const auto values = sim::valve_metrics(sheet, moment, sim::Newtonian{});
  EXPECT_LT(figure(values, "leaflet_stress_p99"), 1e6);
  for (int leaflet = 0; leaflet < 3; ++leaflet)
    for (const sim::LeafletRegion region : sim::reported_regions)
      EXPECT_EQ(figure(values, "leaflet_" + std::to_string(leaflet + 1) + "." + sim::region_name(region) + ".von_mises"),
                1e5 * static_cast<int>(region) + leaflet);
}

}  // namespace
