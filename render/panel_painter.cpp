#include "render/panel_painter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "render/draw_lines.h"
#include "render/draw_particles.h"
#include "render/draw_section.h"
#include "render/draw_surface.h"
#include "render/shader.h"
#include "render/skin_cache.h"

namespace render {
namespace {

// The buffers that a picture of one size is drawn through.
struct Targets {
  int width = 0, height = 0, scale = 0;  // of the finished picture; pixels squared for each
  Texture albedo, normals, depth, occlusion, open_sky, drawn, finished;
  Framebuffer opaque, occluded, blurred, lit, resolved;
};

void attach(const Framebuffer& target, std::initializer_list<const Texture*> colors, const Texture* depth) {
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  std::vector<GLenum> outputs;
  for (const Texture* color : colors) {
    const auto slot = static_cast<GLenum>(GL_COLOR_ATTACHMENT0 + outputs.size());
    glFramebufferTexture2D(GL_FRAMEBUFFER, slot, GL_TEXTURE_2D, *color, 0);
    outputs.push_back(slot);
  }
  if (depth) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, *depth, 0);
  glDrawBuffers(static_cast<GLsizei>(outputs.size()), outputs.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("the OpenGL driver cannot draw into the buffers that a picture needs");
}

// Of the texture that was made last.
void filter_linearly() {
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

Targets make_targets(int width, int height, int scale) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  const int w = width * scale, h = height * scale;
  if (std::max(w, h) > largest)
    throw std::invalid_argument("a picture of " + std::to_string(w) + " x " + std::to_string(h) + " pixels is larger than this driver's " +
                                std::to_string(largest) + ": make it smaller");
  Targets t;
  t.width = width, t.height = height, t.scale = scale;
  for (Framebuffer* target : {&t.opaque, &t.occluded, &t.blurred, &t.lit, &t.resolved}) *target = make_framebuffer();
  t.albedo = make_texture(GL_RGBA8, w, h, GL_RGBA, GL_UNSIGNED_BYTE);
  t.normals = make_texture(GL_RGB10_A2, w, h, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV);
  t.depth = make_texture(GL_DEPTH_COMPONENT32F, w, h, GL_DEPTH_COMPONENT, GL_FLOAT);
  t.occlusion = make_texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE);
  t.open_sky = make_texture(GL_R8, (w + 1) / 2, (h + 1) / 2, GL_RED, GL_UNSIGNED_BYTE);
  filter_linearly();
  t.drawn = make_texture(GL_RGBA8, w, h, GL_RGBA, GL_UNSIGNED_BYTE);
  filter_linearly();
  t.finished = make_texture(GL_RGBA8, width, height, GL_RGBA, GL_UNSIGNED_BYTE);
  attach(t.opaque, {&t.albedo, &t.normals}, &t.depth);
  attach(t.occluded, {&t.occlusion}, nullptr);
  attach(t.blurred, {&t.open_sky}, nullptr);
  attach(t.lit, {&t.drawn}, &t.depth);
  attach(t.resolved, {&t.finished}, nullptr);
  return t;
}

const ColorScale* scale_of(const Frame& frame, const Style& style) { return style.field >= 0 ? &frame.scales[style.scale] : nullptr; }

std::optional<ClipPlane> clip_of(const Panel& panel, const Style& style) { return style.clipped ? panel.clip : std::nullopt; }

// What a clip plane leaves of segments.
std::vector<std::array<Eigen::Vector3f, 2>> left_by(const std::optional<ClipPlane>& clip,
                                                    const std::vector<std::array<Eigen::Vector3f, 2>>& all) {
  if (!clip) return all;
  std::vector<std::array<Eigen::Vector3f, 2>> left;
  for (auto [a, b] : all) {
    const float over_a = clip->normal.dot(a - clip->point), over_b = clip->normal.dot(b - clip->point);
    if (over_a > 0 && over_b > 0) continue;
    const Eigen::Vector3f between = a + over_a / (over_a - over_b) * (b - a);  // used where the signs differ
    if (over_a > 0) a = between;
    if (over_b > 0) b = between;
    left.push_back({a, b});
  }
  return left;
}

Bounds bounds_of(const std::vector<Eigen::Vector3f>& points, float radius) {
  Bounds bounds;
  for (const Eigen::Vector3f& point : points)
    if (point.allFinite()) bounds.add(point, radius);
  return bounds;
}

// The curves in which the clip plane cuts the first translucent surface (a vessel), where they are closed: no open border crosses the
// plane.
Outline cut_outline(const Frame& frame, const Panel& panel, SkinCache& skins) {
  for (const SurfaceLayer& layer : panel.surfaces) {
    if (layer.style.opacity >= 1 || !layer.section) continue;
    const Surface& surface = frame.surfaces[layer.surface];
    const auto above = [&](std::int32_t i) { return panel.clip->normal.dot(surface.vertices[i] - panel.clip->point) > 0; };
    for (const auto& [a, b] : skins.border(surface))
      if (above(a) != above(b)) return {};
    return section(surface.vertices, surface.triangles, *panel.clip);
  }
  return {};
}

// Pixels from the left lower corner; empty where width or height are 0.
struct PixelBox {
  int x = 0, y = 0, width = 0, height = 0;
};

// Where the opaque things can be seen.
PixelBox opaque_box(const Frame& frame, const Panel& panel, const Projection& projection) {
  Eigen::Array2f low(1e9f, 1e9f), high(-1e9f, -1e9f);
  const auto add = [&](const Bounds& bounds) {
    if (bounds.empty()) return;
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector3f point;
      for (int k = 0; k < 3; ++k) point[k] = corner >> k & 1 ? bounds.max[k] : bounds.min[k];
      const Eigen::Vector4f clip = projection.projection * projection.view * point.homogeneous();
      const bool ahead = clip.w() > 1e-6f * std::abs(clip.z());  // a corner behind the eye may be seen anywhere
      const Eigen::Array2f ndc = ahead ? Eigen::Array2f(clip.head<2>() / clip.w()) : Eigen::Array2f::Zero();
      low = low.min(ahead ? ndc : Eigen::Array2f(-1, -1));
      high = high.max(ahead ? ndc : Eigen::Array2f(1, 1));
    }
  };
  for (const SurfaceLayer& layer : panel.surfaces)
    if (layer.style.opacity >= 1) add(bounds_of(frame.surfaces[layer.surface].vertices, frame.surfaces[layer.surface].thickness));
  for (const ParticleLayer& layer : panel.particles)
    add(bounds_of(frame.particles[layer.set].positions, section_reach * frame.particles[layer.set].radius));
  for (const int mark : panel.marks) add(bounds_of({frame.marks[mark].position}, frame.marks[mark].radius));
  if (low.x() > high.x()) return {};
  const Eigen::Array2f size(static_cast<float>(projection.width), static_cast<float>(projection.height));
  // Two pixels round it, as far as the picture goes.
  const Eigen::Array2f from = (size * (0.5f * low + 0.5f) - 2).max(0.0f).min(size),
                       to = (size * (0.5f * high + 0.5f) + 2).max(0.0f).min(size);
  PixelBox box{static_cast<int>(from.x()), static_cast<int>(from.y()), 0, 0};
  box.width = static_cast<int>(std::ceil(to.x())) - box.x;
  box.height = static_cast<int>(std::ceil(to.y())) - box.y;
  return box;
}

constexpr float occlusion_reach = 0.03f;  // of the visible height: how far a thing darkens its surroundings

}  // namespace

struct PanelPainter::Parts {
  ParticlePainter particles;
  SurfacePainter surfaces;
  GlassPainter glass;
  LinePainter lines;
  SectionPainter sections;
  SkinCache skins;
  Program occlusion = make_program("screen.vert", "occlusion.frag"), blur = make_program("screen.vert", "blur.frag"),
          background = make_program("screen.vert", "background.frag"), light = make_program("screen.vert", "light.frag"),
          resolve = make_program("screen.vert", "resolve.frag");
  VertexArray screen = make_vertex_array();
  Targets targets;

  void draw_opaque(const Frame& frame, const Panel& panel, const Projection& projection);
  void draw_occlusion(const Projection& projection, const PixelBox& box, float reach);
  void draw_light(const Frame& frame, const Projection& projection, const PixelBox& box, bool occlusion_on);
  void draw_lines(const Frame& frame, const Panel& panel, const Projection& projection);
  void draw_glass(const Frame& frame, const Panel& panel, const Projection& projection);
  void draw_resolved(const DrawSettings& settings);
};

PanelPainter::PanelPainter() : parts_(std::make_unique<Parts>()) {}
PanelPainter::~PanelPainter() = default;

void PanelPainter::Parts::draw_opaque(const Frame& frame, const Panel& panel, const Projection& projection) {
  glBindFramebuffer(GL_FRAMEBUFFER, targets.opaque);
  glViewport(0, 0, projection.width, projection.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glClearColor(0, 0, 0, 0);
  glClearDepth(1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  for (const SurfaceLayer& layer : panel.surfaces)
    if (layer.style.opacity >= 1)
      surfaces.draw(skins.drawn(frame.surfaces[layer.surface], layer.style.field, projection.pixels_per_metre),
                    scale_of(frame, layer.style), layer.style.color, projection, clip_of(panel, layer.style));
  const Outline outline = panel.clip ? cut_outline(frame, panel, skins) : Outline();
  for (const ParticleLayer& layer : panel.particles) {
    const auto clip = clip_of(panel, layer.style);
    // Behind a cut face within a wall, seen square on, nothing of the body itself shows but balls that stick out of the wall.
    const bool face_alone = layer.section && clip && !outline.empty() && clip->normal.dot(panel.camera.backward.normalized()) > 0.95f;
    if (!face_alone)
      particles.draw(visible_spheres(frame.particles[layer.set], layer.style, scale_of(frame, layer.style), clip, layer.shape), layer.shape,
                     projection, clip);
    if (layer.section && clip)
      sections.draw(frame.particles[layer.set], layer.style, scale_of(frame, layer.style), *clip, outline, projection, targets.opaque);
  }
  std::vector<Sphere> balls;
  for (const int index : panel.marks) {
    const Mark& mark = frame.marks[index];
    const auto byte = [](float part) { return static_cast<std::uint8_t>(255 * std::clamp(part, 0.0f, 1.0f) + 0.5f); };
    if (mark.radius > 0)
      balls.push_back({mark.position, mark.radius, {byte(mark.color[0]), byte(mark.color[1]), byte(mark.color[2]), 255}});
  }
  particles.draw(balls, ParticleShape::sphere, projection, std::nullopt);
}

void PanelPainter::Parts::draw_occlusion(const Projection& projection, const PixelBox& box, float reach) {
  glBindFramebuffer(GL_FRAMEBUFFER, targets.occluded);
  glViewport(0, 0, (projection.width + 1) / 2, (projection.height + 1) / 2);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x / 2 - 3, box.y / 2 - 3, box.width / 2 + 8, box.height / 2 + 8);  // and what the blur reads round it
  glUseProgram(occlusion);
  set(occlusion, "depth", targets.depth, 0);
  set(occlusion, "normals", targets.normals, 1);
  set(occlusion, "albedo", targets.albedo, 2);
  set_uniforms(occlusion, projection);
  set(occlusion, "size", Eigen::Vector2f(static_cast<float>(projection.width), static_cast<float>(projection.height)));
  set(occlusion, "near", projection.near);
  set(occlusion, "far", projection.far);
  set(occlusion, "radius", reach);
  // Orthographic: pixels a metre everywhere; perspective: at one metre before the eye.
  set(occlusion, "pixels_per_metre", 0.5f * static_cast<float>(projection.height) * projection.projection(1, 1));
  draw_screen(screen);
  glBindFramebuffer(GL_FRAMEBUFFER, targets.blurred);
  glUseProgram(blur);
  set(blur, "occlusion", targets.occlusion, 0);
  draw_screen(screen);
  glDisable(GL_SCISSOR_TEST);
}

void PanelPainter::Parts::draw_light(const Frame& frame, const Projection& projection, const PixelBox& box, bool occlusion_on) {
  glBindFramebuffer(GL_FRAMEBUFFER, targets.lit);
  glViewport(0, 0, projection.width, projection.height);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(background);
  set(background, "size", Eigen::Vector2f(static_cast<float>(projection.width), static_cast<float>(projection.height)));
  set(background, "background_top", frame.background_top);
  set(background, "background_bottom", frame.background_bottom);
  draw_screen(screen);
  glEnable(GL_SCISSOR_TEST);
  glScissor(box.x, box.y, box.width, box.height);
  glUseProgram(light);
  set(light, "albedo", targets.albedo, 0);
  set(light, "normals", targets.normals, 1);
  set(light, "occlusion", targets.open_sky, 2);
  set(light, "occlusion_on", static_cast<int>(occlusion_on));
  draw_screen(screen);
  glDisable(GL_SCISSOR_TEST);
  glEnable(GL_DEPTH_TEST);
}

void PanelPainter::Parts::draw_lines(const Frame& frame, const Panel& panel, const Projection& projection) {
  const float at_1080 = static_cast<float>(projection.height) / 1080;  // widths scale with the picture
  const auto width = [&](float pixels) { return std::max(pixels * at_1080, 1.2f * static_cast<float>(targets.scale)); };
  const float lift = 4 / projection.pixels_per_metre;
  using Depth = LinePainter::Depth;
  for (const SurfaceLayer& layer : panel.surfaces) {
    const Surface& surface = frame.surfaces[layer.surface];
    const Color dark = 0.35f * layer.style.color;
    if (layer.rim)
      lines.draw(segments(left_by(clip_of(panel, layer.style), skins.rim(surface, projection.pixels_per_metre)), dark), width(2), lift,
                 Depth::hidden, projection);
    if (layer.section && panel.clip) {
      const DrawnMesh& middle = skins.middle(surface, projection.pixels_per_metre);
      const auto cut = section(middle.positions, middle.triangles, *panel.clip);
      const float thick = surface.thickness * projection.pixels_per_metre;  // the cut skin: its own colour within a dark edge
      lines.draw(segments(cut, dark), thick + width(3), lift, Depth::hidden, projection);
      if (thick > 2) lines.draw(segments(cut, layer.style.color), thick, 1.5f * lift, Depth::over, projection);
    }
  }
  for (const LineLayer& layer : panel.lines) {
    const float pixels = layer.metres > 0 ? layer.metres * projection.pixels_per_metre : width(layer.pixels);
    lines.draw(segments(frame.lines[layer.line], layer.style, scale_of(frame, layer.style)), pixels, lift,
               layer.on_top ? Depth::on_top : Depth::hidden, projection);
  }
}

void PanelPainter::Parts::draw_glass(const Frame& frame, const Panel& panel, const Projection& projection) {
  Glass all;
  for (const SurfaceLayer& layer : panel.surfaces)
    if (layer.style.opacity < 1)
      all.add(skins.drawn(frame.surfaces[layer.surface], layer.style.field, projection.pixels_per_metre), layer.style,
              scale_of(frame, layer.style));
  glass.draw(all, projection, panel.clip);
}

void PanelPainter::Parts::draw_resolved(const DrawSettings& settings) {
  glBindFramebuffer(GL_FRAMEBUFFER, targets.resolved);
  glViewport(0, 0, targets.width, targets.height);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(resolve);
  set(resolve, "drawn", targets.drawn, 0);
  set(resolve, "scale", targets.scale);
  set(resolve, "smooth_edges", static_cast<int>(settings.smooth_edges));
  draw_screen(screen);
}

Bounds panel_bounds(const Frame& frame, const Panel& panel) {
  Bounds bounds;
  for (const ParticleLayer& layer : panel.particles)
    bounds.add(bounds_of(frame.particles[layer.set].positions, frame.particles[layer.set].radius));
  for (const SurfaceLayer& layer : panel.surfaces)
    bounds.add(bounds_of(frame.surfaces[layer.surface].vertices, frame.surfaces[layer.surface].thickness));
  for (const LineLayer& layer : panel.lines) bounds.add(bounds_of(frame.lines[layer.line].points, 0.5f * layer.metres));
  for (const int mark : panel.marks) bounds.add(frame.marks[mark].position, frame.marks[mark].radius);
  return bounds;
}

Projection panel_projection(const Frame& frame, const Panel& panel, int width, int height, int reserved_right) {
  return project(panel.camera, width, height, panel_bounds(frame, panel), reserved_right);
}

Image PanelPainter::draw(const Frame& frame, const Panel& panel, int width, int height, int reserved_right, const DrawSettings& settings,
                         long* drawn_pixels) {
  const int scale = std::clamp(settings.supersampling, 1, 4);
  Targets& targets = parts_->targets;
  if (targets.width != width || targets.height != height || targets.scale != scale) targets = make_targets(width, height, scale);
  const Projection projection = panel_projection(frame, panel, width * scale, height * scale, reserved_right * scale);
  parts_->draw_opaque(frame, panel, projection);
  const PixelBox box = opaque_box(frame, panel, projection);
  const float visible_height = static_cast<float>(projection.height) / projection.pixels_per_metre;
  if (settings.ambient_occlusion) parts_->draw_occlusion(projection, box, occlusion_reach * visible_height);
  parts_->draw_light(frame, projection, box, settings.ambient_occlusion);
  parts_->draw_lines(frame, panel, projection);
  parts_->draw_glass(frame, panel, projection);
  if (scale > 1 || settings.smooth_edges) parts_->draw_resolved(settings);  // else the lit picture is read as it is

  std::vector<std::uint8_t> upside_down(4 * static_cast<std::size_t>(width) * height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
  if (const GLenum error = glGetError(); error != GL_NO_ERROR)
    throw std::runtime_error("the OpenGL driver failed while drawing (error " + std::to_string(error) + ")");
  Image image(width, height);
  long count = 0;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* from = &upside_down[4 * static_cast<std::size_t>(height - 1 - y) * width];
    std::uint8_t* to = image.at(0, y);
    for (int x = 0; x < width; ++x) {
      count += from[4 * x + 3] != 0;
      to[4 * x] = from[4 * x];
      to[4 * x + 1] = from[4 * x + 1];
      to[4 * x + 2] = from[4 * x + 2];
      to[4 * x + 3] = 255;
    }
  }
  if (drawn_pixels) *drawn_pixels = count;
  return image;
}

}  // namespace render
