#include "render/video.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/imgutils.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <vector>

#include "render/palette.h"

namespace render {
namespace {

std::string error_text(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

template <class T, void (*Free)(T**)>
struct FreeByHandle {
  void operator()(T* thing) const { Free(&thing); }
};
using Codec = std::unique_ptr<AVCodecContext, FreeByHandle<AVCodecContext, avcodec_free_context>>;
using Picture = std::unique_ptr<AVFrame, FreeByHandle<AVFrame, av_frame_free>>;
using Packet = std::unique_ptr<AVPacket, FreeByHandle<AVPacket, av_packet_free>>;
struct FreeScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
using Scaler = std::unique_ptr<SwsContext, FreeScaler>;

// RGB to 4:2:0 by the high-definition standard's matrix (BT.709), which players assume for pictures of this size.
void use_bt709(SwsContext* scaler, bool to_rgb) {
  const int* matrix = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(scaler, matrix, to_rgb ? 0 : 1, matrix, to_rgb ? 1 : 0, 0, 1 << 16, 1 << 16);
}

enum class Container { mp4, webp, gif };

Container container_of(const std::string& path) {
  const auto ends = [&](const char* ending) { return path.size() >= std::strlen(ending) && path.ends_with(ending); };
  return ends(".webp") ? Container::webp : ends(".gif") ? Container::gif : Container::mp4;
}

const char* const container_names[] = {"mp4", "webp", "gif"};

}  // namespace

struct VideoWriter::Parts {
  Container container = Container::mp4;
  std::string path;
  AVFormatContext* file = nullptr;
  AVStream* stream = nullptr;
  Codec codec;
  Picture picture;
  Packet packet;
  Scaler scaler;
  int width = 0, height = 0, frames = 0;
  bool finished = false, opened = false;

  [[noreturn]] void fail(const std::string& what, int code) const {
    throw std::runtime_error("cannot write the movie '" + path + "': " + what + (code < 0 ? ": " + error_text(code) : ""));
  }
  void check(int code, const char* what) const {
    if (code < 0) fail(what, code);
  }
  void open_codec(const VideoSettings& settings);
  void set_h264(const VideoSettings& settings);
  void fill_indexed(const Image& image);
  void open_file();
  void drain(const AVFrame* frame);
  ~Parts() {
    if (!file) return;
    if (opened) avio_closep(&file->pb);
    avformat_free_context(file);
    if (opened && !finished) std::remove(path.c_str());
  }
};

void VideoWriter::Parts::open_codec(const VideoSettings& settings) {
  const char* const names[] = {"libx264", "libwebp_anim", "gif"};
  const char* const name = names[static_cast<int>(container)];
  const AVCodec* encoder = avcodec_find_encoder_by_name(name);
  if (!encoder) fail(std::string("this libavcodec has no ") + name, 0);
  codec.reset(avcodec_alloc_context3(encoder));
  const AVRational rate = av_d2q(settings.fps, 100000);
  codec->framerate = rate;
  codec->time_base = container == Container::gif ? AVRational{1, 100} : av_inv_q(rate);  // GIF counts hundredths of a second
  codec->width = width;
  codec->height = height;
  codec->pix_fmt = container == Container::gif ? AV_PIX_FMT_PAL8 : AV_PIX_FMT_BGRA;
  if (container == Container::mp4) set_h264(settings);
  if (container == Container::webp) av_opt_set(codec->priv_data, "quality", "80", 0);
  check(avcodec_open2(codec.get(), encoder, nullptr), (std::string("opening ") + name).c_str());
}

void VideoWriter::Parts::set_h264(const VideoSettings& settings) {
  codec->width = width + width % 2;
  codec->height = height + height % 2;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->colorspace = AVCOL_SPC_BT709;
  codec->color_primaries = AVCOL_PRI_BT709;
  codec->color_trc = AVCOL_TRC_IEC61966_2_1;
  codec->color_range = AVCOL_RANGE_MPEG;
  codec->gop_size = static_cast<int>(std::lround(2 * settings.fps));
  av_opt_set(codec->priv_data, "preset", "veryfast", 0);
  av_opt_set(codec->priv_data, "crf", std::to_string(settings.quality).c_str(), 0);
  if (file->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
}

void VideoWriter::Parts::open_file() {
  stream = avformat_new_stream(file, nullptr);
  if (!stream) fail("no room for a stream", 0);
  check(avcodec_parameters_from_context(stream->codecpar, codec.get()), "describing the stream");
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  check(avio_open(&file->pb, path.c_str(), AVIO_FLAG_WRITE), "opening the file");
  opened = true;
  AVDictionary* options = nullptr;
  if (container == Container::mp4) av_dict_set(&options, "movflags", "+faststart", 0);
  if (container != Container::mp4) av_dict_set(&options, "loop", "0", 0);  // for ever
  const int code = avformat_write_header(file, &options);
  av_dict_free(&options);
  check(code, "writing the header");
}

VideoWriter::VideoWriter(const std::string& path, int width, int height, const VideoSettings& settings)
    : parts_(std::make_unique<Parts>()) {
  av_log_set_level(AV_LOG_ERROR);
  Parts& p = *parts_;
  p.path = path;
  p.width = width;
  p.height = height;
  if (!(settings.fps >= 1 && settings.fps <= 240)) p.fail("frames a second must lie between 1 and 240", 0);
  if (width < 2 || height < 2) p.fail("the picture is too small", 0);
  p.container = container_of(path);
  p.check(avformat_alloc_output_context2(&p.file, nullptr, container_names[static_cast<int>(p.container)], path.c_str()),
          "choosing the format");
  p.open_codec(settings);
  p.open_file();
  p.picture.reset(av_frame_alloc());
  p.packet.reset(av_packet_alloc());
  p.picture->format = p.codec->pix_fmt;
  p.picture->width = p.codec->width;
  p.picture->height = p.codec->height;
  p.check(av_frame_get_buffer(p.picture.get(), 0), "making a frame");
  if (p.container == Container::gif) return;
  p.scaler.reset(sws_getContext(p.codec->width, p.codec->height, AV_PIX_FMT_RGBA, p.codec->width, p.codec->height, p.codec->pix_fmt,
                                SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
  if (!p.scaler) p.fail("no conversion of colours", 0);
  if (p.container == Container::mp4) use_bt709(p.scaler.get(), false);
}

VideoWriter::~VideoWriter() = default;
int VideoWriter::frames() const { return parts_->frames; }

void VideoWriter::Parts::drain(const AVFrame* frame) {
  check(avcodec_send_frame(codec.get(), frame), "encoding");
  while (true) {
    const int code = avcodec_receive_packet(codec.get(), packet.get());
    if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
    check(code, "encoding");
    if (container == Container::mp4) packet->duration = 1;
    av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
    packet->stream_index = stream->index;
    check(av_interleaved_write_frame(file, packet.get()), "writing a frame");
  }
}

void VideoWriter::add(const Image& image) {
  Parts& p = *parts_;
  if (image.width != p.width || image.height != p.height)
    p.fail("a frame of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels in a movie of " +
               std::to_string(p.width) + " x " + std::to_string(p.height),
           0);
  const Image* source = &image;
  Image padded;
  if (p.codec->width != p.width || p.codec->height != p.height) {
    padded = Image(p.codec->width, p.codec->height);
    paste(padded, image, 0, 0);
    source = &padded;
  }
  p.check(av_frame_make_writable(p.picture.get()), "making a frame");
  if (p.container == Container::gif) {
    p.fill_indexed(*source);
  } else {
    const std::uint8_t* rows[1] = {source->rgba.data()};
    const int stride[1] = {4 * source->width};
    sws_scale(p.scaler.get(), rows, stride, 0, source->height, p.picture->data, p.picture->linesize);
  }
  p.picture->pts = av_rescale_q(p.frames++, av_inv_q(p.codec->framerate), p.codec->time_base);
  p.drain(p.picture.get());
}

// Each frame has colours of its own: those of a scale may appear late in a movie.
void VideoWriter::Parts::fill_indexed(const Image& image) {
  const Palette palette = make_palette(image);
  const std::vector<std::uint8_t> pixels = indexed(image, palette);
  for (int y = 0; y < image.height; ++y)
    std::memcpy(picture->data[0] + static_cast<std::ptrdiff_t>(y) * picture->linesize[0],
                &pixels[static_cast<std::size_t>(y) * image.width], static_cast<std::size_t>(image.width));
  auto* entries = reinterpret_cast<std::uint32_t*>(picture->data[1]);  // as libavutil lays a palette out: 0xAARRGGBB
  for (std::size_t c = 0; c < 256; ++c) {
    const std::array<std::uint8_t, 3> color = c < palette.size() ? palette[c] : std::array<std::uint8_t, 3>{};
    entries[c] = 0xff000000u | static_cast<std::uint32_t>(color[0]) << 16 | static_cast<std::uint32_t>(color[1]) << 8 | color[2];
  }
}

void VideoWriter::finish() {
  Parts& p = *parts_;
  if (p.frames == 0) p.fail("it has no frame", 0);
  p.drain(nullptr);
  p.check(av_write_trailer(p.file), "writing the index");
  p.check(avio_closep(&p.file->pb), "closing the file");
  p.finished = true;
}

namespace {

// Decodes every frame and hands it over.
void decode(const std::string& path, VideoInfo& info, const std::function<void(int, const AVFrame&)>& each) {
  const auto check = [&](int code) {
    if (code < 0) throw std::runtime_error("cannot read the movie '" + path + "': " + error_text(code));
  };
  av_log_set_level(AV_LOG_ERROR);
  AVFormatContext* opened = nullptr;
  check(avformat_open_input(&opened, path.c_str(), nullptr, nullptr));
  const std::unique_ptr<AVFormatContext, FreeByHandle<AVFormatContext, avformat_close_input>> file(opened);
  check(avformat_find_stream_info(file.get(), nullptr));
  const AVCodec* decoder = nullptr;
  const int index = av_find_best_stream(file.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  check(index);
  const Codec codec(avcodec_alloc_context3(decoder));
  check(avcodec_parameters_to_context(codec.get(), file->streams[index]->codecpar));
  check(avcodec_open2(codec.get(), decoder, nullptr));
  info.width = codec->width;
  info.height = codec->height;
  info.codec = decoder->name;
  info.pixel_format = av_get_pix_fmt_name(codec->pix_fmt);
  info.fps = av_q2d(file->streams[index]->avg_frame_rate);
  const Packet packet(av_packet_alloc());
  const Picture picture(av_frame_alloc());
  const auto receive = [&] {
    int code = 0;
    while ((code = avcodec_receive_frame(codec.get(), picture.get())) >= 0) each(info.frames++, *picture);
    if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) check(code);
  };
  while (av_read_frame(file.get(), packet.get()) >= 0) {
    if (packet->stream_index == index) {
      check(avcodec_send_packet(codec.get(), packet.get()));
      receive();
    }
    av_packet_unref(packet.get());
  }
  check(avcodec_send_packet(codec.get(), nullptr));
  receive();
}

}  // namespace

VideoInfo probe_video(const std::string& path) {
  VideoInfo info;
  decode(path, info, [](int, const AVFrame&) {});
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const auto index = bytes.find("moov"), pictures = bytes.find("mdat");
  info.faststart = index != std::string::npos && pictures != std::string::npos && index < pictures;
  return info;
}

Image read_video_frame(const std::string& path, int wanted) {
  VideoInfo info;
  Image image;
  decode(path, info, [&](int index, const AVFrame& frame) {
    if (index != wanted) return;
    image = Image(frame.width, frame.height);
    const Scaler scaler(sws_getContext(frame.width, frame.height, static_cast<AVPixelFormat>(frame.format), frame.width, frame.height,
                                       AV_PIX_FMT_RGBA, SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
    use_bt709(scaler.get(), true);
    std::uint8_t* rows[1] = {image.rgba.data()};
    const int stride[1] = {4 * image.width};
    sws_scale(scaler.get(), frame.data, frame.linesize, 0, frame.height, rows, stride);
  });
  if (image.width == 0) throw std::runtime_error("the movie '" + path + "' has no frame " + std::to_string(wanted));
  return image;
}

}  // namespace render
