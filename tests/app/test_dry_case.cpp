#include "app/dry_case.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "app/run_case.h"
#include "sim/run_file.h"

namespace app {
namespace {

SceneFile valve(const std::vector<std::string>& settings = {}) {
  return parse_scene_text("title = \"a valve\"\nspacing = 2e-3\n[patient]\nvalve = { youngs_modulus = 1e6 }\n", "valve.toml", settings);
}

// One placement serves all: it is the dear part, and the dry scenes below do not change it.
std::shared_ptr<const CaseParticles> placed() {
  static const std::shared_ptr<const CaseParticles> once = place_case(valve());
  return once;
}

TEST(DryCase, holds_leaflets_and_the_wall_beside_them_and_nothing_else) {
  const BuiltCase<3> wet = build_case<3>(valve(), *placed());
  const BuiltCase<3> dry = dry_case(valve(), wet, {});
  const auto& d = dry.description;
  EXPECT_TRUE(d.ports.empty());
  EXPECT_EQ(d.loads.size(), 3u);
  std::int64_t shells = 0, wet_shells = 0;
  for (const sim::Kind kind : d.particles.kind) {
    EXPECT_TRUE(kind == sim::Kind::shell || kind == sim::Kind::wall);
    shells += kind == sim::Kind::shell;
  }
  for (const sim::Kind kind : wet.description.particles.kind) wet_shells += kind == sim::Kind::shell;
  EXPECT_EQ(shells, wet_shells);
  EXPECT_LT(d.particles.size(), wet.description.particles.size() / 2);
  for (const sim::Body& body : d.bodies)
    for (std::int64_t row = body.first; row < body.first + body.count; ++row) EXPECT_EQ(d.particles.kind[row], body.kind);
  EXPECT_NE(d.title.find("without blood"), std::string::npos);
  EXPECT_NE(dry.warnings.front().find("13 to 28 %"), std::string::npos);
}

// A pressure that closes: the orifice ends smaller and the stress has the size that equilibrium asks for. The resultant of the pressure on
// the closed valve is p A; the tissue carries it to its attachment, so the stress is of the order p R / (2 h) (Laplace): here 12 kPa x
// 11.7 mm / (2 x 0.5 mm) = 140 kPa. A softer valve yields more.
TEST(DryCase, closes_under_pressure_and_bears_it) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / ("cusp_dry_" + std::to_string(::getpid()) + ".h5");
  double moved[2] = {0, 0};
  for (const int stiff : {0, 1}) {
    RunCaseOptions options;
    options.quiet = true, options.output = file, options.placed = placed(), options.dry = DrySettings{};
    const sim::RunResult result =
        run_case(valve({std::string("body.leaflets.material.youngs_modulus=") + (stiff ? "4e6" : "1e6")}), options);
    ASSERT_EQ(result.ending, sim::RunEnding::finished) << result.message;
    const sim::RunReader run(file);
    const std::vector<double> stress = run.column("leaflet_stress_p99"), area = run.column("orifice_area");
    EXPECT_GT(stress.back(), 0.5 * 140e3);
    EXPECT_LT(stress.back(), 10 * 140e3);
    EXPECT_LE(area.back(), area.front());
    const sim::RunFrame first = run.frame(0), last = run.frame(run.frame_count() - 1), before = run.frame(run.frame_count() - 2);
    double step = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      double way = 0, late = 0;
      for (int k = 0; k < 3; ++k) {
        way += std::pow(last.position[i][k] - first.position[i][k], 2);
        late += std::pow(last.position[i][k] - before.position[i][k], 2);
      }
      moved[stiff] += way;
      step = std::max(step, std::sqrt(late));
    }
    EXPECT_LT(step, 0.5e-3);  // at rest: the last 2.5 ms move nothing by half a millimetre
  }
  EXPECT_LT(moved[1], moved[0]);
  for (const char* ending : {".h5", ".xmf", ".csv"}) std::filesystem::remove(std::filesystem::path(file).replace_extension(ending));
}

TEST(DryCase, is_refused_without_a_valve) {
  const SceneFile scene = parse_scene_text(
      "title = \"drop\"\ndimension = 3\nspacing = 0.1\n[time]\nend = 0.1\n[[body]]\nname = \"water\"\nkind = \"fluid\"\nshape = { type = "
      "\"box\", min = "
      "[0, 0, "
      "0], max = [0.3, 0.3, 0.3] }\nmaterial = { density = 1000, viscosity = 1e-3 }\n",
      "drop.toml");
  EXPECT_THROW(dry_case(scene, build_case<3>(scene), {}), SceneError);
}

}  // namespace
}  // namespace app
