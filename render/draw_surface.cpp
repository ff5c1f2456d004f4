#include "render/draw_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/draw_particles.h"

namespace render {
namespace {

void set_view(const Program& program, const Projection& projection, const std::optional<ClipPlane>& clip) {
  glUseProgram(program);
  set_uniforms(program, projection);
  set(program, "clip_on", static_cast<int>(clip.has_value()));
  if (clip) set(program, "clip_plane", in_view(*clip, projection));
}

template <class T>
void upload(GLenum target, const Buffer& buffer, const std::vector<T>& data) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(data.size() * sizeof(T)), data.data(), GL_STREAM_DRAW);
}

struct Vertex {
  Eigen::Vector3f position, normal;
  float value;
};

void attribute(GLuint index, GLint count, GLenum type, GLsizei stride, std::size_t offset) {
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, count, type, type == GL_UNSIGNED_BYTE, stride, reinterpret_cast<void*>(offset));
}

float along(const ColorScale& scale, float value) { return static_cast<float>((value - scale.minimum) / (scale.maximum - scale.minimum)); }

}  // namespace

SurfacePainter::SurfacePainter()
    : program_(make_program("surface.vert", "surface.frag")),
      vertices_(make_vertex_array()),
      buffer_(make_buffer()),
      indices_(make_buffer()) {
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  attribute(0, 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, position));
  attribute(1, 3, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, normal));
  attribute(2, 1, GL_FLOAT, sizeof(Vertex), offsetof(Vertex, value));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

void SurfacePainter::draw(const DrawnMesh& mesh, const ColorScale* scale, const Color& plain, const Projection& projection,
                          const std::optional<ClipPlane>& clip) {
  if (mesh.triangles.empty()) return;
  std::vector<Vertex> vertices(mesh.positions.size());
  for (std::size_t i = 0; i < vertices.size(); ++i)
    vertices[i] = {mesh.positions[i], mesh.normals[i], scale ? along(*scale, mesh.values[i]) : 0.0f};
  glBindVertexArray(vertices_);
  upload(GL_ARRAY_BUFFER, buffer_, vertices);
  upload(GL_ELEMENT_ARRAY_BUFFER, indices_, mesh.triangles);
  set_view(program_, projection, clip);
  set(program_, "by_table", static_cast<int>(scale != nullptr));
  set(program_, "plain_color", plain);
  constexpr int colors = 1024;
  const auto table = color_table(scale ? scale->map : Colormap::viridis, colors);
  const Texture texture = make_texture(GL_RGB8, colors, 1, GL_RGB, GL_UNSIGNED_BYTE, table.data());
  set(program_, "color_table", texture, 0);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangles.size()), GL_UNSIGNED_INT, nullptr);
}

void Glass::add(const DrawnMesh& mesh, const Style& style, const ColorScale* scale) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  const auto byte = [](float part) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0f, 1.0f))); };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Color color = style.field >= 0 && scale ? map_color(scale->map, along(*scale, mesh.values[i])) : style.color;
    vertices.push_back({mesh.positions[i],
                        mesh.normals[i],
                        {byte(color[0]), byte(color[1]), byte(color[2]), byte(style.opacity)},
                        style.clipped ? 1.0f : 0.0f});
  }
  for (const auto& [a, b, c] : mesh.triangles)
    triangles.push_back(
        {first + static_cast<std::uint32_t>(a), first + static_cast<std::uint32_t>(b), first + static_cast<std::uint32_t>(c)});
}

std::vector<std::uint32_t> back_to_front(const Glass& glass, const Projection& projection, const std::optional<ClipPlane>& clip) {
  const Eigen::Vector4f depth_row = projection.view.row(2);
  const Eigen::Matrix4f to_clip = projection.projection * projection.view;
  std::vector<float> depth(glass.vertices.size());
  std::vector<std::uint8_t> beyond(glass.vertices.size());  // one bit for each side that the vertex lies beyond
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const Glass::Vertex& vertex = glass.vertices[i];
    depth[i] = depth_row.head<3>().dot(vertex.position);
    const Eigen::Vector4f at = to_clip * vertex.position.homogeneous();
    const bool cut = clip && vertex.clipped > 0.5f && clip->normal.dot(vertex.position - clip->point) > 0;
    beyond[i] = static_cast<std::uint8_t>((at.x() < -at.w()) | (at.x() > at.w()) << 1 | (at.y() < -at.w()) << 2 | (at.y() > at.w()) << 3 |
                                          cut << 4);
  }
  // Sorted as one whole number each: the depth's bits, turned so that they grow with it, then the triangle's number.
  std::vector<std::uint64_t> keys;
  keys.reserve(glass.triangles.size());
  for (std::size_t t = 0; t < glass.triangles.size(); ++t) {
    const auto& [a, b, c] = glass.triangles[t];
    if (beyond[a] & beyond[b] & beyond[c]) continue;
    const auto bits = std::bit_cast<std::uint32_t>(depth[a] + depth[b] + depth[c] + 0.0f);
    const std::uint32_t growing = bits >> 31 ? ~bits : bits | 0x80000000u;
    keys.push_back(std::uint64_t{growing} << 32 | t);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t t = 0; t < keys.size(); ++t) order[t] = static_cast<std::uint32_t>(keys[t]);
  return order;
}

GlassPainter::GlassPainter()
    : program_(make_program("glass.vert", "glass.frag")), vertices_(make_vertex_array()), buffer_(make_buffer()), indices_(make_buffer()) {
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  attribute(0, 3, GL_FLOAT, sizeof(Glass::Vertex), offsetof(Glass::Vertex, position));
  attribute(1, 3, GL_FLOAT, sizeof(Glass::Vertex), offsetof(Glass::Vertex, normal));
  attribute(2, 4, GL_UNSIGNED_BYTE, sizeof(Glass::Vertex), offsetof(Glass::Vertex, color));
  attribute(3, 1, GL_FLOAT, sizeof(Glass::Vertex), offsetof(Glass::Vertex, clipped));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

void GlassPainter::draw(const Glass& glass, const Projection& projection, const std::optional<ClipPlane>& clip) {
  if (glass.triangles.empty()) return;
  std::vector<std::array<std::uint32_t, 3>> sorted;
  for (const std::uint32_t t : back_to_front(glass, projection, clip)) sorted.push_back(glass.triangles[t]);
  glBindVertexArray(vertices_);
  upload(GL_ARRAY_BUFFER, buffer_, glass.vertices);
  upload(GL_ELEMENT_ARRAY_BUFFER, indices_, sorted);
  set_view(program_, projection, clip);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * sorted.size()), GL_UNSIGNED_INT, nullptr);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
}

}  // namespace render
