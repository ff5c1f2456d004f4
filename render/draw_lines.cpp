#include "render/draw_lines.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace render {
namespace {

struct Vertex {
  Eigen::Vector3f place;  // normalised device coordinates
  Eigen::Vector4f color;
  Eigen::Vector3f across;  // pixels along, across; length
};

// Normalised device coordinates of a point lifted towards the eye; false where it lies behind the eye.
bool place(const Eigen::Vector3f& point, float lift, const Projection& projection, Eigen::Vector3f& ndc) {
  Eigen::Vector4f view = projection.view * point.homogeneous();
  if (projection.perspective) {
    if (view.z() > -projection.near) return false;
    view.head<3>() *= std::max(0.1f, 1 - lift / -view.z());
  } else {
    view.z() += lift;
  }
  const Eigen::Vector4f clip = projection.projection * view;
  ndc = clip.head<3>() / clip.w();
  return true;
}

void add_quad(const Segment& segment, float half_width, float lift, const Projection& projection, std::vector<Vertex>& vertices) {
  Eigen::Vector3f from, to;
  if (!place(segment.from, lift, projection, from) || !place(segment.to, lift, projection, to)) return;
  const Eigen::Vector2f half_size(0.5f * static_cast<float>(projection.width), 0.5f * static_cast<float>(projection.height));
  Eigen::Vector2f along = (to - from).head<2>().cwiseProduct(half_size);
  const float length = along.norm();
  along = length > 1e-6f ? Eigen::Vector2f(along / length) : Eigen::Vector2f::UnitX();
  const Eigen::Vector2f sideways(-along.y(), along.x());
  const float reach = half_width + 1;
  const auto corner = [&](bool end, float side) {
    const Eigen::Vector2f shift = ((end ? reach : -reach) * along + side * reach * sideways).cwiseQuotient(half_size);
    const Eigen::Vector3f& base = end ? to : from;
    const Color& color = end ? segment.to_color : segment.from_color;
    vertices.push_back({{base.x() + shift.x(), base.y() + shift.y(), base.z()},
                        {color[0], color[1], color[2], 1},
                        {end ? length + reach : -reach, side * reach, length}});
  };
  for (const auto& [end, side] : {std::pair{false, -1.f}, {true, -1.f}, {true, 1.f}, {false, -1.f}, {true, 1.f}, {false, 1.f}})
    corner(end, side);
}

}  // namespace

std::vector<Segment> segments(const Line& line, const Style& style, const ColorScale* scale) {
  const auto color = [&](std::size_t i) {
    if (style.field < 0 || !scale) return style.color;
    return map_color(scale->map, (line.fields[style.field][i] - scale->minimum) / (scale->maximum - scale->minimum));
  };
  std::vector<Segment> result;
  const std::size_t count = line.points.size();
  for (std::size_t i = 0; i + 1 < count + (line.closed && count > 2 ? 1 : 0); ++i) {
    const std::size_t next = (i + 1) % count;
    result.push_back({line.points[i], line.points[next], color(i), color(next)});
  }
  return result;
}

std::vector<Segment> segments(const std::vector<std::array<Eigen::Vector3f, 2>>& pairs, const Color& color) {
  std::vector<Segment> result;
  for (const auto& [from, to] : pairs) result.push_back({from, to, color, color});
  return result;
}

LinePainter::LinePainter() : program_(make_program("line.vert", "line.frag")), vertices_(make_vertex_array()), buffer_(make_buffer()) {
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<void*>(offsetof(Vertex, place)));
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<void*>(offsetof(Vertex, color)));
  glEnableVertexAttribArray(2);
  glVertexAttribPointer(2, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<void*>(offsetof(Vertex, across)));
}

void LinePainter::draw(const std::vector<Segment>& all, float width, float lift, Depth depth, const Projection& projection) {
  std::vector<Vertex> vertices;
  vertices.reserve(6 * all.size());
  for (const Segment& segment : all) add_quad(segment, 0.5f * width, lift, projection, vertices);
  if (vertices.empty()) return;
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(), GL_STREAM_DRAW);
  glUseProgram(program_);
  set(program_, "half_width", 0.5f * width);
  if (depth == Depth::on_top) glDisable(GL_DEPTH_TEST);
  if (depth == Depth::over) glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace render
