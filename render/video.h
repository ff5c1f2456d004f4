// Movies: H.264 (libx264) in MP4, playable while they load; and previews that a page or a mail shows as a picture: animated WebP and GIF.
#pragma once

#include <memory>
#include <string>

#include "render/image.h"

namespace render {

struct VideoSettings {
  double fps = 25;   // frames a second, 1 ... 240
  int quality = 18;  // x264's constant rate factor: 0 lossless ... 51; 18 shows no loss
};

// The name's ending chooses the format: .webp, .gif, else MP4. Previews are repeated for ever. Every frame has the size of the first. An
// odd width or height is padded by one row or column, as 4:2:0 colour needs. Throws std::runtime_error naming the file. A movie that is not
// finished (an exception on the way) is removed.
class VideoWriter {
 public:
  VideoWriter(const std::string& path, int width, int height, const VideoSettings& settings);
  ~VideoWriter();
  void add(const Image& image);
  void finish();  // writes the index; must be called
  int frames() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Reads a movie back, for tests and checks: size, frame count, one frame.
struct VideoInfo {
  int width = 0, height = 0, frames = 0;
  double fps = 0;
  std::string codec, pixel_format;
  bool faststart = false;  // the index precedes the pictures
};
VideoInfo probe_video(const std::string& path);
Image read_video_frame(const std::string& path, int index);

}  // namespace render
