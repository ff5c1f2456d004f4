// A made-up root with three sinuses, leaflets and blood: what the pixel tests and the bench draw. No simulation.
#pragma once

#include <cmath>

#include "render/frame.h"

namespace render::example {

inline constexpr float pi = 3.14159265f;

// Wall radius at angle and height (m): 12 mm, with three sinuses of 4 mm between heights 0 and 20 mm.
inline float wall_radius(float angle, float height) {
  const float bulge = height > 0 && height < 0.020f ? std::pow(std::sin(pi * height / 0.020f), 2.0f) : 0.0f;
  return 0.012f + 0.004f * bulge * (0.6f + 0.4f * std::cos(3 * angle));
}

inline Surface aorta(int around = 96, int along = 90) {
  Surface surface;
  surface.name = "aorta";
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i < around; ++i) {
      const float angle = 2 * pi * static_cast<float>(i) / static_cast<float>(around);
      const float height = -0.012f + 0.048f * static_cast<float>(j) / static_cast<float>(along);
      const float radius = wall_radius(angle, height);
      surface.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      surface.triangles.push_back({a, b, b + around});
      surface.triangles.push_back({a, b + around, a + around});
    }
  return surface;
}

// One leaflet of three; opening 0 (free edges meet at the axis) ... 1 (against the wall). Field 0: a stress that grows towards the
// attachment.
inline Surface leaflet(int number, float opening, int columns = 24, int rows = 14) {
  Surface surface;
  surface.name = "leaflet " + std::to_string(number + 1);
  surface.thickness = 0.5e-3f;
  surface.smoothing = 1;
  surface.fields.resize(1);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const float t = 2 * static_cast<float>(i) / static_cast<float>(columns) - 1, s = static_cast<float>(j) / static_cast<float>(rows);
      const float angle = 2 * pi * static_cast<float>(number) / 3 + t * pi / 3;
      const float base = 0.014f * t * t, radius = wall_radius(angle, base);
      const Eigen::Vector3f attachment(radius * std::cos(angle), radius * std::sin(angle), base);
      const float reach = opening * 0.010f + (1 - opening) * 0.012f * std::abs(t);
      const float lean = 2 * pi * static_cast<float>(number) / 3 + (t < 0 ? -1 : 1) * pi / 3;
      const Eigen::Vector3f closed(reach * std::cos(lean), reach * std::sin(lean), 0.010f + 0.004f * t * t);
      const Eigen::Vector3f open(0.0105f * std::cos(angle), 0.0105f * std::sin(angle), 0.015f);
      const Eigen::Vector3f edge = opening * open + (1 - opening) * closed;
      Eigen::Vector3f point = attachment + s * (edge - attachment);
      point.z() -= 0.004f * (1 - opening) * std::sin(pi * s) * (1 - t * t);
      surface.vertices.push_back(point);
      surface.fields[0].push_back(3e5f * (1 - 0.8f * s) * (0.5f + 0.5f * t * t));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      surface.triangles.push_back({a, b, d});
      surface.triangles.push_back({a, d, c});
    }
  return surface;
}

// Blood within the wall on a cubic lattice. Field 0: pressure, 1: speed.
inline ParticleSet blood(float spacing) {
  ParticleSet set;
  set.name = "blood";
  set.radius = 0.62f * spacing;
  set.fields.resize(2);
  for (float z = -0.012f; z < 0.036f; z += spacing)
    for (float y = -0.017f; y < 0.017f; y += spacing)
      for (float x = -0.017f; x < 0.017f; x += spacing) {
        const float radius = std::hypot(x, y);
        if (radius > wall_radius(std::atan2(y, x), z) - spacing) continue;
        const auto noise = [&](int k) {
          return 0.2f * spacing * std::sin(12.9898f * static_cast<float>(set.positions.size()) + 78.2f * static_cast<float>(k));
        };
        set.positions.emplace_back(x + noise(0), y + noise(1), z + noise(2));
        set.fields[0].push_back(16000 - 200000 * z);
        set.fields[1].push_back(1.2f * std::max(0.0f, 1 - radius * radius / (0.011f * 0.011f)));
      }
  return set;
}

// The paper's Fig. 8 pair: pressure of the blood, cut open; stress on the valve.
inline Frame valve_frame(float opening = 0.6f, float spacing = 0.9e-3f) {
  Frame frame;
  frame.title = "Synthetic patient, baseline";
  frame.subtitle = "leaflets 1.0 MPa, 0.5 mm, fibre-reinforced \u00b7 spacing 0.9 mm \u00b7 accurate scheme";
  frame.time = 0.2134;
  frame.readouts = {"LV 16.1 kPa (121 mmHg)", "aorta 13.2 kPa (99 mmHg)"};
  frame.warnings = {"stress above the linear law's validity at 12 particles"};
  frame.scales = {{"Pressure of the blood", "kPa", 1e-3, 8000, 20000, Colormap::viridis},
                  {"Stress on the valve (von Mises)", "kPa", 1e-3, 0, 3e5, Colormap::inferno}};
  frame.particles = {blood(spacing)};
  frame.surfaces = {aorta(), leaflet(0, opening), leaflet(1, opening), leaflet(2, opening)};
  const Eigen::Vector3f axis = Eigen::Vector3f::UnitZ(), side = Eigen::Vector3f::UnitY();
  const std::vector<Direction> directions = {{"to aorta", axis, Color(0.75f, 0.15f, 0.15f)},
                                             {"x", Eigen::Vector3f::UnitX(), Color(0.2f, 0.3f, 0.7f)},
                                             {"y", Eigen::Vector3f::UnitY(), Color(0.1f, 0.5f, 0.3f)}};
  Panel pressure;
  pressure.title = "Pressure of the blood";
  pressure.camera = standard_camera(StandardView::long_axis, {0, 0, 0.012f}, axis, side, 0.036f, 0.052f);
  pressure.clip = ClipPlane{{0, 0, 0.012f}, pressure.camera.backward};
  pressure.particles = {{0, {0, 0}, ParticleShape::sphere, true}};
  pressure.surfaces = {{0, {-1, -1, Color(0.85f, 0.55f, 0.5f), 0.3f}, false, true}};
  for (int k = 1; k <= 3; ++k) pressure.surfaces.push_back({k, {-1, -1, Color(0.95f, 0.9f, 0.8f), 1, true}, false, true});
  pressure.legends = {0};
  pressure.directions = directions;
  Panel stress;
  stress.title = "Stress on the valve, seen from the aorta";
  stress.camera = standard_camera(StandardView::from_aorta, {0, 0, 0.010f}, axis, side, 0.036f, 0.034f);
  stress.clip = ClipPlane{{0, 0, 0.019f}, axis};
  stress.surfaces = {{0, {-1, -1, Color(0.85f, 0.55f, 0.5f), 0.25f}, false, true}};
  for (int k = 1; k <= 3; ++k) stress.surfaces.push_back({k, {0, 1}, true});
  stress.legends = {1};
  stress.directions = directions;
  frame.panels = {pressure, stress};
  Plot plot{"Pressure", "mmHg", {{"left ventricle", Color(0.75f, 0.15f, 0.15f), {}, {}}, {"aorta", Color(0.1f, 0.3f, 0.65f), {}, {}}}};
  for (int i = 0; i <= 160; ++i) {
    const double t = 0.005 * i;
    for (Curve& curve : plot.curves) curve.time.push_back(t);
    plot.curves[0].value.push_back(t < 0.35 ? 6 + 115 * std::pow(std::sin(3.14159 * t / 0.35), 2) : 6);
    plot.curves[1].value.push_back(80 + 38 * (t > 0.1 ? (t - 0.1) / 0.15 * std::exp(1 - (t - 0.1) / 0.15) : 0));
  }
  frame.plots = {plot};
  return frame;
}

}  // namespace render::example
