// What the density projection must do: take errors away with the smallest displacement, and leave alone what has none.
#include "sim/density_projection.h"

#include <gtest/gtest.h>

#include "sim/fluid_scenes.h"
#include "sim/step.h"

namespace sim {
namespace {

double jitter(std::uint64_t& dice) {  // in [-1, 1)
  dice = dice * 6364136223846793005u + 1442695040888963407u;
  return static_cast<double>(dice >> 33) / (1u << 30) - 1;
}

// A round drop of `radius` spacings, its lattice stretched by `stretch`, with `unevenness` spacings of jitter.
Scene<2> drop(int radius, double stretch, double unevenness) {
  testing::FluidScene<2> scene;
  const double l0 = scene.description.spacing = 0.01;
  scene.start_body("drop", Kind::fluid);
  scene.description.bodies.back().fluid = {1000, Newtonian{0}};
  std::uint64_t dice = 7;
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) {
      const double x = jitter(dice), y = jitter(dice);
      if (i * i + j * j <= radius * radius) scene.add(l0 * (stretch * Vector<2>(i, j) + unevenness * Vector<2>(x, y)));
    }
  return make_scene(scene.description);
}

// Mean of |n/n0 - 1| inside.
double mean_error(const Scene<2>& scene, const State<2>& state, Workspace<2>& work) {
  find_neighborhood(scene, state, work);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < state.size(); ++i)
    if (work.surface[i] == 0) sum += std::abs(work.number_density[i] - 1), count += 1;
  return sum / count;
}

TEST(DensityProjection, MendsAnUnevenArrangementToItsTolerance) {
  const Scene<2> scene = drop(14, 1, 0.05);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  const double before = mean_error(scene, state, work);
  ASSERT_GT(before, 0.005);
  for (int k = 0; k < 3; ++k) {  // Newton's steps: what curvature leaves of one goes with the next
    mean_error(scene, state, work);
    const std::vector<Vector<2>> start = state.position;
    const DensityReport report = project_density(scene, state, work);
    EXPECT_LE(report.after, scene.description.scheme.density_tolerance);
    for (std::size_t i = 0; i < state.size(); ++i) EXPECT_LE((state.position[i] - start[i]).norm(), 0.0501 * scene.lattice.spacing);
  }
  EXPECT_LT(mean_error(scene, state, work), 1.5 * scene.description.scheme.density_tolerance);
}

// J^T l pushes pairs apart by as much: no net displacement of a drop that touches nothing. Squeezed by 0.7 % in area, it widens again.
TEST(DensityProjection, KeepsTheCentreOfMassOfAFreeDropAndGivesItItsVolume) {
  const Scene<2> scene = drop(12, 0.9965, 0.005);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  const auto centre_and_area = [&] {
    Vector<2> centre = Vector<2>::Zero();
    double squares = 0;
    for (const Vector<2>& x : state.position) centre += x, squares += x.squaredNorm();
    return std::pair(Vector<2>(centre / static_cast<double>(state.size())), squares);
  };
  const auto [centre, area] = centre_and_area();
  ASSERT_GT(mean_error(scene, state, work), 0.007);
  for (int k = 0; k < 3; ++k) mean_error(scene, state, work), project_density(scene, state, work);
  const auto [after, larger] = centre_and_area();
  EXPECT_LT((after - centre).norm(), 1e-6 * scene.lattice.spacing);  // sums in single precision
  EXPECT_GT(larger / area, 1.0035);                                  // half of it: the outermost rows may keep 1 %
  EXPECT_LT(larger / area, 1.001 / (0.9965 * 0.9965));
  EXPECT_LT(mean_error(scene, state, work), 0.001);
}

TEST(DensityProjection, LeavesALatticeAndItsSurfaceAlone) {
  const Scene<2> scene = make_scene(testing::tank(0.01, 16, 20, 16, 12).description);
  State<2> state = initial_state(scene);
  Workspace<2> work;
  find_neighborhood(scene, state, work);
  const std::vector<Vector<2>> before = state.position;
  EXPECT_EQ(project_density(scene, state, work).iterations, 0);
  for (std::size_t i = 0; i < state.size(); ++i) EXPECT_EQ(state.position[i], before[i]);
}

TEST(DensityProjection, IsOffWhereItsToleranceIsZeroOrNoSurfaceIsFree) {
  testing::FluidScene<2> tank = testing::tank(0.01, 12, 16, 12, 10);
  tank.description.particles.position.back() += Vector<2>(-0.003, -0.003);
  tank.description.scheme.density_tolerance = 0;
  const Scene<2> off = make_scene(tank.description);
  const Scene<2> full = make_scene(testing::channel(0.05, 10, {1000, Newtonian{1e-3}}, 1).description);
  for (const Scene<2>* scene : {&off, &full}) {
    State<2> state = initial_state(*scene);
    state.position.back() += Vector<2>(0.002, -0.002);
    Workspace<2> work;
    find_neighborhood(*scene, state, work);
    EXPECT_EQ(project_density(*scene, state, work).before, 0);
  }
}

}  // namespace
}  // namespace sim
