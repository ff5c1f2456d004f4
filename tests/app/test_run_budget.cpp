#include "app/run_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/accuracy_plan.h"

namespace {

using app::AccuracyPoint;
using app::AccuracyStudy;

AccuracyStudy hand_made() {
  AccuracyStudy study;
  study.scene = "law.toml", study.against = "[reference]", study.end = 2;
  study.quantities = {"tip.y"}, study.noise = {0.0}, study.uncertainty = {0.0};
  for (double h : {0.04, 0.02, 0.01}) {
    AccuracyPoint p;
    p.curve = "spacing", p.spacing = h, p.wall = {1e-6 / (h * h * h)}, p.error = {5 * h};  // 1/64, 1/8, 1 s; 20, 10, 5 %
    study.points.push_back(p);
  }
  return study;
}
const app::FitSpacing as_wanted = [](double spacing, bool) { return spacing; };

TEST(RunBudget, ChoosesTheFinestSpacingThatFitsTheTime) {
  const auto choice = app::choose_for_time(hand_made(), 0.5, 1, 2, as_wanted);
  EXPECT_NEAR(choice.spacing, std::cbrt(1e-6 / 0.5), 1e-9);  // cost = 1e-6 / h^3
  EXPECT_NEAR(choice.expected_seconds, 0.5, 1e-6);
  EXPECT_NEAR(choice.expected_error, 5 * choice.spacing, 1e-9);
  // Half the machine's speed, or twice the simulated time, is half the budget.
  EXPECT_NEAR(app::choose_for_time(hand_made(), 0.5, 2, 2, as_wanted).spacing, std::cbrt(1e-6 / 0.25), 1e-9);
  EXPECT_NEAR(app::choose_for_time(hand_made(), 0.5, 1, 4, as_wanted).spacing, std::cbrt(1e-6 / 0.25), 1e-9);
  // No farther beyond the finest run than the law is trusted.
  EXPECT_NEAR(app::choose_for_time(hand_made(), 1e6, 1, 2, as_wanted).spacing, 0.007, 1e-12);
  EXPECT_THROW(app::choose_for_time(hand_made(), 1e-3, 1, 2, as_wanted), app::SceneError);
}

TEST(RunBudget, ChoosesTheCoarsestSpacingThatReachesTheError) {
  const auto choice = app::choose_for_error(hand_made(), 0.07, 1, 2, as_wanted);
  EXPECT_NEAR(choice.spacing, 0.014, 1e-9);
  EXPECT_NEAR(choice.expected_seconds, 1e-6 / std::pow(0.014, 3), 1e-6);
  EXPECT_NEAR(app::choose_for_error(hand_made(), 0.5, 1, 2, as_wanted).spacing, 0.04, 1e-9);
  EXPECT_THROW(app::choose_for_error(hand_made(), 0.01, 1, 2, as_wanted), app::SceneError);
}

TEST(RunBudget, PromisesNoMoreThanTheWorseOfTwoNeighbours) {
  AccuracyStudy study = hand_made();
  study.points[1].error = {0.02};  // by luck better than the finer run's 5 %
  const auto choice = app::choose_for_error(study, 0.06, 1, 2, as_wanted);
  EXPECT_GE(choice.expected_error, 0.05 - 1e-9);
}

TEST(RunBudget, TakesFreeKnobsAlong) {
  AccuracyStudy study = hand_made();
  AccuracyPoint knob = study.points[1];
  knob.curve = "scheme.cfl", knob.value = "0.4", knob.settings = {"spacing=0.02", "scheme.cfl=0.4"}, knob.wall = {0.0625},
  knob.change = {0.001};
  study.points[1].steps = 200, knob.steps = 100;
  study.points.push_back(knob);
  const auto choice = app::choose_for_time(study, 0.5, 1, 2, as_wanted);
  EXPECT_NEAR(choice.spacing, 0.01, 1e-6);  // half the cost: the finest run fits
  ASSERT_EQ(choice.settings.size(), 2u);
  EXPECT_EQ(choice.settings[1], "scheme.cfl=0.4");
}

TEST(RunBudget, ReadsTimesAndShares) {
  EXPECT_DOUBLE_EQ(app::read_duration("--time-budget", "10min"), 600);
  EXPECT_DOUBLE_EQ(app::read_duration("--time-budget", "1.5h"), 5400);
  EXPECT_THROW(app::read_duration("--time-budget", "soon"), app::SceneError);
  EXPECT_DOUBLE_EQ(app::read_share("--error-target", "5%"), 0.05);
  EXPECT_DOUBLE_EQ(app::read_share("--error-target", "0.02"), 0.02);
  EXPECT_THROW(app::read_share("--error-target", "5"), app::SceneError);
}

const std::string plate =
    "title = \"t\"\ndimension = 2\nspacing = 0.0125\n[time]\nend = 1\n"
    "[[body]]\nname = \"plate\"\nkind = \"elastic\"\nshape = { type = \"box\", min = [0, 0], max = [1, 0.05] }\n"
    "material = { density = 1000, youngs_modulus = 1e5, poisson_ratio = 0.3 }\n";

TEST(RunBudget, SignatureTellsThePhysicsAndNotTheNumerics) {
  const auto of = [](const std::string& text, const std::vector<std::string>& settings = {}) {
    return app::scene_signature(app::parse_scene_text(text, "a.toml", settings));
  };
  EXPECT_EQ(of(plate), of("# a comment\n" + plate, {"spacing=0.01", "time.end=3", "scheme.cfl=0.1"}));
  EXPECT_NE(of(plate), of(plate, {"body.plate.material.youngs_modulus=2e5"}));
}

TEST(RunBudget, SpacingsFitTheThinnestBody) {
  const app::SceneFile scene = app::parse_scene_text(plate, "a.toml");
  EXPECT_NEAR(app::fitting_spacing(scene, 0.018), 0.05 / 3, 1e-12);
  EXPECT_NEAR(app::fitting_spacing(scene, 0.018, true), 0.05 / 2, 1e-12);
  EXPECT_NEAR(app::fitting_spacing(scene, 0.0125), 0.0125, 1e-12);
}

}  // namespace
