// Cases built from scenes: rows in their order, regions resolved, what can't be is refused.
#include "app/build_case.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace {

using app::build_case;
using app::parse_scene_text;

const std::string head = "dimension = 2\nspacing = 0.1\n[time]\nend = 1\n";
const std::string water =
    "[[body]]\nname = \"water\"\nkind = \"fluid\"\nshape = { type = \"box\", min = [0, 0], max = [1, 0.5] }\nmaterial = { density = 1000 "
    "}\n";
const std::string tank =
    "[[body]]\nname = \"tank\"\nkind = \"wall\"\nshape = { type = \"box\", min = [-0.3, -0.3], max = [1.3, 1], subtract = [ { type = "
    "\"box\", min = [0, 0], max = [1, 1] } ] }\n";
std::string block(const std::string& extra = "") {
  return "[[body]]\nname = \"block\"\nkind = \"elastic\"\nshape = { type = \"box\", min = [2, 0], max = [3, 0.4] }\n"
         "material = { density = 1000, youngs_modulus = 1e5, poisson_ratio = 0.3 }\n" +
         extra;
}
const std::string clamp = "fixed = [ { type = \"box\", min = [2, 0], max = [2.2, 0.4] } ]\n";

app::BuiltCase<2> built(const std::string& text) { return build_case<2>(parse_scene_text(text, "case.toml")); }
std::string refusal(const std::string& text) {
  try {
    built(text);
  } catch (const app::SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(BuildCase, OrdersRowsElasticWallFluidWhateverTheFilesOrder) {
  const auto scene = built(head + water + tank + block(clamp)).description;
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[0].name, "water");
  EXPECT_EQ(scene.bodies[0].count, 50);
  EXPECT_EQ(scene.bodies[2].first, 0);
  EXPECT_EQ(scene.bodies[2].count, 40);
  EXPECT_EQ(scene.bodies[1].first, 40);
  EXPECT_EQ(scene.bodies[0].first, 40 + scene.bodies[1].count);
  for (std::size_t i = 1; i < scene.particles.size(); ++i) EXPECT_LE(scene.particles.kind[i - 1], scene.particles.kind[i]);
  double volume = 0;
  for (std::int64_t i = 0; i < 40; ++i) volume += scene.particles.volume[static_cast<std::size_t>(i)];
  EXPECT_NEAR(volume, 0.4, 1e-12);
}

TEST(BuildCase, HoldsTheParticlesWhoseCentreIsInTheRegion) {
  const auto scene = built(head + block(clamp)).description;
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    EXPECT_EQ(scene.particles.fixed[i], scene.particles.position[i].x() < 2.2 ? 3 : 0);
}

TEST(BuildCase, SharesAForceOutEvenlySoThatItActsAtTheFace) {
  const auto scene =
      built(head + block(clamp) + "[[load]]\nbody = \"block\"\nregion = { type = \"box\", min = [3, 0], max = [3, 0.4] }\nforce = [0, 8]\n")
          .description;
  const auto& load = scene.loads.at(0);
  // An even traction: a share and an offset, to the face, of each of the four rows beside it (sim/solid_loads.h).
  ASSERT_EQ(load.rows.size(), 4u);
  ASSERT_EQ(load.share.size(), 12u);
  for (std::size_t k = 0; k < load.rows.size(); ++k) {
    EXPECT_NEAR(load.share[3 * k], 0.25, 1e-12);
    EXPECT_NEAR(scene.particles.position[static_cast<std::size_t>(load.rows[k])].x() + load.share[3 * k + 1], 3, 1e-12);
    EXPECT_NEAR(load.share[3 * k + 2], 0, 1e-12);
  }
}

TEST(BuildCase, AForceOnATipWithoutASurfaceOfItsOwnActsThere) {
  // A region that holds no centre and no middle of a cell's face: the rows whose cells it cuts.
  const auto scene = built(head + block(clamp) +
                           "[[load]]\nbody = \"block\"\nregion = { type = \"box\", min = [2.96, 0.19], max = [3, 0.21] }\nforce = [0, 8]\n")
                         .description;
  const auto& load = scene.loads.at(0);
  ASSERT_EQ(load.share.size(), load.rows.size());
  double sum = 0, moment = 0;
  for (std::size_t k = 0; k < load.rows.size(); ++k) {
    sum += load.share[k];
    moment += load.share[k] * scene.particles.position[static_cast<std::size_t>(load.rows[k])].x();
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_GT(moment, 2.95 - 1e-12);
  EXPECT_LT(moment, 3);
}

TEST(BuildCase, APressureActsOnTheSurfaceInItsRegion) {
  const auto scene = built(head + block(clamp) +
                           "[[load]]\nbody = \"block\"\nregion = { type = \"box\", min = [2.4, 0.39], max = [2.8, 0.41] }\npressure = 5\n")
                         .description;
  const auto& rows = scene.loads.at(0).rows;
  EXPECT_EQ(rows.size(), 4u);
  for (std::int64_t row : rows) EXPECT_NEAR(scene.particles.position[static_cast<std::size_t>(row)].y(), 0.35, 1e-12);
}

TEST(BuildCase, AThinElasticBoxIsABeamOfItsThickness) {
  std::string text = head + block(clamp);
  text.replace(text.find("max = [3, 0.4]"), 14, "max = [3, 0.03]");
  const auto scene = built(text).description;
  EXPECT_EQ(scene.bodies[0].kind, sim::Kind::shell);
  EXPECT_NEAR(scene.bodies[0].elastic.thickness, 0.03, 1e-15);
  ASSERT_EQ(scene.particles.size(), 10u);
  ASSERT_EQ(scene.shell_meshes.size(), 1u);
  EXPECT_EQ(scene.shell_meshes[0].elements.size(), 9u);
  for (const auto& element : scene.shell_meshes[0].elements) {
    const sim::Vector<2> along =
        scene.particles.position[static_cast<std::size_t>(element[1])] - scene.particles.position[static_cast<std::size_t>(element[0])];
    EXPECT_GT(sim::Vector<2>(-along.y(), along.x()).dot(scene.particles.normal[static_cast<std::size_t>(element[0])]), 0);
  }
  EXPECT_NEAR(scene.particles.position[3].y(), 0.015, 1e-12);
  EXPECT_NEAR(scene.particles.volume[3], 0.1, 1e-12);
}

TEST(BuildCase, AThinElasticBoxIn3DIsASheetWithOutwardTriangles) {
  const auto scene =
      build_case<3>(parse_scene_text("dimension = 3\nspacing = 0.1\n[time]\nend = 1\n[[body]]\nname = \"sheet\"\nkind = \"elastic\"\n"
                                     "shape = { type = \"box\", min = [0, 0, 0], max = [0.02, 0.4, 0.6] }\n"
                                     "material = { density = 1000, youngs_modulus = 1e5, poisson_ratio = 0.3 }\n",
                                     "sheet.toml"))
          .description;
  EXPECT_EQ(scene.particles.size(), 24u);
  EXPECT_EQ(scene.shell_meshes[0].elements.size(), 30u);
  for (const auto& t : scene.shell_meshes[0].elements) {
    const auto& x = scene.particles.position;
    const Eigen::Vector3d normal = (x[static_cast<std::size_t>(t[1])] - x[static_cast<std::size_t>(t[0])])
                                       .cross(x[static_cast<std::size_t>(t[2])] - x[static_cast<std::size_t>(t[0])]);
    EXPECT_GT(normal.dot(scene.particles.normal[static_cast<std::size_t>(t[0])]), 0);
    EXPECT_GT(normal.x(), 0);
  }
}

TEST(BuildCase, StiffnessMapScalesItsRegion) {
  const auto scene =
      built(head +
            block(clamp + "stiffness_map = [ { region = { type = \"sphere\", center = [2.5, 0.2], radius = 0.11 }, scale = 30 } ]\n"))
          .description;
  int stiff = 0;
  for (double scale : scene.particles.stiffness_scale) stiff += scale == 30;
  EXPECT_EQ(stiff, 4);
}

TEST(BuildCase, RefusesOverlapsAndWhatLiesOutsideTheDomain) {
  EXPECT_NE(refusal(head + water + block(clamp + "") +
                    "[[body]]\nname = \"other\"\nkind = \"wall\"\nshape = { type = \"box\", min = [0.8, 0], max = [1.5, 0.5] }\n")
                .find("water"),
            std::string::npos);
  const std::string domain = "[domain]\nmin = [-1, -1]\nmax = [2.5, 1]\n";
  EXPECT_NE(refusal(head + domain + block(clamp)).find("out of the domain along x"), std::string::npos);
}

TEST(BuildCase, RefusesTooManyParticlesAndSaysWhichSpacingFits) {
  const std::string line = refusal(head + "[limits]\nparticles = 40\n" + water);
  EXPECT_NE(line.find("limits.particles = 40"), std::string::npos) << line;
  EXPECT_NE(line.find("a spacing of 0.113"), std::string::npos) << line;  // 0.1 sqrt(50 / 40) and a little
}

TEST(BuildCase, RefusesAnElasticBodyThatNothingHoldsInAStaticScene) {
  std::string text = head;
  text.replace(text.find("end = 1"), 7, "mode = \"static\"");
  EXPECT_NE(refusal(text + block()).find("nothing holds it along x"), std::string::npos);
  EXPECT_NE(refusal(text + block("fixed = [ { type = \"box\", min = [2, 0], max = [2.2, 0.4], directions = [\"x\"] } ]\n"))
                .find("nothing holds it along y"),
            std::string::npos);
  EXPECT_EQ(refusal(text + block(clamp)), "accepted");
}

TEST(BuildCase, RefusesARegionWithoutParticles) {
  EXPECT_NE(refusal(head + block("fixed = [ { type = \"box\", min = [5, 5], max = [6, 6] } ]\n")).find("holds no particle"),
            std::string::npos);
}

TEST(BuildCase, AccelerationFormulasSeePlaceAndTime) {
  const auto scene = built(head + water + "[[load]]\nbody = \"water\"\nacceleration = [\"2*x+t\", \"-y\"]\n").description;
  const sim::Vector<2> a = scene.loads.at(0).acceleration(sim::Vector<2>(0.5, 0.25), 3);
  EXPECT_DOUBLE_EQ(a.x(), 4);
  EXPECT_DOUBLE_EQ(a.y(), -0.25);
  EXPECT_TRUE(scene.loads[0].rows.empty());
}

}  // namespace
