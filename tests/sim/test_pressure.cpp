// The pressure equation's special places: drops that touch nothing, walls thinner than the kernel.
#include "sim/pressure.h"

#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/number_density.h"
#include "sim/step.h"

namespace sim {
namespace {

// A drop however its particles lie falls as a rigid body: nothing pushes it (equivalence principle).
TEST(FreeFall, IsExactForAnIrregularDrop) {
  testing::FluidScene<2> scene;
  scene.description.spacing = 0.01;
  scene.start_body("drop", Kind::fluid);
  scene.description.bodies.back().fluid = {1000, Newtonian{0}};
  std::uint32_t noise = 12345;
  const auto jitter = [&] { return 0.002 * ((noise = noise * 1664525u + 1013904223u) / 4294967296.0 - 0.5); };
  for (int j = -7; j <= 7; ++j)
    for (int i = -7; i <= 7; ++i)
      if (i * i + j * j <= 50) scene.add({0.01 * i + jitter(), 0.01 * j + jitter()});
  scene.description.gravity = Vector<2>(0, -9.81);
  scene.description.scheme.density_blend = scene.description.scheme.density_tolerance = 0;  // the jitter's own density error would push
  scene.description.scheme.shifting = 0;
  scene.description.time.step = 1e-3;
  const Scene<2> built = make_scene(scene.description);
  ASSERT_TRUE(built.pressure->free_surface);
  State<2> state = initial_state(built);
  const State<2> before = state;
  Workspace<2> work;
  for (int k = 0; k < 5; ++k) step(built, state, work, 1.0);
  for (std::size_t i = 0; i < state.size(); ++i) {
    EXPECT_NEAR(state.velocity[i][0], 0, 1e-12);
    EXPECT_NEAR(state.velocity[i][1], -9.81 * 5e-3, 1e-12);
    EXPECT_NEAR((state.position[i] - before.position[static_cast<std::size_t>(state.id[i])])[1], -9.81 * 1e-6 * 15, 1e-12);
  }
}

// Water on one side of a wall of one layer: nothing of it is felt on the other side, at either kernel radius.
TEST(ThinWalls, CutEveryLinkAcrossAndNoOther) {
  for (double radius : {2.1, 3.1}) {
    testing::FluidScene<2> scene;
    const double l0 = scene.description.spacing = 0.01;
    scene.start_body("wall", Kind::wall);
    for (int j = -6; j <= 6; ++j) scene.add({0, j * l0}, Vector<2>::Zero(), {1, 0}, 0.5 * l0);
    scene.start_body("water", Kind::fluid);
    scene.description.bodies.back().fluid = {1000, Newtonian{0}};
    for (int j = -4; j <= 4; ++j)
      for (int i = -4; i <= 4; ++i)
        if (i != 0) scene.add({i * l0, j * l0});
    scene.description.scheme.kernel_radius = radius;
    Scene<2> built = make_scene(scene.description);
    std::fill(built.back_depth.begin(), built.back_depth.end(), 0.5 * l0);  // one layer: the other face is as near
    const State<2> state = initial_state(built);
    Workspace<2> work;
    find_neighborhood(built, state, work);
    std::size_t kept = 0;
    for (std::size_t i = static_cast<std::size_t>(built.first_fluid); i < state.size(); ++i)
      for (std::int64_t k = work.neighbors.start[i]; k < work.neighbors.start[i + 1]; ++k) {
        const std::int32_t j = work.neighbors.index[k];
        if (j < built.first_fluid) continue;
        const bool across = state.position[i][0] * state.position[j][0] < 0;
        EXPECT_EQ(work.link_weight[k] == 0, across) << state.position[i].transpose() << " to " << state.position[j].transpose();
        kept += !across;
      }
    EXPECT_GT(kept, 500u);
  }
}

}  // namespace
}  // namespace sim
