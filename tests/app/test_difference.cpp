#include "app/difference.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "tests/app/example_run.h"

namespace app {
namespace {

class Difference : public testing::Test {
 protected:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "cusp_difference";
  Difference() {
    std::filesystem::create_directories(folder_);
    example::write_valve_run(folder_ / "a.h5", 3, 3e5);
    example::write_valve_run(folder_ / "b.h5", 3, 5e5, "Stiffer");
  }
  ~Difference() override { std::filesystem::remove_all(folder_); }
  render::Frame frame(const char* name, const PictureChoice& choice = {}) const {
    const sim::RunReader run(folder_ / name);
    return FrameMaker(run, choice, field_ranges({&run})).make(1);
  }
};

// The stress of the made-up leaflets is proportional to the number given: 5e5 - 3e5, from the attachment's full value to 0.3 of it in
// eight rows. The first row is held and shows the second's.
TEST_F(Difference, is_second_minus_first_at_each_particle) {
  const render::Frame a = frame("a.h5"), b = frame("b.h5");
  const std::vector<double> extent = difference_extent(a, b);
  EXPECT_NEAR(extent[0], 2e5 * (1 - 0.7 / 8), 1);
  const render::Frame both = difference_frame(a, b, extent);
  EXPECT_NO_THROW(render::check_frame(both));
  const std::vector<float>& values = both.surfaces[first_leaflet].fields[0];
  EXPECT_NEAR(values.front(), 2e5 * (1 - 0.7 / 8), 1);
  EXPECT_NEAR(values[2 * 13 + 6], 2e5 * (1 - 0.7 / 4), 1);
  EXPECT_NEAR(values.back(), 0.3 * 2e5, 1);
  const render::ColorScale& scale = both.scales[scale_slot("stress")];
  EXPECT_EQ(scale.minimum, -scale.maximum);
  EXPECT_EQ(scale.map, render::Colormap::diverging);
  EXPECT_EQ(both.panels.size(), 2u);  // the view of the blood is left out
  EXPECT_EQ(both.panels[0].note, "Stiffer minus Example valve");
}

TEST_F(Difference, is_refused_between_different_leaflets_and_for_blood) {
  render::Frame a = frame("a.h5");
  render::Frame other = frame("b.h5");
  other.surfaces[first_leaflet].vertices.pop_back();
  EXPECT_THROW(difference_extent(a, other), std::invalid_argument);
  PictureChoice blood;
  blood.views = {"long_axis"};
  blood.fields = {"pressure"};
  EXPECT_THROW(difference_frame(frame("a.h5", blood), frame("b.h5", blood), {1, 1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace app
