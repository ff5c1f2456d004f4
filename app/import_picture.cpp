#include "app/import_picture.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/renderer.h"
#include "render/skin.h"

namespace app {
namespace {

// Okabe & Ito's palette: told apart with every common colour blindness.
const std::vector<render::Color> end_colors = {{0.84f, 0.37f, 0.00f}, {0.00f, 0.45f, 0.70f}, {0.00f, 0.62f, 0.45f}, {0.80f, 0.47f, 0.65f},
                                               {0.90f, 0.62f, 0.00f}, {0.34f, 0.71f, 0.91f}, {0.60f, 0.55f, 0.10f}};
const render::Color vessel(0.86f, 0.58f, 0.53f), tissue(0.95f, 0.91f, 0.82f), annulus_color(0.70f, 0.10f, 0.10f),
    sinus_color(0.45f, 0.25f, 0.60f), junction_color(0.10f, 0.30f, 0.65f), commissure_color(0.95f, 0.75f, 0.10f),
    line_color(0.25f, 0.28f, 0.32f), defect_color(0.85f, 0.0f, 0.0f);

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", 1e3 * metres);
  return text;
}

render::Color end_color(std::size_t end) { return end_colors[end % end_colors.size()]; }

// The triangles of the lumen for which `cap` is the open end's index (-1: the wall).
render::Surface part(const geometry::ImportResult& imported, std::int32_t cap, const std::string& name) {
  render::Surface surface;
  surface.name = name;
  for (const Eigen::Vector3d& v : imported.lumen.vertices) surface.vertices.push_back(v.cast<float>());
  for (std::size_t t = 0; t < imported.lumen.triangles.size(); ++t)
    if ((t < imported.cap_of_triangle.size() ? imported.cap_of_triangle[t] : -1) == cap)
      surface.triangles.push_back(imported.lumen.triangles[t]);
  return surface;
}

// The wall's contour in the plane of a ring; a circle where the plane cuts no closed contour.
render::Line ring(const geometry::ImportResult& imported, const geometry::RootPlane& plane, const std::string& name) {
  render::Line line;
  line.name = name;
  line.closed = true;
  for (const Eigen::Vector3d& p : geometry::section_around(imported.lumen, plane.center, plane.normal).contour)
    line.points.push_back(p.cast<float>());
  if (!line.points.empty()) return line;
  const Eigen::Vector3d across = plane.normal.unitOrthogonal(), up = plane.normal.cross(across);
  for (int i = 0; i < 72; ++i) {
    const double angle = 2 * 3.14159265358979 * i / 72;
    line.points.push_back((plane.center + 0.5 * plane.mean_diameter * (std::cos(angle) * across + std::sin(angle) * up)).cast<float>());
  }
  return line;
}

// The direction along which the mesh is thinnest, and the one along which it is longest.
struct Axes {
  Eigen::Vector3f thin, along;
};
Axes principal_axes(const geometry::TriangleMesh& mesh) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : mesh.vertices) mean += v / static_cast<double>(mesh.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& v : mesh.vertices) spread += (v - mean) * (v - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  return {solver.eigenvectors().col(0).cast<float>(), solver.eigenvectors().col(2).cast<float>()};
}

// Largest extent of the points along a direction.
float extent(const render::Surface& surface, const Eigen::Vector3f& direction) {
  float low = 1e30f, high = -1e30f;
  for (const Eigen::Vector3f& v : surface.vertices) {
    low = std::min(low, direction.dot(v));
    high = std::max(high, direction.dot(v));
  }
  return high - low;
}

void add_ends(render::Frame& frame, const geometry::ImportResult& imported) {
  for (std::size_t k = 0; k < imported.open_ends.size(); ++k) {
    const geometry::OpenEnd& end = imported.open_ends[k];
    frame.surfaces.push_back(part(imported, static_cast<std::int32_t>(k), end.name));
    frame.marks.push_back({(end.center + 0.8 * end.radius * end.normal).cast<float>(), 0,
                           end.name + ", " + millimetres(2 * end.radius) + " mm", end_color(k)});
  }
}

// Rings, commissures and centreline: lines and marks of the root, from the given mark on.
void add_root(render::Frame& frame, const geometry::ImportResult& imported) {
  const geometry::AorticRoot& root = *imported.root;
  frame.lines.push_back(ring(imported, root.annulus, "annulus"));
  frame.lines.push_back(ring(imported, root.sinuses, "sinuses"));
  frame.lines.push_back(ring(imported, root.sinotubular_junction, "sinotubular junction"));
  const auto radius = static_cast<float>(0.04 * root.annulus.mean_diameter);
  for (int k = 0; k < 3; ++k) frame.marks.push_back({root.commissures[k].cast<float>(), radius, "", commissure_color});
  for (int k = 0; k < 3; ++k) frame.marks.push_back({root.nadirs[k].cast<float>(), 0.7f * radius, "", annulus_color});
}

std::string plane_text(const char* name, const geometry::RootPlane& plane) {
  return std::string(name) + " " + millimetres(plane.largest_diameter) + " × " + millimetres(plane.perpendicular_diameter) + " mm";
}

render::Panel whole_panel(const render::Frame& frame, const geometry::ImportResult& imported, const Eigen::Vector3f& backward,
                          const Eigen::Vector3f& up) {
  render::Panel panel;
  panel.camera.backward = backward;
  panel.camera.up = up;
  render::Bounds bounds;
  for (const Eigen::Vector3f& v : frame.surfaces[0].vertices) bounds.add(v);
  panel.camera.target = bounds.center();
  panel.camera.width = 1.25f * extent(frame.surfaces[0], up.cross(backward).normalized());
  panel.camera.height = 1.2f * extent(frame.surfaces[0], up);
  // In the middle of what is seen, not of the box.
  const Eigen::Vector3f right = up.cross(backward).normalized();
  for (const Eigen::Vector3f& axis : {right, up}) {
    float low = 1e30f, high = -1e30f;
    for (const Eigen::Vector3f& v : frame.surfaces[0].vertices) {
      low = std::min(low, axis.dot(v));
      high = std::max(high, axis.dot(v));
    }
    panel.camera.target += axis * (0.5f * (low + high) - axis.dot(panel.camera.target));
  }
  panel.surfaces = {{0, {-1, -1, vessel, 0.28f}}};
  for (std::size_t k = 0; k < imported.open_ends.size(); ++k) {
    panel.surfaces.push_back({static_cast<int>(k) + 1, {-1, -1, end_color(k), 0.85f}});
    panel.marks.push_back(static_cast<int>(k));
  }
  panel.directions = {{"x", Eigen::Vector3f::UnitX(), line_color},
                      {"y", Eigen::Vector3f::UnitY(), line_color},
                      {"z", Eigen::Vector3f::UnitZ(), line_color}};
  return panel;
}

void add_root_layers(render::Panel& panel, int first_line, int first_leaflet, int leaflets, int first_mark) {
  const render::Color colors[3] = {annulus_color, sinus_color, junction_color};
  for (int k = 0; k < 3; ++k) panel.lines.push_back({first_line + k, {-1, -1, colors[k]}, 5, 0, true});
  for (int k = 0; k < leaflets; ++k) panel.surfaces.push_back({first_leaflet + k, {-1, -1, tissue, 1, false}, true});
  for (int k = 0; k < 6; ++k) panel.marks.push_back(first_mark + k);
}

// The root from the side, opened towards the eye, and from the aorta.
void add_root_panels(render::Frame& frame, const geometry::ImportResult& imported, int first_line, int first_leaflet, int leaflets,
                     int first_mark) {
  const geometry::AorticRoot& root = *imported.root;
  const Eigen::Vector3f annulus = root.annulus.center.cast<float>(), junction = root.sinotubular_junction.center.cast<float>();
  const Eigen::Vector3f axis = (junction - annulus).normalized(), middle = 0.5f * (annulus + junction);
  const auto width = static_cast<float>(root.sinuses.largest_diameter);
  const int near_wall = static_cast<int>(frame.surfaces.size());
  frame.surfaces.push_back(render::cut_away(frame.surfaces[0], {annulus - 0.25f * width * axis, -axis}));  // not the ventricle below it
  const Eigen::Vector3f toward = root.nadirs[0].cast<float>() - annulus;
  for (const bool along : {true, false}) {
    const auto view = along ? render::StandardView::long_axis : render::StandardView::from_aorta;
    const Eigen::Vector3f side = along ? Eigen::Vector3f(axis.cross(toward)) : Eigen::Vector3f(-toward.cross(axis));
    render::Panel panel;
    panel.title = along ? "The root from the side, cut open" : "The root from the aorta";
    panel.camera = render::standard_camera(view, middle, axis, side, 1.25f * width,
                                           along ? 1.7f * (junction - annulus).norm() + 0.3f * width : 1.25f * width);
    const Eigen::Vector3f above = junction + 0.1f * width * axis;
    panel.clip = along ? render::ClipPlane{middle, panel.camera.backward} : render::ClipPlane{above, axis};
    panel.surfaces = {{along ? 0 : near_wall, {-1, -1, vessel, along ? 0.45f : 0.28f}, false, true}};
    add_root_layers(panel, first_line, first_leaflet, leaflets, first_mark);
    if (along) {
      for (const auto& [plane, name, color] :
           {std::tuple{&root.annulus, "annulus", annulus_color}, std::tuple{&root.sinuses, "sinuses", sinus_color},
            std::tuple{&root.sinotubular_junction, "sinotubular junction", junction_color}}) {
        panel.marks.push_back(static_cast<int>(frame.marks.size()));
        const Eigen::Vector3f right = axis.cross(panel.camera.backward);
        frame.marks.push_back({plane->center.cast<float>() + 0.3f * width * right, 0, plane_text(name, *plane), color});
      }
    }
    panel.directions = {{"to aorta", axis, annulus_color}};
    frame.panels.push_back(panel);
  }
}

void add_words(render::Frame& frame, const geometry::ImportResult& imported) {
  const auto slash = imported.file.find_last_of('/');
  frame.title = "Import of " + (slash == std::string::npos ? imported.file : imported.file.substr(slash + 1));
  const Eigen::Vector3d size = imported.box_max - imported.box_min;
  frame.subtitle = std::to_string(imported.triangles_in) + " triangles in, " + std::to_string(imported.triangles_out) + " out  ·  " +
                   millimetres(size.x()) + " × " + millimetres(size.y()) + " × " + millimetres(size.z()) + " mm  ·  units " +
                   imported.units + (imported.units_proposed ? " (proposed from the size)" : "");
  for (const geometry::Defect& defect : imported.defects) {
    std::string kind = defect.kind;
    std::replace(kind.begin(), kind.end(), '_', ' ');
    frame.readouts.push_back(std::to_string(defect.count) + " " + kind + (defect.repaired ? " mended" : " LEFT"));
  }
  if (frame.readouts.empty()) frame.readouts = {"no defects"};
  if (!imported.root)
    frame.warnings.push_back((imported.root_reason.rfind("no root", 0) == 0 ? "" : "no aortic root: ") + imported.root_reason);
  if (imported.root && imported.root->built) frame.warnings.push_back("the root was built, not found");
  for (const std::string& warning : imported.warnings)
    if (frame.warnings.size() < 2) frame.warnings.push_back(warning);
}

}  // namespace

render::Frame import_frame(const geometry::ImportResult& imported, const std::vector<geometry::TriangleMesh>& leaflets) {
  render::Frame frame;
  add_words(frame, imported);
  frame.surfaces.push_back(part(imported, -1, "wall"));
  add_ends(frame, imported);
  const int first_leaflet = static_cast<int>(frame.surfaces.size()), first_root_mark = static_cast<int>(frame.marks.size());
  for (const geometry::TriangleMesh& leaflet : leaflets) {
    render::Surface surface;
    surface.name = "leaflet";
    for (const Eigen::Vector3d& v : leaflet.vertices) surface.vertices.push_back(v.cast<float>());
    surface.triangles = leaflet.triangles;
    surface.thickness = 0.5e-3f;
    frame.surfaces.push_back(std::move(surface));
  }
  render::Line centreline;
  centreline.name = "centreline";
  for (const Eigen::Vector3d& p : imported.centreline.points) centreline.points.push_back(p.cast<float>());
  frame.lines.push_back(centreline);
  if (imported.root) add_root(frame, imported);
  std::vector<int> defects;
  for (const geometry::Defect& defect : imported.defects)
    if (!defect.repaired) {
      defects.push_back(static_cast<int>(frame.marks.size()));
      frame.marks.push_back(
          {defect.at.cast<float>(), 0.008f * extent(frame.surfaces[0], Eigen::Vector3f::UnitZ()), defect.kind, defect_color});
    }

  Axes axes = principal_axes(imported.lumen);
  if (imported.root) {  // upright: from the ventricle to the aorta
    const Eigen::Vector3f axis = (imported.root->sinotubular_junction.center - imported.root->annulus.center).cast<float>();
    if (axes.along.dot(axis) < 0) axes.along = -axes.along;
  } else if (axes.along.z() < 0) {
    axes.along = -axes.along;
  }
  std::vector<render::Panel> whole = {whole_panel(frame, imported, axes.thin, axes.along)};
  whole[0].title = "What was understood";
  if (!imported.root) {
    whole.push_back(whole_panel(frame, imported, axes.along.cross(axes.thin).normalized(), axes.along));
    whole[1].title = "The same from the side";
  }
  for (render::Panel& panel : whole) {
    if (centreline.points.size() > 1) panel.lines.push_back({0, {-1, -1, line_color}, 2.5f, 0, true});
    if (imported.root) add_root_layers(panel, 1, first_leaflet, static_cast<int>(leaflets.size()), first_root_mark);
    panel.marks.insert(panel.marks.end(), defects.begin(), defects.end());
    frame.panels.push_back(panel);
  }
  if (imported.root) add_root_panels(frame, imported, 1, first_leaflet, static_cast<int>(leaflets.size()), first_root_mark);
  return frame;
}

void write_import_picture(const geometry::ImportResult& imported, const std::vector<geometry::TriangleMesh>& leaflets,
                          const std::filesystem::path& file) {
  render::Renderer renderer;
  render::PictureSettings settings;
  settings.draw.supersampling = 2;
  render::write_png(renderer.draw(import_frame(imported, leaflets), settings), file.string());
}

}  // namespace app
