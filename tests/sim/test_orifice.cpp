#include "sim/orifice.h"

#include <gtest/gtest.h>

#include "tests/sim/shell_scenes.h"

namespace {

using namespace shell_scenes;

// A flat ring from `inner` to `outer`, the outermost row held, tilted frame; a polar mesh.
sim::SceneDescription<3> ring(double inner, double outer, sim::ValveFrame& valve) {
  sim::SceneDescription<3> scene;
  scene.spacing = 1e-3;
  const int rows = 8, around = 60;
  sim::ShellMesh<3> mesh;
  mesh.body = 0;
  for (int k = 0; k < rows; ++k)
    for (int j = 0; j < around; ++j) {
      const double r = inner + (outer - inner) * k / (rows - 1), a = 2 * M_PI * j / around;
      append<3>(scene, {r * std::cos(a), r * std::sin(a), 1e-3 * k}, {0, 0, 1}, 1e-6, k == rows - 1);
      if (k + 1 == rows) continue;
      const int next = (j + 1) % around;
      mesh.elements.push_back({k * around + j, (k + 1) * around + j, (k + 1) * around + next});
      mesh.elements.push_back({k * around + j, (k + 1) * around + next, k * around + next});
    }
  close_body(scene, tissue());
  scene.shell_meshes.push_back(mesh);
  valve.annulus_center = Eigen::Vector3d(0, 0, -5e-3);
  valve.axis = Eigen::Vector3d::UnitZ();
  valve.commissure_radius = outer;
  return scene;
}

TEST(Orifice, AreaOfARoundHole) {
  sim::ValveFrame valve;
  const auto shells = sim::build_shells(ring(5e-3, 12e-3, valve));
  for (double half_thickness : {0.0, 0.4e-3}) {
    const auto found = sim::geometric_orifice_area(shells, shells.rest_position, valve, half_thickness);
    const double expected = M_PI * std::pow(5e-3 - half_thickness, 2);
    EXPECT_NEAR(found.area, expected, 0.01 * expected);
    EXPECT_NEAR(found.largest_opening, found.area, 1e-12);
  }
}

TEST(Orifice, SmallHoleIsClosedByTheThickness) {
  sim::ValveFrame valve;
  const auto shells = sim::build_shells(ring(0.35e-3, 12e-3, valve));
  EXPECT_GT(sim::geometric_orifice_area(shells, shells.rest_position, valve, 0).area, 0.3e-6);
  EXPECT_EQ(sim::geometric_orifice_area(shells, shells.rest_position, valve, 0.4e-3).area, 0);
}

// Two strips that overlap by 3 of 8 mm: 3 x 5 mm2 on each side; free edges counted once per pair.
TEST(Orifice, CoaptationOfOverlappingStrips) {
  auto scene = strip(8e-3, 5e-3, 1e-3, 0, tissue());
  const std::size_t count = scene.particles.size();
  for (std::size_t i = 0; i < count; ++i)
    append<3>(scene, scene.particles.position[i] + Eigen::Vector3d(5e-3, 0, 0.5e-3), {0, 0, 1}, 1e-6, false);
  close_body(scene, tissue(), "other");
  const auto shells = sim::build_shells(scene);
  const auto found = sim::coaptation(shells, shells.rest_position, 0.6e-3);
  EXPECT_NEAR(found.area, 15e-6, 1e-9);
}

}  // namespace
