#include "sim/neighbors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sim {
namespace {

// Random points in [0, 1]^D; the lists must equal all pairs compared one by one.
template <int D>
void compare_with_all_pairs(bool periodic) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vector<D>> position(300);
  for (auto& x : position)
    for (int k = 0; k < D; ++k) x[k] = uniform(random);
  Domain<D> domain;
  domain.present = true;
  domain.max = Vector<D>::Ones();
  domain.periodic[0] = periodic;
  const double radius = 0.23;
  std::vector<Search> search(position.size(), Search::all);
  std::vector<std::uint8_t> is_fluid(position.size(), 1);
  for (std::size_t i = 0; i < position.size(); i += 3) search[i] = Search::fluid_only, is_fluid[i] = 0;
  search[5] = Search::none;
  Neighbors neighbors;
  CellGrid<D> grid;
  find_neighbors<D>(neighbors, grid, position, search, is_fluid, domain, radius);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    std::vector<std::int32_t> expected;
    for (std::size_t j = 0; j < position.size(); ++j) {
      Vector<D> r = position[j] - position[i];
      if (periodic) r[0] -= std::round(r[0]);
      if (i != j && r.norm() < radius && search[i] != Search::none && (search[i] == Search::all || is_fluid[j]))
        expected.push_back(static_cast<std::int32_t>(j));
    }
    std::vector<std::int32_t> found(neighbors.of(i).begin(), neighbors.of(i).end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << "row " << i;
    pairs += found.size();
  }
  EXPECT_GT(pairs, 500u);
}

TEST(Neighbors, MatchAllPairsIn2D) { compare_with_all_pairs<2>(false); }
TEST(Neighbors, MatchAllPairsIn3D) { compare_with_all_pairs<3>(false); }
TEST(Neighbors, MatchAllPairsAcrossPeriodicFaces) {
  compare_with_all_pairs<2>(true);
  compare_with_all_pairs<3>(true);
}

TEST(Neighbors, OneParticleFarAwayAsksForNoMoreMemory) {
  std::vector<Vector<3>> position{{0, 0, 0}, {0.1, 0, 0}, {5, 5, 5}, {1e9, -1e9, 1e9}};
  const std::vector<Search> search(position.size(), Search::all);
  const std::vector<std::uint8_t> is_fluid(position.size(), 1);
  Neighbors neighbors;
  CellGrid<3> grid;
  find_neighbors<3>(neighbors, grid, position, search, is_fluid, Domain<3>{}, 0.2);
  EXPECT_LE(grid.start.size(), 20'000'001u);
  ASSERT_EQ(neighbors.of(0).size(), 1u);
  EXPECT_EQ(neighbors.of(0)[0], 1);
  EXPECT_EQ(neighbors.of(2).size() + neighbors.of(3).size(), 0u);
}

}  // namespace
}  // namespace sim
