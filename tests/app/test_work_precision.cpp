#include "app/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "app/accuracy.h"
#include "app/work_precision_picture.h"

namespace {

using app::AccuracyPoint;
using app::AccuracyStudy;

AccuracyPoint point(const std::string& curve, double spacing, double seconds, double error) {
  AccuracyPoint p;
  p.curve = curve, p.spacing = spacing, p.wall = {seconds}, p.processor = {seconds}, p.error = {error}, p.steps = 10,
  p.pressure_products = 100;
  return p;
}

// Costs grow as h^-3, errors fall as h^2: cost at an error e is c (e/e0)^-1.5.
AccuracyStudy power_law_study() {
  AccuracyStudy study;
  study.title = "power law", study.scene = "law.toml", study.against = "[reference]", study.end = 1;
  study.quantities = {"tip.y"}, study.sources = {"made up"}, study.uncertainty = {0.001}, study.noise = {0.002};
  for (double h : {0.04, 0.02, 0.01}) study.points.push_back(point("spacing", h, 1e-6 / (h * h * h), 50 * h * h));
  study.points[2].scene_itself = true;
  return study;
}

TEST(WorkPrecision, FindsTheOrderOfAPowerLawAndNoneWhereErrorsDoNotFall) {
  const auto order = app::observed_order({0.04, 0.02, 0.01}, {0.08, 0.02, 0.005});
  ASSERT_TRUE(order);
  EXPECT_NEAR(order->exponent, 2, 1e-12);
  EXPECT_NEAR(order->scatter, 0, 1e-12);
  EXPECT_NEAR(app::observed_order({0.01, 0.04, 0.02}, {0.005, 0.08, 0.02})->exponent, 2, 1e-12);  // in any order
  EXPECT_FALSE(app::observed_order({0.04, 0.02, 0.01}, {0.08, 0.02, 0.03}));
  EXPECT_FALSE(app::observed_order({0.04}, {0.08}));
  // A factor of 2 up and down about a first-order line shows as scatter, ln 2 times sqrt(2)/3 or so, not as a perfect fit.
  EXPECT_GT(app::observed_order({0.04, 0.02, 0.01}, {0.4, 0.1, 0.095})->scatter, 0.2);
}

TEST(WorkPrecision, FrontKeepsWhatNothingBeats) {
  //                                 a   b    c    d    e    f
  const std::vector<double> cost{1, 2, 2, 4, 8, 3}, error{0.5, 0.2, 0.3, 0.25, 0.1, std::nan("")};
  EXPECT_EQ(app::pareto_front(cost, error), (std::vector<std::size_t>{0, 1, 4}));
}

TEST(WorkPrecision, CostOfAnErrorIsInterpolatedInTheLogarithms) {
  const std::vector<double> cost{1, 8, 64}, error{0.08, 0.02, 0.005};
  EXPECT_NEAR(*app::cost_to_reach(cost, error, 0.04), std::pow(8, 0.5), 1e-12);
  EXPECT_NEAR(*app::cost_to_reach(cost, error, 0.01), 8 * std::pow(8, 0.5), 1e-12);
  EXPECT_DOUBLE_EQ(*app::cost_to_reach(cost, error, 0.5), 1);
  EXPECT_FALSE(app::cost_to_reach(cost, error, 0.004));
}

TEST(WorkPrecision, TellsHowFarTheDefaultsLieFromTheFront) {
  AccuracyStudy study = power_law_study();
  EXPECT_NEAR(*app::default_over_front(study, 0), 1, 1e-12);
  study.points.push_back(point("scheme.cfl", 0.01, 0.25, 0.004));  // four times cheaper than the default (1 s), and better
  EXPECT_GT(*app::default_over_front(study, 0), 4);
  study.noise = {0.0005};  // the default's error is 0.005: 0.004 is better by more than two starts differ
  EXPECT_GT(*app::default_over_front_beyond_noise(study, 0), 4);
  study.noise = {0.002};
  EXPECT_EQ(*app::default_over_front_beyond_noise(study, 0), 1);
  EXPECT_GT(*app::default_over_front(study, 0), 4);
  study.points.back().curve = "seed";  // a lucky start is no choice
  EXPECT_NEAR(*app::default_over_front(study, 0), 1, 1e-12);
}

TEST(WorkPrecision, AKnobIsFreeOnlyIfTheAnswerStays) {
  AccuracyStudy study = power_law_study();
  AccuracyPoint loose = point("scheme.pressure_tolerance", 0.02, 0.08, 0.021);
  loose.value = "1e-3", loose.settings = {"spacing=0.02", "scheme.pressure_tolerance=1e-3"}, loose.change = {0.0015};
  study.points.push_back(loose);
  EXPECT_TRUE(app::free_knobs(study).empty());  // as much work: its lower time is the clock's
  study.points.back().pressure_products = 60;
  ASSERT_EQ(app::free_knobs(study).size(), 1u);
  EXPECT_EQ(app::free_knobs(study)[0].settings, (std::vector<std::string>{"scheme.pressure_tolerance=1e-3"}));
  EXPECT_NEAR(app::free_knobs(study)[0].cost_factor, 0.08 / 0.125, 1e-12);
  study.points.back().change = {0.003};  // more than a tenth of the 2 % at this spacing, and than the noise
  EXPECT_TRUE(app::free_knobs(study).empty());
  study.points.back().change = {0.001}, study.points.back().curve = "scheme.kernel_radius";  // changes what is solved, not how well
  EXPECT_TRUE(app::free_knobs(study).empty());
}

TEST(WorkPrecision, AStudySurvivesItsFile) {
  const AccuracyStudy study = power_law_study();
  const AccuracyStudy again = app::study_from_json(nlohmann::json::parse(app::study_json(study).dump()));
  ASSERT_EQ(again.points.size(), 3u);
  EXPECT_EQ(app::study_json(again), app::study_json(study));
  EXPECT_NEAR(app::study_json(study)["findings"]["tip.y"]["order"]["exponent"].get<double>(), 2, 1e-9);
  EXPECT_EQ(app::study_json(study)["findings"]["tip.y"]["cost_to_reach"][0]["error"], 0.05);
  EXPECT_THROW(app::study_from_json(nlohmann::json::array()), std::runtime_error);
  EXPECT_THROW(app::study_from_json(nlohmann::json{{"title", "x"}}), std::runtime_error);
}

TEST(WorkPrecision, SaysItInPlainWords) {
  const std::string text = app::study_text(power_law_study(), "");
  EXPECT_NE(text.find("**Halving the spacing costs 8×**"), std::string::npos) << text;
  EXPECT_NE(text.find("From 40 mm to 10 mm (64× the cost) tip.y goes from 8 % to 0.5 % off."), std::string::npos) << text;
}

// Dots of the ladder where cost and error put them, the band beneath the reference's uncertainty: the picture is drawn, not merely written.
TEST(WorkPrecision, DrawsLadderAndBand) {
  AccuracyStudy study = power_law_study();
  study.uncertainty = {0.01};
  const render::Image image = app::work_precision_picture(study);
  int blue = 0, sand = 0, dark = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      blue += p[0] < 10 && p[1] > 105 && p[1] < 125 && p[2] > 170 && p[2] < 190;
      sand += p[0] == 230 && p[1] == 230 && p[2] == 204;
      dark += p[0] < 60 && p[1] < 60 && p[2] < 60;
    }
  EXPECT_GT(blue, 500);   // line and dots of the ladder
  EXPECT_GT(sand, 5000);  // band
  EXPECT_GT(dark, 2000);  // axes and words
}

}  // namespace
