#include "render/image.h"

#include <png.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace render {

void write_png(const Image& image, const std::string& path) {
  if (image.width < 1 || image.height < 1) throw std::runtime_error("cannot write '" + path + "': the picture is empty");
  std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(image.width) * image.height);
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) std::memcpy(&rgb[3 * i], &image.rgba[4 * i], 3);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  if (!png_image_write_to_file(&png, path.c_str(), 0, rgb.data(), 0, nullptr))
    throw std::runtime_error("cannot write '" + path + "': " + png.message);
}

Image read_png(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) throw std::runtime_error("cannot read '" + path + "': " + png.message);
  png.format = PNG_FORMAT_RGBA;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr))
    throw std::runtime_error("cannot read '" + path + "': " + png.message);
  return image;
}

void paste(Image& target, const Image& source, int x, int y) {
  const int first = std::max(0, -x), last = std::min(source.width, target.width - x);
  if (first >= last) return;
  for (int row = std::max(0, -y); row < std::min(source.height, target.height - y); ++row)
    std::memcpy(target.at(x + first, y + row), source.at(first, row), 4 * static_cast<std::size_t>(last - first));
}

}  // namespace render
