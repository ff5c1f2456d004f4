#include "render/draw_particles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace render {

namespace {

// Cells all of whose 27 cells (their own and those about it) are full.
std::vector<std::uint8_t> surrounded(const std::vector<std::uint8_t>& full, const Eigen::Array3i& size) {
  std::vector<std::uint8_t> result(full.size(), 0);
  const std::ptrdiff_t row = size.x(), sheet = row * size.y();
  for (int z = 1; z + 1 < size.z(); ++z)
    for (int y = 1; y + 1 < size.y(); ++y)
      for (int x = 1; x + 1 < size.x(); ++x) {
        const std::ptrdiff_t here = z * sheet + y * row + x;
        bool all = full[here];
        for (std::ptrdiff_t dz = -sheet; all && dz <= sheet; dz += sheet)
          for (std::ptrdiff_t dy = -row; all && dy <= row; dy += row)
            all = full[here + dz + dy - 1] && full[here + dz + dy] && full[here + dz + dy + 1];
        result[here] = all;
      }
  return result;
}

}  // namespace

std::vector<std::uint8_t> buried(const std::vector<Eigen::Vector3f>& positions, const std::vector<std::uint8_t>& kept, float radius) {
  std::vector<std::uint8_t> result(positions.size(), 0);
  Bounds bounds;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (kept[i]) bounds.add(positions[i]);
  if (bounds.empty()) return result;
  const float cell = 2.5f * radius;
  const Eigen::Array3d cells_wide = ((bounds.max - bounds.min).cast<double>().array() / cell).floor() + 3;  // one empty cell all round
  if (!(cells_wide.prod() < 3e7)) return result;  // thinly spread: nothing much is buried, and the grid would be large
  const Eigen::Array3i size = cells_wide.cast<int>();
  const auto place = [&](const Eigen::Vector3f& p) {
    const Eigen::Array3i at = ((p - bounds.min).array() / cell).floor().cast<int>() + 1;
    return (static_cast<std::size_t>(at.z()) * size.y() + at.y()) * size.x() + at.x();
  };
  std::vector<std::uint8_t> full(static_cast<std::size_t>(size.prod()), 0);
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (kept[i]) full[place(positions[i])] = 1;
  const std::vector<std::uint8_t> deep = surrounded(surrounded(full, size), size);
  for (std::size_t i = 0; i < positions.size(); ++i) result[i] = kept[i] && deep[place(positions[i])];
  return result;
}

std::vector<Sphere> visible_spheres(const ParticleSet& set, const Style& style, const ColorScale* scale,
                                    const std::optional<ClipPlane>& clip, ParticleShape shape) {
  const std::size_t count = set.positions.size();
  std::vector<std::uint8_t> kept(count, 1);
  for (std::size_t i = 0; i < count; ++i) {
    if (!set.positions[i].allFinite())
      kept[i] = 0;
    else if (clip && style.clipped)
      kept[i] = clip->normal.dot(set.positions[i] - clip->point) < set.radius;
  }
  const std::vector<std::uint8_t> hidden =
      shape == ParticleShape::sphere ? buried(set.positions, kept, set.radius) : std::vector<std::uint8_t>(count, 0);
  constexpr int colors = 1024;
  const bool by_field = style.field >= 0 && scale;
  const auto table = by_field ? color_table(scale->map, colors) : std::vector<std::array<std::uint8_t, 3>>{};
  const auto byte = [](float part) { return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0f, 1.0f))); };
  const std::array<std::uint8_t, 4> plain = {byte(style.color[0]), byte(style.color[1]), byte(style.color[2]), 255};
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    if (!kept[i] || hidden[i]) continue;
    Sphere sphere{set.positions[i], set.radius, plain};
    if (by_field) {
      const double t = (set.fields[style.field][i] - scale->minimum) / (scale->maximum - scale->minimum);
      if (std::isnan(t)) {
        sphere.color = {128, 128, 128, 255};
      } else {
        const auto& rgb = table[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * (colors - 1)))];
        sphere.color = {rgb[0], rgb[1], rgb[2], 255};
      }
    }
    spheres.push_back(sphere);
  }
  return spheres;
}

Eigen::Vector4f in_view(const ClipPlane& plane, const Projection& projection) {
  const Eigen::Vector3f normal = projection.view.block<3, 3>(0, 0) * plane.normal;
  const Eigen::Vector3f point = (projection.view * plane.point.homogeneous()).head<3>();
  return {normal.x(), normal.y(), normal.z(), -normal.dot(point)};
}

ParticlePainter::ParticlePainter()
    : program_(make_program("sphere.vert", "sphere.frag")),
      vertices_(make_vertex_array()),
      corners_(make_buffer()),
      indices_(make_buffer()) {
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(Sphere), nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Sphere), reinterpret_cast<void*>(offsetof(Sphere, color)));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
}

void ParticlePainter::draw(const std::vector<Sphere>& spheres, ParticleShape shape, const Projection& projection,
                           const std::optional<ClipPlane>& clip) {
  if (spheres.empty()) return;
  std::vector<Sphere> corners;
  corners.reserve(4 * spheres.size());
  for (const Sphere& sphere : spheres) corners.insert(corners.end(), 4, sphere);
  glBindVertexArray(vertices_);
  glBindBuffer(GL_ARRAY_BUFFER, corners_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(Sphere)), corners.data(), GL_STREAM_DRAW);
  if (indexed_ < spheres.size()) {
    indexed_ = spheres.size();
    std::vector<std::uint32_t> indices;
    indices.reserve(6 * indexed_);
    for (std::uint32_t i = 0; i < indexed_; ++i)
      for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(4 * i + corner);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(), GL_STATIC_DRAW);
  }
  glUseProgram(program_);
  set_uniforms(program_, projection);
  set(program_, "disc", static_cast<int>(shape == ParticleShape::disc));
  set(program_, "clip_on", static_cast<int>(clip.has_value()));
  if (clip) set(program_, "clip_plane", in_view(*clip, projection));
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(6 * spheres.size()), GL_UNSIGNED_INT, nullptr);
}

}  // namespace render
