#include "geometry/surface_particles.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "geometry/synthetic_aorta.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;

const ValveTemplate& valve() {
  static const SyntheticAorta aorta;
  static const ValveTemplate value =
      make_valve_template(make_synthetic_patient(aorta).frame, [](double theta, double z) { return synthetic_radius(aorta, theta, z); });
  return value;
}
constexpr double spacing = 1.2e-3;  // 0.8 of 1.5 mm
const SurfaceParticles& leaflet() {
  static const SurfaceParticles value = leaflet_particles(valve().leaflets[0], spacing, 2);
  return value;
}

TEST(SurfaceParticles, AreasAddUpToTheLeaflets) {
  double free = 0;
  for (std::size_t i = 0; i < leaflet().size(); ++i)
    if (!leaflet().embedded[i]) free += leaflet().area[i];
  EXPECT_NEAR(free, valve().leaflets[0].measures.area, 1e-6 * free);
}

TEST(SurfaceParticles, AttachmentComesFirstInEvenSteps) {
  const SurfaceParticles& p = leaflet();
  std::size_t count = 0;
  while (p.attached[count] && !p.embedded[count]) ++count;
  EXPECT_GT(count, 30u);
  for (std::size_t i = 1; i < count; ++i) EXPECT_NEAR((p.position[i] - p.position[i - 1]).norm(), spacing, 0.06 * spacing);
  // Two more rows of as many particles lie in the wall, each a spacing further.
  EXPECT_EQ(std::accumulate(p.embedded.begin(), p.embedded.end(), 0u), 2 * count);
  EXPECT_EQ(std::accumulate(p.attached.begin(), p.attached.end(), 0u), 3 * count);
  for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR((p.position[p.size() - count + i] - p.position[i]).norm(), 2 * spacing, 1e-9);
}

TEST(SurfaceParticles, EmbeddedRowsLieInTheWall) {
  const SyntheticAorta aorta;
  const SyntheticPatient patient = make_synthetic_patient(aorta);
  for (std::size_t i = 0; i < leaflet().size(); ++i) {
    if (!leaflet().embedded[i]) continue;
    const Vector3d p = patient.frame.to_local(leaflet().position[i]);
    EXPECT_GT(p.head<2>().norm() - synthetic_radius(aorta, std::atan2(p.y(), p.x()), p.z()), -0.1 * spacing);
  }
}

TEST(SurfaceParticles, TrianglesAreGoodAndFaceTheAorta) {
  const SurfaceParticles& p = leaflet();
  std::map<std::pair<int, int>, int> directed;
  double quality = 0;
  Vector3d sum = Vector3d::Zero();
  for (const auto& t : p.triangles) {
    const Vector3d area = 0.5 * (p.position[t[1]] - p.position[t[0]]).cross(p.position[t[2]] - p.position[t[0]]);
    double edges = 0;
    for (int k = 0; k < 3; ++k) {
      const Vector3d edge = p.position[t[(k + 1) % 3]] - p.position[t[k]];
      edges += edge.squaredNorm();
      EXPECT_LT(edge.norm(), 2.2 * spacing);               // no hole wider than two spacings
      EXPECT_EQ((++directed[{t[k], t[(k + 1) % 3]}]), 1);  // oriented alike, two triangles an edge at most
    }
    quality += 4 * std::sqrt(3.0) * area.norm() / edges / double(p.triangles.size());  // 1 for an equilateral triangle
    sum += area;
  }
  EXPECT_GT(quality, 0.93);
  EXPECT_GT(sum.z(), 0.3 * sum.norm());
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(p.fibre[i].norm(), 1, 1e-9);
    EXPECT_NEAR(p.fibre[i].dot(p.normal[i]), 0, 1e-9);
  }
}

TEST(SurfaceParticles, NoTwoParticlesCrowd) {
  const SurfaceParticles& p = leaflet();
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((p.position[i] - p.position[j]).norm(), 0.5 * spacing);
}

TEST(SurfaceParticles, FlatSheetFromAnyMesh) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.01, 0}, {0, 0.01, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SurfaceParticles p = mesh_particles(sheet, 1e-3);
  EXPECT_NEAR(std::accumulate(p.area.begin(), p.area.end(), 0.0), 2e-4, 1e-12);
  EXPECT_NEAR(double(p.size()), 2e-4 / (0.866e-6), 0.35 * 2e-4 / 0.866e-6);
  for (const Vector3d& n : p.normal) EXPECT_NEAR(n.z(), 1, 1e-9);
  for (const Vector3d& f : p.fibre) EXPECT_NEAR(std::abs(f.x()), 1, 1e-9);
}

TEST(SurfaceParticles, BranchingSurfaceIsRefused) {
  TriangleMesh fins;  // three triangles on one edge
  fins.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  fins.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  EXPECT_THROW(mesh_particles(fins, 0.1), std::runtime_error);
}

}  // namespace
