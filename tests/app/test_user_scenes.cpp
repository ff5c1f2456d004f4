// Scenes as users write them, from the file's text to the probes' values, against exact answers.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "app/run_case.h"
#include "sim/run_file.h"

namespace {

namespace fs = std::filesystem;

// The run of a scene's text, removed with it.
struct SceneRun {
  fs::path file = fs::temp_directory_path() / ("cusp_user_scene_" + std::to_string(getpid()) + ".h5");
  explicit SceneRun(const std::string& text) {
    app::RunCaseOptions options;
    options.output = file;
    options.quiet = true;
    const sim::RunResult result = app::run_case(app::parse_scene_text(text, "scene.toml"), options);
    EXPECT_EQ(result.ending, sim::RunEnding::finished) << result.message;
  }
  ~SceneRun() {
    std::error_code ignored;
    for (const char* ending : {".h5", ".csv", ".xmf", ".u.csv"}) fs::remove(fs::path(file).replace_extension(ending), ignored);
  }
  std::vector<double> column(const std::string& name) const { return sim::RunReader(file).column(name); }
  double last(const std::string& name) const { return column(name).back(); }
};

TEST(UserScene, BarOnRollersPulledByAForceOnItsEndFaceStretchesEvenly) {
  const SceneRun run(R"(dimension = 3
spacing = 0.1
[time]
mode = "static"
[[body]]
name = "bar"
kind = "elastic"
shape = { type = "box", min = [0, 0, 0], max = [1, 0.4, 0.4] }
material = { density = 7800, law = "linear", youngs_modulus = 2.1e11, poisson_ratio = 0.3 }
fixed = [ { type = "box", min = [-0.1, -0.1, -0.1], max = [0, 0.5, 0.5], directions = ["x"] },
          { type = "box", min = [-0.1, -0.1, -0.1], max = [1.1, 0, 0.5], directions = ["y"] },
          { type = "box", min = [-0.1, -0.1, -0.1], max = [1.1, 0.5, 0], directions = ["z"] } ]
[[load]]
body = "bar"
region = { type = "box", min = [1, -0.1, -0.1], max = [1.1, 0.5, 0.5] }
force = [1e6, 0, 0]
[[probe]]
name = "end"
quantity = "displacement"
body = "bar"
at = [1, 0.4, 0.2]
[[probe]]
name = "s"
quantity = "stress"
body = "bar"
at = [0.5, 0.2, 0.2]
)");
  const double stress = 1e6 / 0.16;  // F / A; u = F L / (E A), nu times that across
  EXPECT_NEAR(run.last("s.xx"), stress, 1e-6 * stress);
  EXPECT_NEAR(run.last("s.von_mises"), stress, 1e-6 * stress);
  EXPECT_NEAR(run.last("end.x"), stress / 2.1e11, 1e-6 * stress / 2.1e11);
  EXPECT_NEAR(run.last("end.y"), -0.3 * 0.4 * stress / 2.1e11, 1e-6 * stress / 2.1e11);
}

TEST(UserScene, OilBetweenATurningShaftAndItsHousing) {
  const SceneRun run(R"(dimension = 2
spacing = 0.001
[time]
end = 0.6
output = 0.6
[[body]]
name = "oil"
kind = "fluid"
shape = { type = "sphere", center = [0, 0], radius = 0.02, subtract = [ { type = "sphere", center = [0, 0], radius = 0.01 } ] }
material = { density = 900, viscosity = 0.5 }
[[body]]
name = "shaft"
kind = "wall"
shape = { type = "sphere", center = [0, 0], radius = 0.01 }
motion = { angular_velocity = 5, center = [0, 0] }
[[body]]
name = "housing"
kind = "wall"
shape = { type = "sphere", center = [0, 0], radius = 0.024, subtract = [ { type = "sphere", center = [0, 0], radius = 0.02 } ] }
[[probe]]
name = "quarter"
quantity = "velocity"
at = [0.0125, 0]
[[probe]]
name = "half"
quantity = "velocity"
at = [0, 0.015]
)");
  // Circular Couette flow: u = A r + B / r with u = omega a at the shaft (a) and 0 at the housing (b).
  const double a = 0.01, b = 0.02, omega = 5, factor = omega * a * a / (b * b - a * a);
  const auto speed = [&](double r) { return factor * (b * b / r - r); };
  EXPECT_NEAR(run.last("quarter.y"), speed(0.0125), 0.01 * omega * a);
  EXPECT_NEAR(run.last("half.x"), -speed(0.015), 0.01 * omega * a);
}

TEST(UserScene, BlockOfHalfTheDensityFloatsHalfUnderWater) {
  const SceneRun run(R"(dimension = 2
spacing = 0.02
[time]
end = 1
output = 0.02
[gravity]
acceleration = [0, -9.81]
[[body]]
name = "water"
kind = "fluid"
shape = { type = "box", min = [0, 0], max = [0.6, 0.3], subtract = [ { type = "box", min = [0.2, 0.2], max = [0.4, 0.4] } ] }
material = { density = 1000, viscosity = 1e-3 }
[[body]]
name = "block"
kind = "elastic"
shape = { type = "box", min = [0.2, 0.2], max = [0.4, 0.4] }
material = { density = 500, youngs_modulus = 1e6, poisson_ratio = 0.3 }
[[body]]
name = "tank"
kind = "wall"
shape = { type = "box", min = [-0.08, -0.08], max = [0.68, 0.6], subtract = [ { type = "box", min = [0, 0], max = [0.6, 0.6] } ] }
[[probe]]
name = "middle"
quantity = "displacement"
body = "block"
at = [0.3, 0.3]
)");
  for (const double y : run.column("middle.y")) EXPECT_LT(std::abs(y), 0.2 * 0.02);  // Archimedes: it starts in equilibrium
}

TEST(UserScene, CavityOfDenseViscousFluidStarts) {
  const SceneRun run(R"(dimension = 2
spacing = 0.04
[time]
end = 0.2
[[body]]
name = "fluid"
kind = "fluid"
shape = { type = "box", min = [0, 0], max = [1, 1] }
material = { density = 1000, viscosity = 10 }
[[body]]
name = "box"
kind = "wall"
shape = { type = "box", min = [-0.2, -0.2], max = [1.2, 1], subtract = [ { type = "box", min = [0, 0], max = [1, 1] } ] }
[[body]]
name = "lid"
kind = "wall"
shape = { type = "box", min = [-0.2, 1], max = [1.2, 1.2] }
motion = { surface_velocity = [1, 0] }
)");
  EXPECT_EQ(run.last("refused_steps"), 0);
}

// A sheet swinging to and fro between two closed chambers of water (its second bending mode: no volume is displaced). Nothing drives it, so
// it must never hold more energy than it was given, whatever its stiffness; and it swings as a clamped strip that carries the water beside
// it, 2 rho / k: omega = (7.853 / L)^2 sqrt(D / (rho_s h + 2 rho / k)), k = 2 pi / L.
TEST(UserScene, AFreeSheetInWaterSwingsWithoutGainingEnergy) {
  const std::string before = R"scene(dimension = 2
spacing = 0.001
[time]
end = 0.05
output = 0.0005
step = 1e-4
[scheme]
subparticle_dissipation = 0
[[body]]
name = "water"
kind = "fluid"
shape = { type = "box", min = [-0.01, -0.01], max = [0.01, 0.01], subtract = [ { type = "box", min = [-0.00025, -0.01], max = [0.00025, 0.01] } ] }
material = { density = 1000 }
[[body]]
name = "wall"
kind = "wall"
shape = { type = "box", min = [-0.014, -0.014], max = [0.014, 0.014], subtract = [ { type = "box", min = [-0.01, -0.01], max = [0.01, 0.01] } ] }
[[body]]
name = "sheet"
kind = "elastic"
shape = { type = "box", min = [-0.00025, -0.01], max = [0.00025, 0.01] }
velocity = ["0.05*sin(2*pi*y/0.02)", "0"]
fixed = [ { type = "box", min = [-0.001, 0.0085], max = [0.001, 0.011] }, { type = "box", min = [-0.001, -0.011], max = [0.001, -0.0085] } ]
material = { density = 1000, law = "neo-hookean", poisson_ratio = 0.3, youngs_modulus = )scene";
  const std::string after = R"( }
[[probe]]
name = "quarter"
quantity = "displacement"
body = "sheet"
at = [0, 0.005]
)";
  for (const double modulus : {1e6, 1e7}) {
    const SceneRun run(before + std::to_string(modulus) + after);
    const std::vector<double> kinetic = run.column("kinetic_energy"), elastic = run.column("elastic_energy"), time = run.column("time");
    for (std::size_t i = 1; i < kinetic.size(); ++i)
      EXPECT_LT(kinetic[i] + elastic[i], kinetic[0] + elastic[0]) << "at " << time[i] << " s";
    const std::vector<double> x = run.column("quarter.x");
    std::vector<double> zeros;
    for (std::size_t i = 1; i + 1 < x.size(); ++i)
      if (x[i] * x[i + 1] < 0) zeros.push_back(time[i] - x[i] * (time[i + 1] - time[i]) / (x[i + 1] - x[i]));
    ASSERT_GE(zeros.size(), 3u);
    const double frequency = 0.5 * static_cast<double>(zeros.size() - 1) / (zeros.back() - zeros.front());
    const double length = 0.017, thickness = 0.5e-3, rigidity = modulus * std::pow(thickness, 3) / (12 * (1 - 0.09));
    const double carried = 1000 * thickness + 2 * 1000 / (2 * M_PI / length);
    const double expected = std::pow(7.853 / length, 2) * std::sqrt(rigidity / carried) / (2 * M_PI);
    EXPECT_NEAR(frequency, expected, 0.15 * expected);  // 17 particles a wave, and the layer's mass counts twice
  }
}

// Lame's thick ring. At six layers through the wall; what follows the ring's curves must not bend it into an oval, its softest mode.
TEST(UserScene, QuarterOfAPressurisedRingStaysRound) {
  const SceneRun run(R"(dimension = 2
spacing = 5e-4
[time]
mode = "static"
[[body]]
name = "ring"
kind = "elastic"
shape = { type = "sphere", center = [0, 0], radius = 13e-3, subtract = [ { type = "sphere", center = [0, 0], radius = 10e-3 } ], intersect = [ { type = "box", min = [0, 0], max = [14e-3, 14e-3] } ] }
material = { law = "linear", youngs_modulus = 1e6, poisson_ratio = 0.3 }
fixed = [ { type = "box", min = [-5e-4, 0], max = [0, 14e-3], directions = ["x"] }, { type = "box", min = [0, -5e-4], max = [14e-3, 0], directions = ["y"] } ]
[[load]]
body = "ring"
region = { type = "sphere", center = [0, 0], radius = 10.3e-3 }
pressure = 16
[[probe]]
name = "right"
quantity = "displacement"
body = "ring"
at = [0.01, 0]
[[probe]]
name = "top"
quantity = "displacement"
body = "ring"
at = [0, 0.01]
[[probe]]
name = "inner"
quantity = "stress"
body = "ring"
at = [0.00707106781, 0.00707106781]
)");
  const double radial = 1.41421356 * 4.454978e-07;  // plane strain
  EXPECT_NEAR(run.last("right.x"), radial, 0.01 * radial);
  EXPECT_NEAR(run.last("top.y"), radial, 0.01 * radial);
  EXPECT_NEAR(run.last("inner.principal1"), 62.3768, 0.05 * 62.3768);
  EXPECT_NEAR(run.last("inner.von_mises"), 68.5071, 0.05 * 68.5071);
}

}  // namespace
