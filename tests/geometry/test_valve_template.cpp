#include "geometry/valve_template.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/synthetic_aorta.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;

struct Fitted {
  SyntheticAorta aorta;
  SyntheticPatient patient = make_synthetic_patient();
  ValveTemplate valve = make_valve_template(patient.frame, [this](double theta, double z) { return synthetic_radius(aorta, theta, z); });
};
const Fitted& fitted() {
  static const Fitted value;
  return value;
}

// Labrosse's worked example: Rb 13, Rc 12, H 16.8, Lf 30, Lh 17 mm; Xs 3.2, a 19.4 degrees solve it.
TEST(ValveTemplate, LabrosseExample) {
  ValveOptions options;
  options.free_edge_angle = std::atan(9.0 / 12);
  options.coaptation_ratio = 3.2 / 12;
  const LeafletMeasures m = labrosse_measures(13e-3, 12e-3, 16.8e-3, options);
  EXPECT_NEAR(1e3 * m.free_edge_length, 30, 0.01);
  EXPECT_NEAR(1e3 * m.height, 17, 0.05);
  EXPECT_NEAR(m.base_angle * 180 / pi, 19.4, 0.2);
}

// Thubrikar 1981: Rb/Rc 1.2, H/Rc 1.4, phi 34, a 20 degrees imply Lf 2.41, Lh 1.57, Xs 0.29 Rc.
TEST(ValveTemplate, ThubrikarProportions) {
  ValveOptions options;
  options.free_edge_angle = 34 * pi / 180;
  options.coaptation_ratio = 0.29;
  const LeafletMeasures m = labrosse_measures(1.2, 1, 1.4, options);
  EXPECT_NEAR(m.free_edge_length, 2.41, 0.01);
  EXPECT_NEAR(m.height, 1.57, 0.01);
  EXPECT_NEAR(m.base_angle * 180 / pi, 20, 0.5);
}

TEST(ValveTemplate, ReferenceKeepsTheDesignsLengths) {
  EXPECT_LE(fitted().valve.largest_strain, 0.02);
  EXPECT_TRUE(fitted().valve.warnings.empty());
  for (const LeafletSurface& leaflet : fitted().valve.leaflets)
    for (int c = 4; c + 4 < leaflet.columns; c += 4) {
      double design = 0, reference = 0;
      for (int r = 1; r < leaflet.rows; ++r) {
        design += (leaflet.design[leaflet.index(r, c)] - leaflet.design[leaflet.index(r - 1, c)]).norm();
        reference += (leaflet.reference[leaflet.index(r, c)] - leaflet.reference[leaflet.index(r - 1, c)]).norm();
      }
      EXPECT_NEAR(reference / design, 1, 0.02) << c;
    }
}

TEST(ValveTemplate, AttachmentLiesOnTheWallAndTheRestInside) {
  const Fitted& f = fitted();
  for (const LeafletSurface& leaflet : f.valve.leaflets) {
    EXPECT_LT(leaflet.measures.attachment_gap_max, 0.1e-3);
    for (int r = 0; r < leaflet.rows; ++r)
      for (int c = 0; c < leaflet.columns; ++c) {
        const Vector3d p = f.patient.frame.to_local(leaflet.reference[leaflet.index(r, c)]);
        const double inside = synthetic_radius(f.aorta, std::atan2(p.y(), p.x()), p.z()) - p.head<2>().norm();
        if (r == 0) {
          EXPECT_NEAR(inside, 0, 1e-6);
        } else {
          EXPECT_GT(inside, -0.1e-3);
        }
      }
  }
}

TEST(ValveTemplate, LeafletsKeepToTheirSectorsSoTheyDoNotMeet) {
  const Fitted& f = fitted();
  const double gap = 1e-3;  // sector_offset
  for (int i = 0; i < 3; ++i) {
    const double from = f.patient.frame.commissure_angles[i], to = from + 2 * pi / 3;
    for (const Vector3d& world : f.valve.leaflets[i].reference) {
      const Vector3d p = f.patient.frame.to_local(world);
      EXPECT_GE(-std::sin(from) * p.x() + std::cos(from) * p.y(), gap - 1e-6);
      EXPECT_GE(std::sin(to) * p.x() - std::cos(to) * p.y(), gap - 1e-6);
    }
  }
}

// The pressure that closes it has brought the free edges to the sector planes: a slit, where each half edge's surplus (the over-closure)
// stands off in one wave, not a hole. A wave of height a on a half edge of 13 mm takes up about 2.5 a²/13 mm: 1 mm of surplus makes 2.3 mm.
TEST(ValveTemplate, FreeEdgesLieAlongTheSlit) {
  const Fitted& f = fitted();
  const LeafletSurface& leaflet = f.valve.leaflets[0];
  const double from = f.patient.frame.commissure_angles[0], to = f.patient.frame.commissure_angles[1], gap = 1e-3;
  std::vector<double> distance;
  for (int c = 0; c < leaflet.columns; ++c) {
    const Vector3d p = f.patient.frame.to_local(leaflet.reference[leaflet.index(leaflet.rows - 1, c)]);
    distance.push_back(std::min(-std::sin(from) * p.x() + std::cos(from) * p.y(), std::sin(to) * p.x() - std::cos(to) * p.y()));
  }
  int waves = 0;
  for (int c = 1; c + 1 < leaflet.columns; ++c) {
    EXPECT_LT(distance[c], gap + 3e-3) << c;
    waves += distance[c] > gap + 1.2e-3 && distance[c] > distance[c - 1] && distance[c] >= distance[c + 1];
  }
  EXPECT_EQ(waves, 2);
  for (int c : {0, 1, 2, leaflet.columns / 2, leaflet.columns - 3, leaflet.columns - 1}) EXPECT_LT(distance[c], gap + 1.2e-3) << c;
}

// No crease: neighbouring facets never turn by more than 66 degrees.
TEST(ValveTemplate, ReferenceIsSmooth) {
  const LeafletSurface& leaflet = fitted().valve.leaflets[0];
  const auto normal = [&](int r, int c) {
    const Vector3d a = leaflet.reference[leaflet.index(r + 1, c + 1)] - leaflet.reference[leaflet.index(r, c)];
    const Vector3d b = leaflet.reference[leaflet.index(r + 1, c)] - leaflet.reference[leaflet.index(r, c + 1)];
    return Vector3d(a.cross(b).normalized());
  };
  for (int r = 1; r + 2 < leaflet.rows; ++r)
    for (int c = 1; c + 3 < leaflet.columns; ++c) {
      EXPECT_GT(normal(r, c).dot(normal(r, c + 1)), 0.4) << r << " " << c;
      EXPECT_GT(normal(r, c).dot(normal(r + 1, c)), 0.4) << r << " " << c;
    }
}

TEST(ValveTemplate, ThreeEqualSectorsGiveThreeEqualLeaflets) {
  const auto& leaflets = fitted().valve.leaflets;
  for (int i = 1; i < 3; ++i) {
    EXPECT_NEAR(leaflets[i].measures.area, leaflets[0].measures.area, 2e-3 * leaflets[0].measures.area);
    EXPECT_NEAR(leaflets[i].measures.free_edge_length, leaflets[0].measures.free_edge_length, 1e-6);
  }
}

TEST(ValveTemplate, NormalsPointToTheAorta) {
  const Fitted& f = fitted();
  const LeafletSurface& leaflet = f.valve.leaflets[1];
  const TriangleMesh mesh = leaflet_mesh(leaflet, leaflet.reference);
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : mesh.triangles) sum += (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
  EXPECT_GT(sum.dot(f.patient.frame.axis), 0.3 * sum.norm());
}

TEST(ValveTemplate, TooLowARootIsRefused) {
  SyntheticAorta low;
  low.junction_height = 0.008;
  low.sinus_height = 0.004;
  const SyntheticPatient patient = make_synthetic_patient(low);
  EXPECT_THROW(make_valve_template(patient.frame, [&](double theta, double z) { return synthetic_radius(low, theta, z); }),
               std::runtime_error);
}

}  // namespace
