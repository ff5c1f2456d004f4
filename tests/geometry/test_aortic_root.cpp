// The root finder against the built-in patient, whose root is known, and against vessels without one.
#include "geometry/aortic_root.h"

#include <gtest/gtest.h>

#include "geometry/centreline.h"
#include "geometry/check_mesh.h"
#include "geometry/cut_domain.h"
#include "geometry/mesh_makers.h"
#include "geometry/root_frame.h"
#include "geometry/synthetic_aorta.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

const SyntheticPatient& patient() {
  static const SyntheticPatient made = make_synthetic_patient();
  return made;
}

double degrees_between(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180 / std::numbers::pi;
}

Centreline line_of(const TriangleMesh& mesh, const Vector3d& from, const Vector3d& to) {
  return trace_centreline(make_lumen_field(mesh), from, to);
}

RootSearch search_patient(bool backward, const RootOptions& options = {}) {
  const auto& ports = patient().ports;
  const Vector3d from = ports[backward ? 1 : 0].point, to = ports[backward ? 0 : 1].point;
  return find_aortic_root(patient().lumen, {line_of(patient().lumen, from, to)}, options);
}

TEST(AorticRoot, FindsTheSyntheticPatientsRootFromEitherEnd) {
  for (const bool backward : {false, true}) {
    const RootSearch search = search_patient(backward);
    ASSERT_TRUE(search.root) << search.reason;
    const AorticRoot &found = *search.root, &known = patient().root;
    EXPECT_LT((found.annulus.center - known.annulus.center).norm(), 0.003);
    EXPECT_LT(degrees_between(found.annulus.normal, known.annulus.normal), 8);
    EXPECT_LT((found.sinotubular_junction.center - known.sinotubular_junction.center).norm(), 0.003);
    EXPECT_NEAR(found.annulus.mean_diameter, known.annulus.mean_diameter, 0.1 * known.annulus.mean_diameter);
    EXPECT_NEAR(found.sinuses.mean_diameter, known.sinuses.mean_diameter, 0.05 * known.sinuses.mean_diameter);
    EXPECT_NEAR(found.sinotubular_junction.mean_diameter, known.sinotubular_junction.mean_diameter,
                0.05 * known.sinotubular_junction.mean_diameter);
    for (const Vector3d& commissure : found.commissures) {
      double nearest = 1;
      for (const Vector3d& other : known.commissures)
        nearest = std::min(nearest, degrees_between({commissure.x(), commissure.y(), 0}, {other.x(), other.y(), 0}));
      EXPECT_LT(nearest, 8);
    }
    EXPECT_LT((search.centreline.points.front() - patient().ports[0].point).norm(), 0.005) << "the centreline runs from the ventricle";
  }
}

TEST(AorticRoot, TheUsersPlanesStand) {
  RootOptions options;
  options.annulus = PlaneOverride{{0, 0, -0.001}, {0.05, 0, 1}};
  options.commissures =
      std::array<Vector3d, 3>{Vector3d{0.0125, 0, 0.017}, Vector3d{-0.006, 0.011, 0.017}, Vector3d{-0.006, -0.011, 0.017}};
  const RootSearch search = search_patient(false, options);
  ASSERT_TRUE(search.root) << search.reason;
  EXPECT_NEAR(degrees_between(search.root->annulus.normal, options.annulus->normal), 0, 0.1);
  EXPECT_LT(std::abs(search.root->annulus.center.z() + 0.001), 0.0005);
  EXPECT_EQ(search.root->commissures, *options.commissures);
}

TEST(AorticRoot, ATubeAndABulgeAndAFourLobedVesselHaveNone) {
  auto bulge = [](double z) { return 0.0035 * std::exp(-std::pow((z - 0.04) / 0.008, 2)); };
  const std::function<double(double, double)> shapes[] = {
      [](double, double) { return 0.012; },                                                         // straight
      [&](double, double z) { return 0.012 + bulge(z); },                                           // round widening
      [&](double theta, double z) { return 0.012 + bulge(z) * (1 + 0.8 * std::cos(4 * theta)); },   // four lobes
      [&](double theta, double z) { return 0.012 + bulge(z) * (1 + 0.8 * std::cos(2 * theta)); }};  // two
  for (const auto& shape : shapes) {
    const TriangleMesh mesh = test::make_tube(shape, 0, 0.09, 90, 120, true);
    const RootSearch search = find_aortic_root(mesh, {line_of(mesh, {0, 0, 0}, {0, 0, 0.09})});
    EXPECT_FALSE(search.root);
    EXPECT_NE(search.reason.find("no root"), std::string::npos) << search.reason;
  }
}

TEST(AorticRoot, SinusesWithoutAnOutflowTractAreToldUnresolved) {
  // Three lobes that close at once below, as an aorta's label without the ventricle does.
  auto radius = [](double theta, double z) {
    const double dome = z < 0.010 ? std::sqrt(std::max(1e-4, 1 - std::pow((z - 0.010) / 0.0102, 2))) : 1;
    const double sinus = std::exp(-std::pow((z - 0.010) / 0.007, 2));
    return dome * (0.0130 + 0.0025 * sinus * (1 + 0.9 * std::cos(3 * theta)));
  };
  const TriangleMesh mesh = test::make_tube(radius, 0, 0.06, 120, 120, true);
  const RootSearch search = find_aortic_root(mesh, {line_of(mesh, {0, 0, 0.001}, {0, 0, 0.06})});
  EXPECT_FALSE(search.root);
  EXPECT_NE(search.reason.find("three sinuses found"), std::string::npos) << search.reason;
  EXPECT_NE(search.reason.find("annulus is unresolved"), std::string::npos) << search.reason;
  EXPECT_TRUE(search.likely_annulus);
}

TEST(BuildRoot, TakesItsMeasuresFromTheBoreOrTheUser) {
  const TriangleMesh tube = test::make_cylinder(0.011, 0.10, 60, 80, true);
  const Centreline line = line_of(tube, {0, 0, 0}, {0, 0, 0.1});
  const RootSearch plain = build_aortic_root(tube, line);
  ASSERT_TRUE(plain.root) << plain.reason;
  EXPECT_TRUE(plain.root->built);
  EXPECT_NEAR(plain.root->annulus.center.z(), 0.022, 0.002);  // one bore from the inlet
  EXPECT_NEAR(plain.root->annulus.mean_diameter, 0.022, 0.0003);
  EXPECT_NEAR((plain.root->sinotubular_junction.center - plain.root->annulus.center).norm(), 1.54 * 0.011, 0.0005);
  BuiltRootMeasures measures;
  measures.height = 0.02;
  measures.distance = 0.04;
  measures.annulus_diameter = 0.026;
  const RootSearch given = build_aortic_root(tube, line, measures);
  ASSERT_TRUE(given.root) << given.reason;
  EXPECT_NEAR(given.root->annulus.center.z(), 0.04, 0.002);
  EXPECT_NEAR((given.root->sinotubular_junction.center - given.root->annulus.center).norm(), 0.02, 0.0005);
  EXPECT_GE(given.warnings.size(), 2u);  // built; and the vessel is narrower than asked
  measures.distance = 0.09;
  EXPECT_NE(build_aortic_root(tube, line, measures).reason.find("too short"), std::string::npos);
}

TEST(RootFrame, IsRightHandedAndKeepsAngles) {
  const RootFrame frame = make_root_frame(patient().root);
  EXPECT_NEAR(frame.x_axis.cross(frame.y_axis).dot(frame.axis), 1, 1e-12);
  EXPECT_NEAR(frame.junction_height, (patient().root.sinotubular_junction.center - patient().root.annulus.center).norm(), 1e-12);
  EXPECT_NEAR(frame.commissure_angles[0], 0, 1e-9);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d local = frame.to_local(patient().root.commissures[i]);
    const Vector3d back = frame.to_world(std::hypot(local.x(), local.y()), frame.commissure_angles[i], frame.commissure_heights[i]);
    EXPECT_LT((back - patient().root.commissures[i]).norm(), 1e-12);
    EXPECT_GT(frame.nadir_angles[i], frame.commissure_angles[i]);
  }
}

TEST(WallRadius, FollowsTheWall) {
  const RootFrame frame = make_root_frame(patient().root);
  const WallRadius wall(patient().lumen, frame);
  for (double z : {0.002, 0.008, 0.015, 0.025})
    for (double theta = 0; theta < 6.2; theta += 0.5) {
      const Vector3d on_wall = frame.to_world(wall.radius_at(theta, z), theta, z);
      EXPECT_NEAR(std::hypot(on_wall.x(), on_wall.y()), synthetic_radius({}, std::atan2(on_wall.y(), on_wall.x()), on_wall.z()), 1.5e-4);
    }
  EXPECT_NE(test::error_of([&] { wall.radius_at(0, 1); }).find("leaves the lumen"), std::string::npos);
}

TEST(CutDomain, KeepsTheRootBetweenTwoFlatPorts) {
  const TriangleMesh& lumen = patient().lumen;
  const CutDomain domain = cut_domain(lumen, line_of(lumen, patient().ports[0].point, patient().ports[1].point), patient().root);
  const MeshTopology topology = measure_topology(domain.surface);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.mismatched_edges, 0u);
  EXPECT_TRUE(self_intersections(domain.surface).empty());
  ASSERT_EQ(domain.ports.size(), 2u);
  EXPECT_EQ(domain.ports[0].name, "ventricle");
  EXPECT_EQ(domain.ports[1].name, "aorta");
  EXPECT_LT(degrees_between(domain.ports[0].normal, -Vector3d::UnitZ()), 6);
  EXPECT_LT(degrees_between(domain.ports[1].normal, Vector3d::UnitZ()), 6);
  for (const DomainPort& port : domain.ports) {
    int on_plane = 0;  // the end is flat: nothing lies beyond it, its rim lies in it
    for (const Vector3d& v : domain.surface.vertices) {
      if ((v - port.point).norm() > 0.03) continue;
      EXPECT_LT((v - port.point).dot(port.normal), 1e-9);
      on_plane += std::abs((v - port.point).dot(port.normal)) < 1e-9;
    }
    EXPECT_GE(on_plane, 12);
    EXPECT_NEAR(2 * std::sqrt(port.area / std::numbers::pi), 0.025, 0.005);
    EXPECT_GT(port.radius, 0.9 * std::sqrt(port.area / std::numbers::pi));
  }
  // Annulus at z = 0, junction 18.5 mm above: 12-20 mm below and 25-40 mm above, and 20 mm of extension each.
  EXPECT_GT(domain.ports[0].point.z(), -0.043);
  EXPECT_LT(domain.ports[0].point.z(), -0.030);
  EXPECT_GT(domain.ports[1].point.z(), 0.0185 + 0.043);
  EXPECT_LT(domain.ports[1].point.z(), 0.0185 + 0.063);
}

TEST(CutDomain, LengthensTheExtensionWhereTheVesselIsShort) {
  const TriangleMesh tube = test::make_cylinder(0.011, 0.06, 60, 60, true);
  const Centreline line = line_of(tube, {0, 0, 0}, {0, 0, 0.06});
  BuiltRootMeasures measures;
  measures.distance = 0.01;
  measures.height = 0.018;
  const RootSearch built = build_aortic_root(tube, line, measures);
  ASSERT_TRUE(built.root) << built.reason;
  const CutDomain domain = cut_domain(tube, line, *built.root);
  EXPECT_TRUE(measure_topology(domain.surface).closed());
  EXPECT_FALSE(domain.warnings.empty());
  EXPECT_LT(domain.ports[0].point.z(), 0.01 - 0.011 - 0.018);
}

}  // namespace
