#include "geometry/place_valve_case.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

#include "geometry/signed_distance_grid.h"
#include "geometry/synthetic_aorta.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

struct Built {
  SyntheticAorta aorta;
  SyntheticPatient patient = make_synthetic_patient(aorta);
  ValveTemplate valve = make_valve_template(patient.frame, [this](double theta, double z) { return synthetic_radius(aorta, theta, z); });
  ValveCase made;
  Built() {
    ValveCaseOptions options;
    options.spacing = 1.5e-3;
    made = place_valve_case(patient.lumen, patient.ports, valve, options);
  }
};
const Built& built() {
  static const Built value;
  return value;
}

TEST(PlaceValveCase, InterfacesAreEven) {
  EXPECT_NEAR(built().made.fluid_density_mean, 1, 0.01);
  EXPECT_LT(built().made.fluid_density_deviation, 0.015);
  EXPECT_GE(built().made.nearest, 0.65);
}

TEST(PlaceValveCase, NoWayPastTheClosedValve) {
  EXPECT_LT(built().made.leak_clearance, 0.85);  // a particle needs about one spacing
}

TEST(PlaceValveCase, BloodFillsTheLumenLessTheLeaflets) {
  double volume = 0, leaflets = 0;
  for (double v : built().made.fluid.volume) volume += v;
  for (const SurfaceParticles& leaflet : built().made.leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i) leaflets += leaflet.embedded[i] ? 0 : leaflet.area[i] * 1.5e-3;
  const double lumen = enclosed_volume(built().patient.lumen);
  EXPECT_NEAR(volume, lumen - leaflets, 0.006 * lumen);
}

TEST(PlaceValveCase, LatticeRunsStraightToThePorts) {
  // Away from the wall, the three particle planes before each port are whole lattice planes.
  const double spacing = 1.5e-3;
  for (const DomainPort& port : built().patient.ports) {
    int counted = 0;
    for (const Vector3d& p : built().made.fluid.position) {
      const double before = -(p - port.point).dot(port.normal);
      if (before > 3 * spacing || std::hypot(p.x(), p.y()) > port.radius - 4 * spacing) continue;
      EXPECT_NEAR(std::remainder(before - 0.5 * spacing, spacing), 0, 1e-6 * spacing);
      ++counted;
    }
    EXPECT_GT(counted, 30);
  }
}

TEST(PlaceValveCase, WallLeavesThePortsOpenAndKnowsItsSurface) {
  for (std::size_t i = 0; i < built().made.wall.size(); ++i) {
    const Vector3d& p = built().made.wall.position[i];
    for (const DomainPort& port : built().patient.ports) EXPECT_LT((p - port.point).dot(port.normal), 0);
    const Vector3d foot = p + built().made.wall.depth[i] * built().made.wall.normal[i];
    EXPECT_NEAR(std::hypot(foot.x(), foot.y()) - synthetic_radius(built().aorta, std::atan2(foot.y(), foot.x()), foot.z()), 0, 0.15e-3);
    EXPECT_LT(built().made.wall.depth[i], 3.1 * 1.5e-3);
  }
}

}  // namespace
