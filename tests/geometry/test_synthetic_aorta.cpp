#include "geometry/synthetic_aorta.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "geometry/signed_distance_grid.h"

namespace {

using namespace geometry;
constexpr double pi = std::numbers::pi;

TEST(SyntheticAorta, MeasuresLieInThePublishedCorridors) {
  const SyntheticPatient patient = make_synthetic_patient();
  // Corridors: mean +- one deviation of the tables named in the reference file aortic_root_geometry.csv, mm.
  EXPECT_NEAR(1e3 * patient.root.annulus.mean_diameter, 21.5, 2.4);
  EXPECT_NEAR(1e3 * patient.root.sinotubular_junction.mean_diameter, 25.7, 2.4);
  const SyntheticAorta aorta;
  const double sinus_to_commissure =
      synthetic_radius(aorta, pi / 3, aorta.sinus_height) + synthetic_radius(aorta, pi / 3 + pi, aorta.sinus_height);
  EXPECT_NEAR(1e3 * sinus_to_commissure, 29.0, 2.9);
  EXPECT_NEAR(aorta.junction_height / (0.5 * aorta.annulus_diameter), 1.69, 0.18);
}

TEST(SyntheticAorta, LumenIsClosedAndOutward) {
  const SyntheticPatient patient = make_synthetic_patient();
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : patient.lumen.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  // Volume against quadrature of the sections' areas.
  const SyntheticAorta aorta;
  double volume = 0;
  const double low = patient.ports[0].point.z(), high = patient.ports[1].point.z();
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 360; ++j)
      volume += 0.5 * std::pow(synthetic_radius(aorta, 2 * pi * (j + 0.5) / 360, low + (high - low) * (i + 0.5) / 400), 2) * 2 * pi / 360 *
                (high - low) / 400;
  EXPECT_NEAR(enclosed_volume(patient.lumen), volume, 0.003 * volume);
}

TEST(SyntheticAorta, HasThreeSinusesBetweenAnnulusAndJunctionOnly) {
  const SyntheticAorta aorta;
  const auto maxima = [&](double z) {
    int count = 0;
    for (int j = 0; j < 360; ++j) {
      const double r = synthetic_radius(aorta, 2 * pi * j / 360, z);
      count +=
          r > synthetic_radius(aorta, 2 * pi * (j - 1) / 360, z) + 1e-9 && r > synthetic_radius(aorta, 2 * pi * (j + 1) / 360, z) + 1e-9;
    }
    return count;
  };
  EXPECT_EQ(maxima(aorta.sinus_height), 3);
  EXPECT_EQ(maxima(-0.9 * aorta.outflow_length), 0);
  EXPECT_EQ(maxima(aorta.junction_height + 0.8 * aorta.ascending_length), 0);
}

TEST(SyntheticAorta, WallIsSmooth) {
  // Slope and curvature of the wall along the axis have no jump: second differences shrink with the step squared.
  const SyntheticAorta aorta;
  const double step = 1e-4;
  for (double z = -0.034; z < 0.068; z += step) {
    const double bend =
        (synthetic_radius(aorta, pi / 3, z + step) - 2 * synthetic_radius(aorta, pi / 3, z) + synthetic_radius(aorta, pi / 3, z - step)) /
        (step * step);
    EXPECT_LT(std::abs(bend), 1 / 1e-3) << z;  // no bend tighter than a millimetre
  }
}

TEST(SyntheticAorta, PortsAreTheFlatEnds) {
  const SyntheticPatient patient = make_synthetic_patient();
  ASSERT_EQ(patient.ports.size(), 2u);
  EXPECT_EQ(patient.ports[0].name, "ventricle");
  EXPECT_LT(patient.ports[0].normal.z(), 0);
  EXPECT_EQ(patient.ports[1].name, "aorta");
  for (const DomainPort& port : patient.ports)
    for (const auto& p : patient.lumen.vertices) EXPECT_LE((p - port.point).dot(port.normal), 1e-12);
  // Whole numbers of the usual spacings fit between them.
  EXPECT_NEAR(patient.ports[1].point.z() - patient.ports[0].point.z(), 0.105, 1e-12);
}

}  // namespace
