#include "app/view_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "render/panel_painter.h"
#include "tests/app/example_run.h"

namespace app {
namespace {

class ViewModelTest : public testing::Test {
 protected:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "cusp_view_model";
  ViewModelTest() {
    std::filesystem::create_directories(folder_);
    example::write_valve_run(folder_ / "a.h5", 9);
    example::write_flat_run(folder_ / "flat.h5");
    model_.open_run(folder_ / "a.h5");
  }
  ~ViewModelTest() override { std::filesystem::remove_all(folder_); }
  ViewModel model_;
};

TEST_F(ViewModelTest, plays_at_its_speed_and_loops) {
  model_.slowness = 10;
  model_.playing = true;
  model_.advance(2);  // 2 s on the wall are 0.2 s of the beat
  EXPECT_NEAR(model_.time(), 0.2, 1e-12);
  EXPECT_EQ(model_.frame_index(), 2u);
  model_.advance(7);
  EXPECT_NEAR(model_.time(), 0.1, 1e-9);  // past 0.8: from the start again
  model_.loop = false;
  model_.advance(100);
  EXPECT_EQ(model_.time(), 0.8);
  EXPECT_FALSE(model_.playing);
  model_.step_frames(-1);
  EXPECT_EQ(model_.frame_index(), 7u);
  model_.go_to(-5);
  EXPECT_EQ(model_.time(), 0);
}

TEST_F(ViewModelTest, offers_what_the_run_has) {
  EXPECT_EQ(model_.views().front(), "from_aorta");
  EXPECT_EQ(model_.fields().front(), "stress");
  EXPECT_EQ(model_.fields().size(), 5u);
  EXPECT_THROW(model_.look("plane"), std::invalid_argument);
  ViewModel flat;
  flat.open_run(folder_ / "flat.h5");
  EXPECT_EQ(flat.views(), std::vector<std::string>{"plane"});
  EXPECT_EQ(flat.pictures().size(), 1u);
}

TEST_F(ViewModelTest, pictures_follow_what_is_chosen) {
  model_.go_to(0.4);
  ASSERT_EQ(model_.pictures().size(), 1u);
  EXPECT_NO_THROW(render::check_frame(*model_.pictures()[0].frame));
  model_.look("pair");
  EXPECT_EQ(model_.pictures().size(), 2u);
  EXPECT_FALSE(model_.pictures()[0].panel.particles.empty());
  model_.shown.blood = false;
  EXPECT_TRUE(model_.pictures()[0].panel.particles.empty());
  model_.look("from_aorta");
  const std::string before = model_.signature();
  model_.shown.aorta = false;
  EXPECT_NE(model_.signature(), before);
  const auto pictures = model_.pictures();
  for (const render::SurfaceLayer& layer : pictures[0].panel.surfaces) EXPECT_GE(layer.surface, first_leaflet);
  model_.shown.cut = true;
  model_.shown.cut_at = 0.003;
  const render::Panel panel = model_.pictures()[0].panel;
  ASSERT_TRUE(panel.clip);
  EXPECT_NEAR(panel.clip->normal.dot(panel.clip->point - panel.camera.target), 0.003f, 1e-6f);
}

TEST_F(ViewModelTest, scales_are_of_the_run_of_the_moment_or_by_hand) {
  model_.go_to(0);
  const auto scale = [&] { return model_.pictures()[0].frame->scales[scale_slot("stress")]; };
  EXPECT_EQ(scale().maximum, 3e5);
  model_.shown.range = RangeMode::by_hand;
  model_.shown.by_hand = {1e4, 2e4};
  EXPECT_EQ(scale().minimum, 1e4);
  model_.shown.range = RangeMode::this_moment;
  EXPECT_NEAR(scale().maximum, 3e5 * (1 - 0.7 / 8), 1);  // not rounded; the held row shows the first that moves
  model_.shown.pressure_units = "mmHg";
  EXPECT_EQ(model_.pictures()[0].frame->scales[scale_slot("pressure")].unit, "mmHg");
}

TEST_F(ViewModelTest, the_camera_turns_and_comes_back) {
  const Eigen::Vector3f before = model_.pictures()[0].panel.camera.backward;
  model_.orbit(0.5f, 0.2f);
  EXPECT_GT((model_.pictures()[0].panel.camera.backward - before).norm(), 0.3f);
  const float width = model_.pictures()[0].panel.camera.width;
  model_.zoom(2);
  EXPECT_NEAR(model_.pictures()[0].panel.camera.width, 0.5f * width, 1e-6f);
  model_.look("from_aorta");
  EXPECT_EQ(model_.pictures()[0].panel.camera.backward, before);
}

// A click at the pixel of a leaflet's particle finds it, and its history is the file's.
TEST_F(ViewModelTest, picks_a_place_and_reads_its_history) {
  model_.go_to(0.4);
  const auto pictures = model_.pictures();
  const sim::RunFrame state = model_.run().reader().frame(4);
  const sim::RunHeader::BodyInfo& body = model_.run().reader().header().bodies[1];
  const std::int64_t row = body.first + 6 * 13 + 6;  // in the middle of the second leaflet
  const Eigen::Vector3f place(static_cast<float>(state.position[row][0]), static_cast<float>(state.position[row][1]),
                              static_cast<float>(state.position[row][2]));
  const Eigen::Vector3f at = render::to_pixel(render::panel_projection(*pictures[0].frame, pictures[0].panel, 600, 500, 80), place);
  ASSERT_TRUE(model_.pick(0, 600, 500, 80, at.x(), at.y()));
  EXPECT_EQ(model_.picked->what.substr(0, 9), "leaflet 2");
  const Eigen::Vector3f found =
      render::to_pixel(render::panel_projection(*pictures[0].frame, pictures[0].panel, 600, 500, 80), model_.picked->place);
  EXPECT_LT(std::hypot(found.x() - at.x(), found.y() - at.y()), 15);  // that, or one before it
  EXPECT_LE(found.z(), at.z());
  model_.read_history(4);
  EXPECT_EQ(model_.picked->value.size(), 4u);
  model_.read_history(100);
  ASSERT_EQ(model_.picked->value.size(), 9u);
  EXPECT_EQ(model_.picked->value[4], state.von_mises[static_cast<std::size_t>(model_.picked->row)]);
  EXPECT_FALSE(model_.pick(0, 600, 500, 80, 2, 2));  // nothing there
  EXPECT_FALSE(model_.picked);
}

TEST_F(ViewModelTest, two_runs_stand_beside_each_other_on_one_scale) {
  example::write_valve_run(folder_ / "b.h5", 9, 9e5);
  model_.go_to(0.4);
  model_.open_beside(folder_ / "b.h5");
  const auto pictures = model_.pictures();
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(pictures[0].panel.title.substr(0, 7), "before:");
  EXPECT_EQ(pictures[0].frame->scales[scale_slot("stress")].maximum, 1e6);
  EXPECT_EQ(pictures[1].frame->scales[scale_slot("stress")].maximum, 1e6);
  EXPECT_FALSE(model_.comparison().empty());
  model_.close_beside();
  EXPECT_EQ(model_.pictures().size(), 1u);
}

// A file that is still being written: what is there is shown, what comes is added, and the time follows the end.
TEST_F(ViewModelTest, a_growing_run_is_followed) {
  sim::RunHeader header = model_.run().reader().header();
  sim::RunWriter writer = sim::RunWriter::create(folder_ / "growing.h5", header);
  writer.set_status("running", 0, 0);
  const sim::RunReader source(folder_ / "a.h5");
  const auto rows = source.series();
  const auto add = [&](std::size_t k) {
    writer.add_frame(source.frame(k));
    writer.add_row(rows[k], {});
    writer.finish();  // as a run does at each checkpoint
  };
  add(0);
  ViewModel model;
  model.open_run(folder_ / "growing.h5");
  EXPECT_EQ(model.run().frame_count(), 1u);
  EXPECT_TRUE(model.run().growing());
  EXPECT_FALSE(model.refresh());
  add(1), add(2);
  EXPECT_TRUE(model.refresh());
  EXPECT_EQ(model.run().frame_count(), 3u);
  EXPECT_NEAR(model.time(), 0.2, 1e-12);
  EXPECT_EQ(model.pictures().size(), 1u);
}

TEST_F(ViewModelTest, refuses_what_is_no_run_in_one_line) {
  std::ofstream(folder_ / "text.h5") << "no run";
  for (const char* name : {"text.h5", "none.h5"}) {
    try {
      model_.open_run(folder_ / name);
      ADD_FAILURE() << name;
    } catch (const SceneError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(name), std::string::npos);
      EXPECT_EQ(text.find('\n'), std::string::npos);
    }
  }
  EXPECT_TRUE(model_.has_run());  // what was open stays
}

}  // namespace
}  // namespace app
