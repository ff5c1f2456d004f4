#include "app/jitter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/build_case.h"

namespace {

const std::string scene_text =
    "dimension = 2\nspacing = 0.1\n[time]\nend = 1\n"
    "[[body]]\nname = \"water\"\nkind = \"fluid\"\nshape = { type = \"box\", min = [0, 0], max = [2, 2] }\nmaterial = { density = 1000 }\n"
    "[[body]]\nname = \"block\"\nkind = \"elastic\"\nshape = { type = \"box\", min = [3, 0], max = [4, 1] }\n"
    "material = { density = 1000, youngs_modulus = 1e5, poisson_ratio = 0.3 }\nfixed = [ { type = \"box\", min = [3, 0], max = [3.1, 1] } "
    "]\n";

std::vector<sim::Vector<2>> positions(const std::vector<std::string>& settings) {
  return app::build_case<2>(app::parse_scene_text(scene_text, "case.toml", settings)).description.particles.position;
}

TEST(Jitter, MovesFluidEvenlyAndLeavesSurfaceLayersWhereTheyAre) {
  const auto plain = positions({}), moved = positions({"start.jitter=0.1"});
  ASSERT_EQ(plain.size(), moved.size());
  double square = 0, most = 0;
  int fluid = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const sim::Vector<2> shift = moved[i] - plain[i];
    if (plain[i].x() < 2.5) {
      square += shift.squaredNorm(), most = std::max(most, shift.cwiseAbs().maxCoeff()), ++fluid;
    } else {
      const double deep = std::min({plain[i].x() - 3, 4 - plain[i].x(), plain[i].y(), 1 - plain[i].y()});
      EXPECT_EQ(shift.norm() > 0, deep > 0.1) << plain[i].transpose();
    }
  }
  ASSERT_EQ(fluid, 400);
  EXPECT_LE(most, 0.01);
  EXPECT_GT(most, 0.0099);
  // Uniform in [-a, a]: variance a²/3 an axis; 800 numbers know it to 3 %.
  EXPECT_NEAR(square / (2 * fluid), 0.01 * 0.01 / 3, 0.1 * 0.01 * 0.01 / 3);
}

TEST(Jitter, DependsOnTheSeedAlone) {
  EXPECT_EQ(positions({"start.jitter=0.1", "start.seed=3"}), positions({"start.jitter=0.1", "start.seed=3"}));
  EXPECT_NE(positions({"start.jitter=0.1", "start.seed=3"}), positions({"start.jitter=0.1", "start.seed=4"}));
  EXPECT_EQ(positions({"start.jitter=0"}), positions({}));
  EXPECT_THROW(positions({"start.jitter=0.5"}), app::SceneError);
}

}  // namespace
