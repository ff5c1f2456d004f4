// The panels without a display: Dear ImGui with no backend, a mouse made of numbers.
#include "app/view_panels.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/view_script.h"
#include "tests/app/example_run.h"

namespace app {
namespace {

class ViewPanels : public testing::Test {
 protected:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "cusp_view_panels";
  ViewPanels() : session_("/bin/false") {
    std::filesystem::create_directories(folder_);
    example::write_valve_run(folder_ / "a.h5", 9);
    ImGui::CreateContext();
    style_panels(1);
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = ImVec2(1600, 1000);
    io.DeltaTime = 1.0f / 60;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    io.Fonts->SetTexID(reinterpret_cast<ImTextureID>(1));
  }
  ~ViewPanels() override {
    ImGui::DestroyContext();
    std::filesystem::remove_all(folder_);
  }
  PanelRequests frame() {
    ImGui::NewFrame();
    const PanelRequests requests = draw_panels(session_, state_, pictures_);
    ImGui::Render();
    return requests;
  }
  // Presses and releases the left button at a place.
  PanelRequests click(float x, float y) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = ImVec2(x, y);
    frame();
    io.MouseDown[0] = true;
    frame();
    io.MouseDown[0] = false;
    return frame();
  }
  ViewSession session_;
  PanelState state_;
  std::vector<PanelTexture> pictures_;
};

TEST_F(ViewPanels, are_drawn_with_nothing_open_and_with_a_run) {
  frame();
  EXPECT_GT(ImGui::GetDrawData()->TotalVtxCount, 100);
  const int empty = ImGui::GetDrawData()->TotalVtxCount;
  session_.model.open_run(folder_ / "a.h5");
  frame(), frame();
  EXPECT_GT(ImGui::GetDrawData()->TotalVtxCount, 2 * empty);
}

// A drag in the picture turns it; with Ctrl it moves the cut; the wheel brings it nearer.
TEST_F(ViewPanels, the_mouse_turns_cuts_and_zooms_the_picture) {
  session_.model.open_run(folder_ / "a.h5");
  pictures_ = {{reinterpret_cast<ImTextureID>(2), 1000, 750, 40, 80}};
  ImGuiIO& io = ImGui::GetIO();
  frame(), frame();
  const auto camera = [&] { return session_.model.pictures()[0].panel.camera; };
  const render::Camera start = camera();
  const float x = state_.picture_x + 400, y = state_.picture_y + 300;
  io.MousePos = ImVec2(x, y);
  frame();
  io.MouseDown[0] = true;
  frame();
  io.MousePos = ImVec2(x + 80, y);
  EXPECT_TRUE(frame().moving);
  EXPECT_GT((camera().backward - start.backward).norm(), 0.1f);
  io.KeyCtrl = true;
  io.MousePos = ImVec2(x + 80, y - 60);
  frame();
  EXPECT_TRUE(session_.model.shown.cut);
  EXPECT_GT(session_.model.shown.cut_at, 1e-4);
  io.KeyCtrl = false;
  io.MouseDown[0] = false;
  frame();
  const float width = camera().width;
  io.MouseWheel = 1;
  frame();
  EXPECT_NEAR(camera().width, width / 1.15f, 1e-5f);
}

TEST_F(ViewPanels, a_file_that_is_none_is_asked_for_and_refused_in_one_line) {
  EXPECT_THROW(session_.open(folder_ / "none.h5"), SceneError);
  std::ofstream(folder_ / "text.h5") << "no run";
  EXPECT_THROW(session_.open(folder_ / "text.h5"), SceneError);
  frame();
  EXPECT_FALSE(session_.model.has_run());
}

// --- scripts ----------------------------------------------------------------------------------------------------------------------------

TEST_F(ViewPanels, a_script_drives_the_same_model) {
  ScriptRunner script(read_script("open " + (folder_ / "a.h5").string() +
                                      "\nview long_axis   # a remark\nfield displacement\ntime 0.4\nslow 20\nplay\nwait 0.5\npause\n"
                                      "screenshot picture.png\nclose\n",
                                  "steps.txt"),
                      "steps.txt");
  EXPECT_TRUE(script.go_on(session_, state_, 0).screenshot.empty());  // opened; the rest follows
  EXPECT_TRUE(script.go_on(session_, state_, 0).screenshot.empty());  // waits
  EXPECT_EQ(session_.model.shown.view, "long_axis");
  EXPECT_EQ(session_.model.shown.field, "displacement");
  EXPECT_NEAR(session_.model.time(), 0.4, 1e-12);
  EXPECT_TRUE(session_.model.playing);
  EXPECT_EQ(script.go_on(session_, state_, 0.6).screenshot, "picture.png");
  EXPECT_FALSE(session_.model.playing);
  EXPECT_TRUE(script.go_on(session_, state_, 0.7).close);
  EXPECT_TRUE(script.done());
}

TEST_F(ViewPanels, scripts_are_refused_with_their_line) {
  for (const char* text : {"play\nfly\n", "play\nview\n"}) {
    try {
      read_script(text, "steps.txt");
      ADD_FAILURE() << text;
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()).find("steps.txt:2"), std::string::npos) << error.what();
    }
  }
  session_.model.open_run(folder_ / "a.h5");
  ScriptRunner script(read_script("view nowhere", "steps.txt"), "steps.txt");
  EXPECT_THROW(script.go_on(session_, state_, 0), SceneError);
}

TEST(ViewWords, everything_that_can_be_chosen_has_words) {
  for (const char* name : {"from_aorta", "from_ventricle", "long_axis", "short_axis", "pair", "oblique", "front", "side", "top", "plane",
                           "stress", "principal_stress", "displacement", "pressure", "speed"}) {
    EXPECT_NE(words_for(name).label, name);
    EXPECT_FALSE(words_for(name).tip.empty()) << name;
  }
}

}  // namespace
}  // namespace app
