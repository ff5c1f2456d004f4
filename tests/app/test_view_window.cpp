// The whole window under a display of its own (Xvfb): what `cusp view --script` shows is looked at pixel by pixel.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "app/make_frame.h"
#include "app/picture_overlay.h"
#include "app/view_model.h"
#include "render/egl_context.h"
#include "render/image.h"
#include "tests/app/example_run.h"

namespace app {
namespace {

namespace fs = std::filesystem;

class ViewWindow : public testing::Test {
 protected:
  fs::path folder_ = fs::path(testing::TempDir()) / "cusp_view_window", program_ = fs::path(CUSP_BINARY_DIR) / "cusp";
  void SetUp() override {
    fs::create_directories(folder_);
    example::write_valve_run(folder_ / "run.h5", 9);
    if (std::system("command -v xvfb-run > /dev/null 2>&1") != 0) GTEST_SKIP() << "xvfb-run is not installed";
    if (!fs::exists(program_)) GTEST_SKIP() << "the program is not built: " << program_;
  }
  void TearDown() override { fs::remove_all(folder_); }
  int run(const std::string& script, const std::string& display = "timeout 300 xvfb-run -a -s '-screen 0 1700x1100x24' ") {
    std::ofstream(folder_ / "steps.txt") << script;
    const std::string command = "cd " + folder_.string() + " && LIBGL_ALWAYS_SOFTWARE=1 " + display + program_.string() +
                                " view run.h5 --size 1600x1000 --script steps.txt > out.txt 2> err.txt";
    return std::system(command.c_str());
  }
  std::string text(const char* name) const {
    std::ifstream file(folder_ / name);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
};

// Pixels of the middle (where the pictures are) that are no grey: the valve, the aorta, the colour bar.
long colored(const render::Image& image, int left, int right) {
  long count = 0;
  for (int y = 40; y < 740; ++y)
    for (int x = left; x < right; ++x) {
      const std::uint8_t* p = image.at(x, y);
      count += std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 40;
    }
  return count;
}

TEST_F(ViewWindow, opens_plays_turns_and_closes) {
  ASSERT_EQ(
      run("time 0\nwait 1.5\nscreenshot closed.png\ntime 0.4\nwait 1.5\nscreenshot open.png\norbit 60 20\nwait 1.5\nscreenshot turned.png\n"
          "view pair\nwait 1.5\nscreenshot pair.png\nplay\nwait 1\npause\nprint\nclose\n"),
      0)
      << text("err.txt");
  const render::Image closed = render::read_png((folder_ / "closed.png").string()),
                      open = render::read_png((folder_ / "open.png").string());
  const render::Image turned = render::read_png((folder_ / "turned.png").string()),
                      pair = render::read_png((folder_ / "pair.png").string());
  EXPECT_EQ(closed.width, 1600);
  EXPECT_GT(colored(closed, 300, 1200), 20000);  // the valve is where it should be ...
  EXPECT_NE(closed.rgba, open.rgba);
  EXPECT_NE(open.rgba, turned.rgba);
  EXPECT_GT(colored(pair, 300, 750), 10000);  // ... and in both pictures of the pair
  EXPECT_GT(colored(pair, 750, 1200), 5000);
  EXPECT_NE(text("out.txt").find("frame "), std::string::npos);
}

// The picture in the window and the one drawn without a display are the same code: they agree but for the driver's rounding.
TEST_F(ViewWindow, shows_what_is_drawn_without_a_display) {
  ASSERT_EQ(run("time 0.4\nwait 4\nscreenshot window.png\nclose\n"), 0) << text("err.txt");
  const render::Image window = render::read_png((folder_ / "window.png").string());
  const int left = 300, width = 1000, height = 750;  // as draw_panels lays them out
  ViewModel model;
  model.open_run(folder_ / "run.h5");
  model.go_to(0.4);
  const render::EglContext context;
  render::PanelPainter painter;
  render::Lettering lettering;
  const WindowPicture alone = draw_window_picture(painter, lettering, model.pictures().front(), {}, width, height, false);
  long differing = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 3; ++k) differing += std::abs(window.at(left + x, y)[k] - alone.image.at(x, y)[k]) > 12;
  EXPECT_LT(differing, width * height * 3 / 100);
}

TEST_F(ViewWindow, says_what_to_do_where_there_is_no_display) {
  EXPECT_NE(run("close\n", "env -u DISPLAY -u WAYLAND_DISPLAY "), 0);
  EXPECT_NE(text("err.txt").find("cusp render"), std::string::npos) << text("err.txt");
}

}  // namespace
}  // namespace app
