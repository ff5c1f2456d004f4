#include "render/egl_context.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "render/renderer.h"

namespace render {
namespace {

TEST(EglContext, opens_without_a_display_and_says_by_what) {
  const EglContext context;
  EXPECT_NE(context.description().find(", by "), std::string::npos) << context.description();
}

TEST(EglContext, surfaceless_alone_works_too) {
  const EglContext context({"surfaceless"});
  EXPECT_NE(context.description().find("surfaceless"), std::string::npos);
}

TEST(EglContext, two_live_side_by_side) {
  EglContext first;
  { EglContext second; }
  EXPECT_NO_THROW(first.make_current());
}

TEST(EglContext, where_none_works_it_says_what_was_tried) {
  try {
    const EglContext context(std::vector<std::string>{});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("tried nothing"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("libgl1-mesa-dri"), std::string::npos);
  }
  ASSERT_EQ(setenv("WAYLAND_DISPLAY", "none-such", 1), 0);
  ASSERT_EQ(setenv("EGL_PLATFORM", "wayland", 1), 0);
  try {
    const EglContext context({"default"});
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("default display"), std::string::npos);
  }
  unsetenv("EGL_PLATFORM");
  unsetenv("WAYLAND_DISPLAY");
}

}  // namespace
}  // namespace render
