#include "app/movie.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/app/example_run.h"
#include "render/video.h"

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
