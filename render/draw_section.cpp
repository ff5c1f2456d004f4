#include "render/draw_section.h"

#include <Eigen/Geometry>
#include <cmath>

#include "render/draw_particles.h"

namespace render {

SectionPainter::SectionPainter()
    : face_(make_program("screen.vert", "section.frag")),
      mask_(make_program("mask.vert", "mask.frag")),
      screen_(make_vertex_array()),
      fan_(make_vertex_array()),
      fan_corners_(make_buffer()),
      inside_target_(make_framebuffer()) {
  glBindVertexArray(fan_);
  glBindBuffer(GL_ARRAY_BUFFER, fan_corners_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 3 * sizeof(float), nullptr);
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
  const PlaneField field = plane_field(particles, style, scale, clip);
  if (field.width == 0) return;
  if (!outline.empty()) fill_outline(outline, projection);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, projection.width, projection.height);
  glUseProgram(face_);
  set_uniforms(face_, projection);
  glActiveTexture(GL_TEXTURE0);
  const Texture sums = make_texture(GL_RG32F, field.width, field.height, GL_RG, GL_FLOAT, field.sums.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  set(face_, "sums", sums, 0);
  // The field's place and directions in view space, the latter over its whole size.
  const Eigen::Matrix3f turn = projection.view.block<3, 3>(0, 0);
  const Eigen::Vector3f corner = (projection.view * field.corner.homogeneous()).head<3>();
  set(face_, "corner", corner);
  set(face_, "along", Eigen::Vector3f(turn * field.right / (field.cell * static_cast<float>(field.width))));
  set(face_, "across", Eigen::Vector3f(turn * field.up / (field.cell * static_cast<float>(field.height))));
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
