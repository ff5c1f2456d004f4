#include "sim/ordering.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace {

// Every particle keeps its values, the solids' rows stay, and no cell's particles are apart.
TEST(Ordering, KeepsParticlesTogetherByCells) {
  sim::Scene<3> scene;
  scene.first_fluid = 5;
  scene.lattice = sim::make_lattice(3, 1.0, 2.1);
  sim::State<3> state;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-7, 7);
  for (int i = 0; i < 505; ++i) {
    state.id.push_back(1000 + (i * 37) % 505);
    state.kind.push_back(i < 5 ? sim::Kind::wall : sim::Kind::fluid);
    state.body.push_back(i % 3);
    state.port.push_back(-1);
    state.position.emplace_back(place(random), place(random), place(random));
    state.velocity.push_back(2.0 * state.position.back());
    state.pressure.push_back(state.position.back().sum());
  }
  const sim::State<3> before = state;
  sim::sort_by_cells<3>(scene, state);
  std::map<std::int64_t, std::size_t> row;
  for (std::size_t i = 0; i < 505; ++i) row[before.id[i]] = i;
  std::map<std::array<long, 3>, std::size_t> last;
  for (std::size_t i = 0; i < 505; ++i) {
    const std::size_t was = row.at(state.id[i]);
    if (i < 5) EXPECT_EQ(was, i);
    EXPECT_EQ(state.position[i], before.position[was]);
    EXPECT_EQ(state.velocity[i], 2.0 * state.position[i]);
    EXPECT_EQ(state.pressure[i], state.position[i].sum());
    EXPECT_EQ(state.body[i], before.body[was]);
    if (i < 5) continue;
    std::array<long, 3> cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<long>(std::floor(state.position[i][k] / 2.1));
    if (last.count(cell)) EXPECT_EQ(last[cell], i - 1);
    last[cell] = i;
  }
  const sim::State<3> once = state;
  sim::sort_by_cells<3>(scene, state);
  EXPECT_EQ(state.id, once.id);
}

}  // namespace
