#include "render/image.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

namespace render {
namespace {

Image pattern(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      image.at(x, y)[0] = static_cast<std::uint8_t>(7 * x);
      image.at(x, y)[1] = static_cast<std::uint8_t>(11 * y);
      image.at(x, y)[2] = static_cast<std::uint8_t>(x * y);
    }
  return image;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Image, png_gives_back_what_was_written_and_always_the_same_bytes) {
  const std::string path = testing::TempDir() + "cusp_image.png";
  const Image image = pattern(37, 21);
  write_png(image, path);
  const std::string first = bytes_of(path);
  EXPECT_EQ(read_png(path).rgba, image.rgba);
  write_png(image, path);
  EXPECT_EQ(bytes_of(path), first);
  std::filesystem::remove(path);
}

TEST(Image, errors_name_the_file) {
  for (const auto& attempt : {std::function<void()>([] { read_png("/nowhere/a.png"); }),
                              std::function<void()>([] { write_png(Image(2, 2), "/nowhere/a.png"); })}) {
    try {
      attempt();
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("/nowhere/a.png"), std::string::npos);
    }
  }
  EXPECT_THROW(write_png(Image(), testing::TempDir() + "cusp_none.png"), std::runtime_error);
}

TEST(Image, paste_keeps_to_the_target) {
  Image target(10, 10);
  const Image source = pattern(6, 6);
  paste(target, source, 7, -2);
  EXPECT_EQ(target.at(7, 0)[1], source.at(0, 2)[1]);
  EXPECT_EQ(target.at(9, 3)[0], source.at(2, 5)[0]);
  EXPECT_EQ(target.at(9, 4)[0], 255);
  EXPECT_EQ(target.at(6, 0)[0], 255);
}

}  // namespace
}  // namespace render
