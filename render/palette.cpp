#include "render/palette.h"

#include <algorithm>
#include <cstddef>

namespace render {
namespace {

constexpr int levels = 32;  // a channel, of the histogram

int cell_of(const std::uint8_t* pixel) { return ((pixel[0] >> 3) * levels + (pixel[1] >> 3)) * levels + (pixel[2] >> 3); }

struct Entry {
  std::array<int, 3> at;  // cell
  long pixels;
  std::array<long, 3> sum;
};

struct Box {
  std::size_t first, last;  // entries
  long pixels = 0;
  int axis = 0, side = 0;  // the longest
};

Box measured(const std::vector<Entry>& entries, std::size_t first, std::size_t last) {
  Box box{first, last};
  std::array<int, 3> low{levels, levels, levels}, high{-1, -1, -1};
  for (std::size_t i = first; i < last; ++i) {
    box.pixels += entries[i].pixels;
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], entries[i].at[k]), high[k] = std::max(high[k], entries[i].at[k]);
  }
  for (int k = 0; k < 3; ++k)
    if (high[k] - low[k] > box.side) box.side = high[k] - low[k], box.axis = k;
  return box;
}

// The entry at which half of the box's pixels are passed, inside the box.
std::size_t median_entry(std::vector<Entry>& entries, const Box& box) {
  const auto begin = entries.begin();
  std::sort(
      begin + static_cast<std::ptrdiff_t>(box.first), begin + static_cast<std::ptrdiff_t>(box.last),
      [&](const Entry& a, const Entry& b) { return a.at[box.axis] != b.at[box.axis] ? a.at[box.axis] < b.at[box.axis] : a.at < b.at; });
  long passed = 0;
  std::size_t cut = box.first;
  while (cut < box.last && 2 * passed < box.pixels) passed += entries[cut++].pixels;
  return std::clamp(cut, box.first + 1, box.last - 1);
}

}  // namespace

Palette make_palette(const Image& image, int colors) {
  std::vector<Entry> all(static_cast<std::size_t>(levels * levels * levels), Entry{{}, 0, {}});
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    Entry& entry = all[static_cast<std::size_t>(cell_of(&image.rgba[i]))];
    ++entry.pixels;
    for (int k = 0; k < 3; ++k) entry.sum[k] += image.rgba[i + static_cast<std::size_t>(k)];
  }
  std::vector<Entry> entries;
  for (int cell = 0; cell < levels * levels * levels; ++cell)
    if (Entry& entry = all[static_cast<std::size_t>(cell)]; entry.pixels > 0) {
      entry.at = {cell / (levels * levels), cell / levels % levels, cell % levels};
      entries.push_back(entry);
    }
  std::vector<Box> boxes{measured(entries, 0, entries.size())};
  while (static_cast<int>(boxes.size()) < std::clamp(colors, 2, 256)) {
    const auto worst =
        std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) { return a.pixels * a.side < b.pixels * b.side; });
    if (worst->side == 0) break;  // every box is one cell
    const Box box = *worst;
    const std::size_t cut = median_entry(entries, box);
    *worst = measured(entries, box.first, cut);
    boxes.push_back(measured(entries, cut, box.last));
  }
  Palette palette;
  for (const Box& box : boxes) {
    std::array<long, 3> sum{};
    for (std::size_t i = box.first; i < box.last; ++i)
      for (int k = 0; k < 3; ++k) sum[k] += entries[i].sum[k];
    std::array<std::uint8_t, 3> mean{};
    for (int k = 0; k < 3; ++k) mean[k] = static_cast<std::uint8_t>((sum[k] + box.pixels / 2) / std::max(box.pixels, 1L));
    palette.push_back(mean);
  }
  return palette;
}

std::vector<std::uint8_t> indexed(const Image& image, const Palette& palette) {
  std::vector<int> nearest(static_cast<std::size_t>(levels * levels * levels), -1);
  std::vector<std::uint8_t> result(image.rgba.size() / 4);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint8_t* pixel = &image.rgba[4 * i];
    int& found = nearest[static_cast<std::size_t>(cell_of(pixel))];
    if (found < 0) {
      long least = 1L << 40;
      for (std::size_t c = 0; c < palette.size(); ++c) {
        long distance = 0;
        for (int k = 0; k < 3; ++k) {
          const long d = (pixel[k] & 0xf8) + 4 - palette[c][k];
          distance += d * d;
        }
        if (distance < least) least = distance, found = static_cast<int>(c);
      }
    }
    result[i] = static_cast<std::uint8_t>(found);
  }
  return result;
}

}  // namespace render
