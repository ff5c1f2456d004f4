#include "app/movie.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "render/video.h"
#include "tests/app/example_run.h"

namespace app {
namespace {

TEST(MovieSchedule, shows_each_frame_once_unless_told_otherwise) {
  EXPECT_EQ(movie_schedule({0, 1, 2}, 25, std::nullopt, 0, {}), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(movie_schedule({}, 25, std::nullopt, 0, {}).empty());
}

TEST(MovieSchedule, slow_motion_lasts_as_long_as_it_says) {
  std::vector<double> times;
  for (int i = 0; i <= 80; ++i) times.push_back(0.01 * i);
  const auto schedule = movie_schedule(times, 25, 10.0, 0, {});
  EXPECT_EQ(schedule.size(), 201u);  // 0.8 s, ten times slower, at 25 frames a second
  EXPECT_EQ(schedule.front(), 0u);
  EXPECT_EQ(schedule.back(), 80u);
  EXPECT_EQ(schedule[100], 40u);
}

TEST(MovieSchedule, holds_rest_on_their_frames) {
  const auto schedule = movie_schedule({0, 1, 2, 3}, 10, std::nullopt, 0.3, {1, 3});
  EXPECT_EQ(schedule, (std::vector<std::size_t>{0, 1, 1, 1, 1, 2, 3, 3, 3, 3}));
}

TEST(MoviePath, is_read_and_refused) {
  const std::vector<CameraKey> path = read_camera_path("from_aorta@0,long_axis@0.4");
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path[1].view, "long_axis");
  EXPECT_EQ(path[1].time, 0.4);
  for (const char* text : {"", "from_aorta", "from_aorta@", "@1", "a@1,b@1", "a@2,b@1", "a@1x"})
    EXPECT_THROW(read_camera_path(text), std::invalid_argument) << text;
}

TEST(MoviePath, leads_from_view_to_view) {
  render::Panel first, second;
  first.camera.backward = {0, 0, 1}, second.camera.backward = {1, 0, 0};
  first.clip = second.clip = render::ClipPlane{};
  const std::vector<CameraKey> path = {{"a", 1}, {"b", 3}};
  EXPECT_EQ(panel_on_path({first, second}, path, 0).camera.backward, first.camera.backward);
  EXPECT_TRUE(panel_on_path({first, second}, path, 1).clip);
  const render::Panel half = panel_on_path({first, second}, path, 2);
  EXPECT_NEAR((half.camera.backward - Eigen::Vector3f(1, 0, 1).normalized()).norm(), 0, 1e-5);
  EXPECT_FALSE(half.clip);  // between two views nothing is cut
  EXPECT_EQ(panel_on_path({first, second}, path, 9).camera.backward, second.camera.backward);
  EXPECT_THROW(panel_on_path({first}, path, 0), std::invalid_argument);
}

TEST(MovieNames, numbers_are_put_in_place_and_bad_patterns_refused) {
  EXPECT_EQ(numbered_path("frames/%04d.png", 12), "frames/0012.png");
  EXPECT_EQ(numbered_path("a%d.png", 12), "a12.png");
  EXPECT_EQ(numbered_path("a%02d.png", 123), "a123.png");
  for (const char* pattern : {"a.png", "%s.png", "%04d%04d.png", "%n%04d.png"})
    EXPECT_THROW(numbered_path(pattern, 1), std::invalid_argument) << pattern;
}

class Movie : public testing::Test {
 protected:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "cusp_movie";
  Movie() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    example::write_valve_run(folder_ / "a.h5", 5);
    job_.runs = {folder_ / "a.h5"};
    job_.width = 480;
    job_.height = 270;
  }
  ~Movie() override { std::filesystem::remove_all(folder_); }
  MovieJob job_;
};

TEST_F(Movie, a_run_becomes_a_movie_of_all_its_frames) {
  job_.output = folder_ / "made" / "movie.mp4";
  job_.hold = 0.2;
  const MovieResult result = make_movie(job_);
  const render::VideoInfo info = render::probe_video(job_.output.string());
  EXPECT_EQ(info.frames, 5 + 2 * 5);
  EXPECT_EQ(static_cast<int>(result.frames), info.frames);
  EXPECT_EQ(info.width, 480);
  EXPECT_EQ(info.height, 270);
  const render::Image closed = render::read_video_frame(job_.output.string(), 0), open = render::read_video_frame(job_.output.string(), 4);
  EXPECT_NE(closed.rgba, open.rgba);
}

TEST_F(Movie, pictures_come_one_by_one_or_as_a_sequence) {
  job_.output = folder_ / "%03d.png";
  EXPECT_EQ(make_movie(job_).frames, 5u);
  for (const char* name : {"000.png", "004.png"}) EXPECT_TRUE(std::filesystem::exists(folder_ / name));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "005.png"));
  job_.output = folder_ / "one.png";
  job_.time = 0.42;
  job_.quality = 1;
  EXPECT_EQ(make_movie(job_).frames, 1u);
  EXPECT_EQ(render::read_png((folder_ / "one.png").string()).rgba, render::read_png((folder_ / "002.png").string()).rgba);  // t = 0.4
}

TEST_F(Movie, two_runs_stand_side_by_side) {
  example::write_valve_run(folder_ / "b.h5", 9, 9e5, "Stiffer");
  job_.runs.push_back(folder_ / "b.h5");
  job_.output = folder_ / "two.png";
  job_.time = 0;
  make_movie(job_);
  const render::Image image = render::read_png((folder_ / "two.png").string());
  // The same scale: the left valve, with a third of the stress, is darker than the right one at the same place.
  long left = 0, right = 0;
  for (int y = 60; y < 190; ++y)
    for (int x = 20; x < 180; ++x) {
      left += image.at(x, y)[0] + image.at(x, y)[1];
      right += image.at(x + 240, y)[0] + image.at(x + 240, y)[1];
    }
  EXPECT_LT(left, right - 20000);
}

TEST_F(Movie, a_difference_stands_beside_two_runs) {
  example::write_valve_run(folder_ / "b.h5", 5, 9e5, "Stiffer");
  job_.runs.push_back(folder_ / "b.h5");
  job_.output = folder_ / "three.png";
  job_.difference = true;
  job_.time = 0.4;
  job_.width = 900;
  EXPECT_EQ(make_movie(job_).frames, 1u);
  // Right third: the difference is positive everywhere on the valve, so it is orange (red above blue), and nowhere blue.
  const render::Image image = render::read_png((folder_ / "three.png").string());
  long orange = 0, blue = 0;
  for (int y = 60; y < 180; ++y)
    for (int x = 620; x < 800; ++x) {
      const std::uint8_t* p = image.at(x, y);
      orange += p[0] > p[2] + 60;
      blue += p[2] > p[0] + 60;
    }
  EXPECT_GT(orange, 300);
  EXPECT_LT(blue, 20);
  job_.runs.pop_back();
  EXPECT_THROW(make_movie(job_), std::invalid_argument);
}

TEST_F(Movie, stills_of_the_open_and_the_closed_valve_and_previews) {
  job_.output = folder_ / "open.png";
  job_.open = true;
  job_.quality = 1;
  make_movie(job_);
  job_.open = false;
  job_.time = 0.4;  // the widest moment of the made-up beat
  job_.output = folder_ / "at.png";
  make_movie(job_);
  EXPECT_EQ(render::read_png((folder_ / "open.png").string()).rgba, render::read_png((folder_ / "at.png").string()).rgba);
  job_.time.reset();
  job_.output = folder_ / "small.gif";
  EXPECT_EQ(make_movie(job_).frames, 5u);
  EXPECT_EQ(render::probe_video(job_.output.string()).frames, 5);
}

TEST_F(Movie, a_signal_ends_it_and_keeps_what_there_is) {
  std::atomic<bool> stop{false};
  job_.stop = &stop;
  job_.progress = [&](std::size_t done, std::size_t, double) { stop = done >= 2; };
  job_.output = folder_ / "short.mp4";
  const MovieResult result = make_movie(job_);
  EXPECT_TRUE(result.stopped);
  EXPECT_EQ(render::probe_video(job_.output.string()).frames, 2);
}

TEST_F(Movie, mistakes_are_refused_before_anything_is_drawn) {
  const auto says = [](const MovieJob& job) {
    try {
      make_movie(job);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  MovieJob job = job_;
  job.output = folder_ / "movie.avi";
  EXPECT_NE(says(job).find(".mp4"), std::string::npos);
  job.output = folder_ / "movie.mp4";
  job.time = 0.1;
  EXPECT_NE(says(job).find("--time"), std::string::npos);
  job.time.reset();
  job.fps = 0;
  EXPECT_NE(says(job).find("--fps"), std::string::npos);
  job.fps = 25;
  job.width = 50;
  EXPECT_NE(says(job).find("--size"), std::string::npos);
  job.width = 480;
  job.runs = {folder_ / "none.h5"};
  EXPECT_NE(says(job).find("none.h5"), std::string::npos);
  std::ofstream(folder_ / "text.h5") << "no run";
  job.runs = {folder_ / "text.h5"};
  EXPECT_NE(says(job).find("text.h5"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "movie.mp4"));
}

}  // namespace
}  // namespace app
