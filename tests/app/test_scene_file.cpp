// The scene reader: what is read, and that every mistake is one line with file, line, key and mend.
#include "app/scene_file.h"

#include <gtest/gtest.h>

#include <fstream>

#include "app/blood.h"

namespace {

using app::parse_scene_text;
using app::SceneFile;

const std::string plate = R"toml(title = "Elastic plate under a water column"
dimension = 2
spacing = 0.01
[domain]
min = [-0.1, -0.1]
max = [1.1, 3]
[time]
end = 1.0
step = "adaptive"
output = 0.01
[gravity]
acceleration = [0, -9.81]
[[body]]
name = "water"
kind = "fluid"
shape = { type = "box", min = [0, 0], max = [1, 2] }
material = { density = 1000, rheology = "newtonian", viscosity = 1e-3 }
velocity = ["-cos(2*pi*x)", 0.5]
[[body]]
name = "tank"
kind = "wall"
shape = { type = "box", min = [-0.05, 0], max = [1.05, 2.5], subtract = [ { type = "box", min = [0, 0], max = [1, 2.5] } ] }
motion = { surface_velocity = [1, 0] }
[[body]]
name = "plate"
kind = "elastic"
shape = { type = "box", min = [-0.05, -0.05], max = [1.05, 0] }
material = { density = 2700, law = "linear", youngs_modulus = 67.5e9, poisson_ratio = 0.34 }
fixed = [ { type = "box", min = [-0.05, -0.05], max = [0, 0] },
          { type = "box", min = [1, -0.05], max = [1.05, 0], directions = ["x"] } ]
[[load]]
body = "plate"
region = { type = "box", min = [0.4, -0.01], max = [0.6, 0] }
force = [0, -10]
ramp = 0.1
[[probe]]
name = "mid"
quantity = "displacement"
body = "plate"
at = [0.5, -0.025]
[reference]
mid = { y = -7.066e-5, source = "2-D elasticity", uncertainty = 1e-8 }
)toml";

SceneFile read(const std::string& text, const std::vector<std::string>& settings = {}) {
  return parse_scene_text(text, "plate.toml", settings);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text, const std::vector<std::string>& settings = {}) {
  try {
    read(text, settings);
  } catch (const app::SceneError& error) {
    const std::string line = error.what();
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    return line;
  }
  return "accepted";
}

void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& parts) {
  const std::string line = refusal(replaced(plate, from, to));
  for (const std::string& part : parts) EXPECT_NE(line.find(part), std::string::npos) << "\"" << line << "\" lacks \"" << part << "\"";
}

TEST(SceneFile, ReadsTheContractsExample) {
  const SceneFile scene = read(plate);
  EXPECT_EQ(scene.dimension, 2);
  EXPECT_EQ(scene.spacing, 0.01);
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[0].kind, sim::Kind::fluid);
  EXPECT_EQ(std::get<sim::Newtonian>(scene.bodies[0].fluid.rheology).viscosity, 1e-3);
  EXPECT_NEAR(scene.bodies[0].velocity.compile()({0.25, 0, 0}, 0).x(), 0, 1e-15);
  EXPECT_EQ(scene.bodies[0].velocity.compile()({0.5, 0, 0}, 0).x(), 1);
  EXPECT_EQ(scene.bodies[0].velocity.compile()({0.5, 0, 0}, 0).y(), 0.5);
  EXPECT_EQ(scene.bodies[1].shape.subtract.size(), 1u);
  EXPECT_EQ(scene.bodies[2].elastic.law, sim::ElasticLaw::linear);
  EXPECT_EQ(scene.bodies[2].fixed[0].directions, 3);
  EXPECT_EQ(scene.bodies[2].fixed[1].directions, 1);
  ASSERT_EQ(scene.motions.size(), 1u);
  EXPECT_EQ(scene.motions[0].surface_velocity.x(), 1);
  EXPECT_EQ(scene.loads[0].force->y(), -10);
  EXPECT_EQ(scene.loads[0].ramp, 0.1);
  EXPECT_EQ(scene.probes[0].probe.body, 2);
  EXPECT_EQ(scene.references[0].values[0].first, "y");
  EXPECT_EQ(scene.gravity->y(), -9.81);
}

TEST(SceneFile, NamesTheLineAndTheNearestKeyOfAMisspeltOne) {
  expect_refused("youngs_modulus", "youngs_modulis",
                 {"plate.toml:28:", "body.plate.material.youngs_modulis", "did you mean `youngs_modulus`?"});
  expect_refused("spacing = 0.01", "spaceing = 0.01", {"plate.toml:3: spaceing", "`spacing`"});
  expect_refused("output = 0.01", "outputs = 0.01", {"plate.toml:10: time.outputs", "`output`"});
}

TEST(SceneFile, RefusesMissingKeysAndWrongTypes) {
  expect_refused("spacing = 0.01\n", "", {"spacing", "is missing"});
  expect_refused("kind = \"fluid\"\n", "", {"plate.toml:13", "body.water.kind", "is missing"});
  expect_refused("spacing = 0.01", "spacing = \"0.01\"", {"plate.toml:3: spacing", "string", "number"});
  expect_refused("end = 1.0", "end = [1.0]", {"plate.toml:8: time.end", "array"});
  expect_refused("min = [0, 0], max = [1, 2]", "min = [0, 0, 0], max = [1, 2]", {"plate.toml:16:", "3 numbers", "give 2"});
}

TEST(SceneFile, RefusesImpossibleValues) {
  expect_refused("density = 1000", "density = -1", {"plate.toml:17: body.water.material.density", "-1", "above 0"});
  expect_refused("poisson_ratio = 0.34", "poisson_ratio = 0.5", {"poisson_ratio", "0.5 is impossible"});
  expect_refused("spacing = 0.01", "spacing = nan", {"spacing", "not a finite number"});
  expect_refused("spacing = 0.01", "spacing = 0", {"spacing", "above 0"});
  expect_refused("min = [0, 0], max = [1, 2]", "min = [0, 3], max = [1, 2]", {"body.water.shape.max", "along y"});
  expect_refused("dimension = 2", "dimension = 4", {"dimension", "2 or 3"});
  expect_refused("kind = \"fluid\"", "kind = \"fluids\"", {"\"fluids\" is not known", "\"fluid\""});
  expect_refused("body = \"plate\"\nregion", "body = \"plat\"\nregion", {"no body \"plat\"", "did you mean \"plate\"?"});
  expect_refused("quantity = \"displacement\"\nbody = \"plate\"", "quantity = \"stress\"\nbody = \"water\"",
                 {"probe.mid.quantity", "elastic"});
  expect_refused("force = [0, -10]", "pressure = 3\nforce = [0, -10]", {"load.0", "more than one load"});
  expect_refused("velocity = [\"-cos(2*pi*x)\", 0.5]", "velocity = [\"-cos(2*pi*x\", 0.5]",
                 {"plate.toml:18: body.water.velocity", "no formula"});
  expect_refused("velocity = [\"-cos(2*pi*x)\", 0.5]", "velocity = [\"t\", 0.5]", {"depends on t"});
  expect_refused("name = \"tank\"", "name = \"water\"", {"plate.toml:20: body.name", "used twice"});
  expect_refused("title =", "title", {"plate.toml:1", "not TOML"});
}

TEST(SceneFile, SetReplacesAnyKeyByNameOrNumber) {
  const SceneFile scene = read(plate, {"spacing=0.02", "body.plate.material.youngs_modulus=2e6", "load.0.force=[1, 2]", "scheme.name=paper",
                                       "body.0.velocity.1=3", "body.plate.fixed.1.directions=[\"y\"]", "limits.particles=1000"});
  EXPECT_EQ(scene.spacing, 0.02);
  EXPECT_EQ(scene.bodies[2].elastic.youngs_modulus, 2e6);
  EXPECT_EQ(scene.loads[0].force->x(), 1);
  EXPECT_EQ(scene.scheme.name, sim::Scheme::paper);
  EXPECT_EQ(scene.bodies[0].velocity.text[1], "3");
  EXPECT_EQ(scene.bodies[2].fixed[1].directions, 2);
  EXPECT_EQ(scene.limits.particles, 1000);
}

TEST(SceneFile, SetIsAsStrictAsTheFile) {
  EXPECT_NE(refusal(plate, {"body.plates.material.density=1"}).find("did you mean \"plate\"?"), std::string::npos);
  EXPECT_NE(refusal(plate, {"body.plate.material.densty=1"}).find("did you mean `density`?"), std::string::npos);
  EXPECT_NE(refusal(plate, {"spacing=-1"}).find("--set spacing=-1"), std::string::npos);
  EXPECT_NE(refusal(plate, {"spacing"}).find("KEY=VALUE"), std::string::npos);
  EXPECT_NE(refusal(plate, {"load.3.ramp=1"}).find("1 entries"), std::string::npos);
}

TEST(SceneFile, PatientStandsForBodiesAndPortsThatSetReaches) {
  const std::string text =
      "spacing = 1e-3\n[patient]\nvalve = { youngs_modulus = 2e6, thickness = 4e-4 }\nblood = { hematocrit = 40 }\nheart_rate = 60\n";
  const SceneFile scene = parse_scene_text(text, "p.toml", {"body.leaflets.material.fibre_modulus=5e5", "port.aorta.pressure=9000"});
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.bodies[0].name, "leaflets");
  EXPECT_EQ(scene.bodies[0].elastic.youngs_modulus, 2e6);
  EXPECT_EQ(scene.bodies[0].elastic.thickness, 4e-4);
  EXPECT_EQ(scene.bodies[0].elastic.fibre_modulus, 5e5);
  EXPECT_EQ(scene.bodies[0].elastic.law, sim::ElasticLaw::fibre_reinforced);
  EXPECT_EQ(std::get<sim::HerschelBulkley>(scene.bodies[1].fluid.rheology).yield_stress, app::blood_rheology(40).yield_stress);
  EXPECT_EQ(scene.bodies[2].kind, sim::Kind::wall);
  ASSERT_EQ(scene.ports.size(), 2u);
  EXPECT_FALSE(scene.ports[0].has_condition);
  EXPECT_TRUE(scene.ports[1].has_condition);
  EXPECT_EQ(scene.ports[1].port.table.at(0.3), 9000);
  EXPECT_EQ(scene.time.end, 1.0);
  EXPECT_THROW(parse_scene_text(text, "p.toml", {"body.leaflet.material.fibre_modulus=5e5"}), app::SceneError);
}

TEST(SceneFile, ReadsTablesAndSaysWhatIsWrongWithThem) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "cusp_test_tables";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "good.csv") << "# comment\ntime, factor\n0, 0\n0.5, 2\n1, 0\n";
  std::ofstream(folder / "back.csv") << "0,0\n0.5,2\n0.2,0\n";
  const sim::TimeTable table = app::read_time_table(folder / "good.csv", {});
  EXPECT_EQ(table.at(0.25), 1);
  EXPECT_EQ(table.at(1.25), 1);  // repeated
  EXPECT_THROW(app::read_time_table(folder / "back.csv", {}), app::SceneError);
  EXPECT_THROW(app::read_time_table(folder / "none.csv", {}), app::SceneError);
}

TEST(Blood, MeetsItsAnchorAndTheDigitisedViscometry) {
  const sim::HerschelBulkley at45 = app::blood_rheology(45);
  EXPECT_DOUBLE_EQ(at45.yield_stress, 0.0175);
  EXPECT_NEAR(at45.consistency, 0.0089721, 1e-12);
  EXPECT_NEAR(at45.index, 0.8601, 1e-12);
  EXPECT_EQ(app::blood_rheology(0).yield_stress, 0);
  EXPECT_EQ(app::blood_rheology(0).index, 1);
  EXPECT_NEAR(app::blood_rheology(0).consistency, 1.2e-3, 0.2e-3);  // plasma
  const auto viscosity = [](double hematocrit, double rate) {
    const sim::HerschelBulkley b = app::blood_rheology(hematocrit);
    return b.consistency * std::pow(rate, b.index - 1) + b.yield_stress / rate;
  };
  // Wells and Merrill 1962 at 120 1/s: 33 per cent 3.1 mPa s, 57 per cent 7.8, 70 per cent 9.8; donors differ by a third.
  EXPECT_NEAR(viscosity(33, 120) / 3.1e-3, 1, 0.35);
  EXPECT_NEAR(viscosity(57, 120) / 7.8e-3, 1, 0.35);
  EXPECT_NEAR(viscosity(70, 120) / 9.8e-3, 1, 0.35);
}

}  // namespace
