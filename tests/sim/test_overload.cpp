// Leaflets beyond their law, against stretches given by hand.
#include "sim/overload.h"

#include <gtest/gtest.h>

#include "sim/shell_scenes.h"
#include "sim/step.h"

namespace {

// A strip of 20 x 10 mm, 0.5 mm thick, of E = 1 MPa, pulled along x to (1 + strain) times its length.
std::optional<sim::Overload> pulled(double strain, std::string* message = nullptr) {
  const auto description = shell_scenes::strip(0.02, 0.01, 1e-3, 2, shell_scenes::tissue());
  const auto scene = sim::make_scene(description);
  auto state = sim::initial_state(scene);
  for (auto& x : state.position) x[0] *= 1 + strain;
  const auto found = sim::overload(scene, state);
  if (found && message) *message = sim::overload_message(scene, *found);
  return found;
}

TEST(Overload, IsSilentWithinWhatTissueBears) {
  EXPECT_FALSE(pulled(0).has_value());
  EXPECT_FALSE(pulled(0.7).has_value());
}

TEST(Overload, NamesTheStrainAndTheLoadThatTheLawBears) {
  std::string message;
  const auto found = pulled(0.9, &message);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->strain, 0.9, 1e-9);
  EXPECT_NE(message.find("overloaded: 'strip' is stretched by 90 %"), std::string::npos) << message;
  // G h / R with G = E / (2 (1 + nu)) and R of a half sphere of the strip's area, its clamped rows included: 22 x 10 mm.
  const double limit = 1e6 / (2 * 1.49) * 0.5e-3 / std::sqrt(0.022 * 0.01 / (2 * M_PI));
  char bears[60];
  std::snprintf(bears, sizeof bears, "at most G h / R = %.3g kPa", 1e-3 * limit);
  EXPECT_NE(message.find(bears), std::string::npos) << message << " " << bears;
}

}  // namespace
