#include "render/draw_section.h"

#include <algorithm>
#include <cmath>

#include "render/draw_particles.h"

namespace render {

SectionPainter::SectionPainter()
    : splat_(make_program("splat.vert", "splat.frag")),
      face_(make_program("screen.vert", "section.frag")),
      mask_(make_program("mask.vert", "mask.frag")),
      vertices_(make_vertex_array()),
      screen_(make_vertex_array()),
      fan_(make_vertex_array()),
      corners_(make_buffer()),
      indices_(make_buffer()),
      fan_corners_(make_buffer()),
      sums_target_(make_framebuffer()),
      inside_target_(make_framebuffer()) {
  glBindVertexArray(fan_);
  glBindBuffer(GL_ARRAY_BUFFER, fan_corners_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 3 * sizeof(float), nullptr);
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 4 * sizeof(float), nullptr);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

// Sums of weight and weighted value at half size: the field is smooth, and blending floats is the dear part.
void SectionPainter::spread(const ParticleSet& set, const Style& style, const ColorScale* scale, const ClipPlane& clip,
                            const Projection& projection) {
  const int width = (projection.width + 1) / 2, height = (projection.height + 1) / 2;
  if (width != width_ || height != height_) {
    width_ = width;
    height_ = height;
    sums_ = make_texture(GL_RG32F, width, height, GL_RG, GL_FLOAT);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glBindFramebuffer(GL_FRAMEBUFFER, sums_target_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, sums_, 0);
  }
  const float reach = section_reach * set.radius;
  std::vector<std::array<float, 4>> corners;
  for (std::size_t i = 0; i < set.positions.size(); ++i) {
    const Eigen::Vector3f& p = set.positions[i];
    if (!p.allFinite() || std::abs(clip.normal.dot(p - clip.point)) >= reach) continue;
    float value = 0;
    if (scale) value = static_cast<float>((set.fields[style.field][i] - scale->minimum) / (scale->maximum - scale->minimum));
    if (std::isnan(value)) continue;
    corners.insert(corners.end(), 4, {p.x(), p.y(), p.z(), value});
  }
  glBindFramebuffer(GL_FRAMEBUFFER, sums_target_);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(corners[0])), corners.data(), GL_STREAM_DRAW);
  const std::size_t count = corners.size() / 4;
  if (indexed_ < count) {
    indexed_ = count;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < indexed_; ++i)
      for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(4 * i + corner);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(), GL_STATIC_DRAW);
  }
  glUseProgram(splat_);
  set_uniforms(splat_, projection);
  render::set(splat_, "clip_plane", in_view(clip, projection));
  render::set(splat_, "reach", reach);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(6 * count), GL_UNSIGNED_INT, nullptr);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

// Even-odd filling: every pixel is turned over once for each triangle (first corner, segment) that covers it.
void SectionPainter::fill_outline(const Outline& outline, const Projection& projection) {
  if (projection.width != inside_width_ || projection.height != inside_height_) {
    inside_width_ = projection.width;
    inside_height_ = projection.height;
    inside_ = make_texture(GL_R8, inside_width_, inside_height_, GL_RED, GL_UNSIGNED_BYTE);
    glBindFramebuffer(GL_FRAMEBUFFER, inside_target_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, inside_, 0);
  }
  std::vector<Eigen::Vector3f> corners;
  for (const auto& [from, to] : outline) corners.insert(corners.end(), {outline.front()[0], from, to});
  glBindFramebuffer(GL_FRAMEBUFFER, inside_target_);
  glViewport(0, 0, projection.width, projection.height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  glBindVertexArray(fan_);
  glBindBuffer(GL_ARRAY_BUFFER, fan_corners_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(corners[0])), corners.data(), GL_STREAM_DRAW);
  glUseProgram(mask_);
  set_uniforms(mask_, projection);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE_MINUS_DST_COLOR, GL_ZERO);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

void SectionPainter::draw(const ParticleSet& particles, const Style& style, const ColorScale* scale, const ClipPlane& clip,
                          const Outline& outline, const Projection& projection, const Framebuffer& target) {
  spread(particles, style, scale, clip, projection);
  if (!outline.empty()) fill_outline(outline, projection);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, projection.width, projection.height);
  glUseProgram(face_);
  set_uniforms(face_, projection);
  set(face_, "sums", sums_, 0);
  set(face_, "masked", static_cast<int>(!outline.empty()));
  if (!outline.empty()) set(face_, "inside", inside_, 2);
  constexpr int colors = 1024;
  const auto table = color_table(scale ? scale->map : Colormap::viridis, colors);
  glActiveTexture(GL_TEXTURE1);
  const Texture texture = make_texture(GL_RGB8, colors, 1, GL_RGB, GL_UNSIGNED_BYTE, table.data());
  set(face_, "color_table", texture, 1);
  set(face_, "size", Eigen::Vector2f(static_cast<float>(projection.width), static_cast<float>(projection.height)));
  set(face_, "clip_plane", in_view(clip, projection));
  set(face_, "by_table", static_cast<int>(scale != nullptr));
  set(face_, "plain_color", style.color);
  // Deep within a body the weights sum to 0.957 (reach / spacing)^3, at its flat surface to half of that; particles are drawn with
  // 0.62 of their spacing. A third of the full sum lets the face end half a spacing beyond the outermost centres; within an outline it
  // fills what lies between them and the wall.
  const float full = 0.957f * std::pow(section_reach * 0.62f, 3.0f);
  set(face_, "enough", (outline.empty() ? 0.3f : 0.12f) * full);
  draw_screen(screen_);
}

}  // namespace render
