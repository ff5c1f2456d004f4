#include "render/video.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace render {
namespace {

Image plain(int width, int height, int red, int green, int blue) {
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    image.rgba[i] = static_cast<std::uint8_t>(red);
    image.rgba[i + 1] = static_cast<std::uint8_t>(green);
    image.rgba[i + 2] = static_cast<std::uint8_t>(blue);
  }
  return image;
}

class Video : public testing::Test {
 protected:
  std::string path_ = testing::TempDir() + "cusp_video.mp4";
  ~Video() override { std::filesystem::remove(path_); }
};

TEST_F(Video, has_the_frames_the_size_and_the_speed_it_was_given) {
  VideoWriter writer(path_, 320, 180, {12.5, 18});
  for (int i = 0; i < 31; ++i) writer.add(plain(320, 180, 8 * i, 100, 200));
  writer.finish();
  const VideoInfo info = probe_video(path_);
  EXPECT_EQ(info.frames, 31);
  EXPECT_EQ(info.width, 320);
  EXPECT_EQ(info.height, 180);
  EXPECT_NEAR(info.fps, 12.5, 1e-6);
  EXPECT_EQ(info.codec, "h264");
  EXPECT_EQ(info.pixel_format, "yuv420p");
  EXPECT_TRUE(info.faststart);
}

TEST_F(Video, keeps_colours_and_their_order) {
  VideoWriter writer(path_, 64, 64, {});
  const int colors[3][3] = {{200, 30, 30}, {30, 180, 60}, {40, 60, 210}};
  for (const auto& [red, green, blue] : colors) writer.add(plain(64, 64, red, green, blue));
  writer.finish();
  for (int i = 0; i < 3; ++i) {
    const Image frame = read_video_frame(path_, i);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(frame.at(32, 32)[k], colors[i][k], 8) << "frame " << i;
  }
}

TEST_F(Video, previews_as_gif_keep_frames_and_colours) {
  path_ = testing::TempDir() + "cusp_video.gif";
  VideoWriter writer(path_, 64, 48, {10, 18});
  const int colors[3][3] = {{200, 30, 30}, {30, 180, 60}, {40, 60, 210}};
  for (const auto& [red, green, blue] : colors) writer.add(plain(64, 48, red, green, blue));
  writer.finish();
  const VideoInfo info = probe_video(path_);
  EXPECT_EQ(info.codec, "gif");
  EXPECT_EQ(info.frames, 3);
  EXPECT_EQ(info.width, 64);
  for (int i = 0; i < 3; ++i) {
    const Image frame = read_video_frame(path_, i);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(frame.at(32, 24)[k], colors[i][k], 2) << "frame " << i;
  }
}

// RIFF container: one ANMF chunk a frame, of a file that says it is a WebP (libavformat writes but does not read animated ones).
TEST_F(Video, previews_as_webp_hold_all_frames) {
  path_ = testing::TempDir() + "cusp_video.webp";
  VideoWriter writer(path_, 64, 48, {10, 18});
  for (int i = 0; i < 4; ++i) writer.add(plain(64, 48, 60 * i, 100, 200));
  writer.finish();
  std::ifstream file(path_, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  EXPECT_EQ(bytes.substr(0, 4), "RIFF");
  EXPECT_EQ(bytes.substr(8, 4), "WEBP");
  int frames = 0;
  for (auto at = bytes.find("ANMF"); at != std::string::npos; at = bytes.find("ANMF", at + 4)) ++frames;
  EXPECT_EQ(frames, 4);
}

TEST_F(Video, pads_odd_sizes) {
  VideoWriter writer(path_, 101, 75, {});
  writer.add(plain(101, 75, 120, 120, 120));
  writer.finish();
  EXPECT_EQ(probe_video(path_).width, 102);
  EXPECT_EQ(probe_video(path_).height, 76);
}

TEST_F(Video, refuses_in_one_line_that_names_the_file) {
  const auto message = [](auto&& attempt) {
    try {
      attempt();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(message([] { VideoWriter("/nowhere/a.mp4", 64, 64, {}); }).find("/nowhere/a.mp4"), std::string::npos);
  EXPECT_NE(message([&] { VideoWriter(path_, 64, 64, {0, 18}); }).find("1 and 240"), std::string::npos);
  EXPECT_NE(message([&] { VideoWriter(path_, 64, 64, {}).add(Image(65, 64)); }).find("65 x 64"), std::string::npos);
  EXPECT_NE(message([&] { VideoWriter(path_, 64, 64, {}).finish(); }).find("no frame"), std::string::npos);
}

TEST_F(Video, what_was_not_finished_is_not_left_lying) {
  { VideoWriter(path_, 64, 64, {}).add(Image(64, 64)); }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

}  // namespace
}  // namespace render
