// Small shell scenes for the tests: beams (2-D) and sheets (3-D), cell-centred particles, regular or jittered.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "sim/shell.h"

namespace shell_scenes {

template <int D>
void append(sim::SceneDescription<D>& scene, const sim::Vector<D>& x, const sim::Vector<D>& normal, double area, bool fixed,
            const sim::Vector<D>& fibre = sim::Vector<D>::Zero()) {
  auto& p = scene.particles;
  p.position.push_back(x);
  p.velocity.push_back(sim::Vector<D>::Zero());
  p.kind.push_back(sim::Kind::shell);
  p.body.push_back(static_cast<std::int32_t>(scene.bodies.size()));
  p.volume.push_back(area);
  p.normal.push_back(normal);
  p.depth.push_back(0);
  p.surface_area.push_back(sim::Vector<D>::Zero());
  p.fixed.push_back(fixed ? (1 << D) - 1 : 0);
  p.stiffness_scale.push_back(1);
  p.fibre.push_back(fibre);
}

template <int D>
void close_body(sim::SceneDescription<D>& scene, const sim::ElasticMaterial& material, const std::string& name = "sheet") {
  sim::Body body;
  body.name = name;
  body.kind = sim::Kind::shell;
  body.elastic = material;
  body.first = scene.bodies.empty() ? 0 : scene.bodies.back().first + scene.bodies.back().count;
  body.count = static_cast<std::int64_t>(scene.particles.size()) - body.first;
  scene.bodies.push_back(body);
}

inline sim::ElasticMaterial tissue(double nu = 0.49, double thickness = 0.5e-3, sim::ElasticLaw law = sim::ElasticLaw::neo_hookean) {
  sim::ElasticMaterial material;
  material.density = 1060;
  material.law = law;
  material.youngs_modulus = 1e6;
  material.poisson_ratio = nu;
  material.thickness = thickness;
  return material;
}

// Beam along x from the clamp's face at 0 to `length`, `held` fixed particles behind the face.
inline sim::SceneDescription<2> beam(double length, double spacing, int held, const sim::ElasticMaterial& material,
                                     bool both_ends = false) {
  sim::SceneDescription<2> scene;
  scene.spacing = spacing;
  const int count = static_cast<int>(std::lround(length / spacing)), behind = both_ends ? held : 0;
  for (int i = -held; i < count + behind; ++i) append<2>(scene, {(i + 0.5) * spacing, 0}, {0, 1}, spacing, i < 0 || i >= count);
  close_body(scene, material, "beam");
  return scene;
}

// Sheet [0, length] x [0, width] in the plane z = 0, fixed for x < 0; jitter in units of the spacing, in the plane.
inline sim::SceneDescription<3> strip(double length, double width, double spacing, int held, const sim::ElasticMaterial& material,
                                      double jitter = 0, const Eigen::Vector3d& fibre = Eigen::Vector3d::Zero()) {
  sim::SceneDescription<3> scene;
  scene.spacing = spacing;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-jitter * spacing, jitter * spacing);
  const int count = static_cast<int>(std::lround(length / spacing)), across = static_cast<int>(std::lround(width / spacing));
  for (int i = -held; i < count; ++i)
    for (int j = 0; j < across; ++j) {
      const double dx = shift(random), dy = shift(random);
      append<3>(scene, {(i + 0.5) * spacing + dx, (j + 0.5) * spacing + dy, 0}, {0, 0, 1}, spacing * spacing, i < 0, fibre);
    }
  close_body(scene, material, "strip");
  return scene;
}

// Disc of concentric rings, free within `radius`, one held ring outside; no lattice anywhere.
inline sim::SceneDescription<3> disc(double radius, double spacing, const sim::ElasticMaterial& material) {
  sim::SceneDescription<3> scene;
  scene.spacing = spacing;
  const int rings = static_cast<int>(std::lround(radius / spacing));
  for (int k = 0; k <= rings; ++k) {
    const double r = (k + 0.5) * spacing;
    const int count = std::max(3, static_cast<int>(std::lround(2 * M_PI * r / spacing)));
    for (int j = 0; j < count; ++j) {
      const double angle = 2 * M_PI * (j + 0.37 * k) / count;
      append<3>(scene, {r * std::cos(angle), r * std::sin(angle), 0}, {0, 0, 1}, 2 * M_PI * r * spacing / count, k == rings);
    }
  }
  close_body(scene, material, "disc");
  return scene;
}

// Tube about z, normals outward, each ring turned against the last and jittered along the surface; nothing held but z.
inline sim::SceneDescription<3> tube(double radius, double length, double spacing, double jitter, const sim::ElasticMaterial& material) {
  sim::SceneDescription<3> scene;
  scene.spacing = spacing;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> shift(-jitter * spacing, jitter * spacing);
  const int rings = static_cast<int>(std::lround(length / spacing)), count = static_cast<int>(std::lround(2 * M_PI * radius / spacing));
  for (int k = 0; k < rings; ++k)
    for (int j = 0; j < count; ++j) {
      const double angle = 2 * M_PI * (j + 0.3 * k) / count + shift(random) / radius;
      append<3>(scene, {radius * std::cos(angle), radius * std::sin(angle), (k + 0.5) * spacing + shift(random)},
                {std::cos(angle), std::sin(angle), 0}, 2 * M_PI * radius / count * spacing, false);
    }
  close_body(scene, material, "tube");
  return scene;
}

// Sphere by the golden spiral, normals outward.
inline sim::SceneDescription<3> sphere(double radius, int count, const sim::ElasticMaterial& material) {
  sim::SceneDescription<3> scene;
  scene.spacing = std::sqrt(4 * M_PI * radius * radius / count);
  for (int k = 0; k < count; ++k) {
    const double z = 1 - 2 * (k + 0.5) / count, r = std::sqrt(1 - z * z), angle = k * M_PI * (3 - std::sqrt(5.0));
    const Eigen::Vector3d n(r * std::cos(angle), r * std::sin(angle), z);
    append<3>(scene, radius * n, n, 4 * M_PI * radius * radius / count, false);
  }
  close_body(scene, material, "sphere");
  return scene;
}

// Pressure against the + side on all rows, following the surface.
template <int D>
sim::ShellLoad<D> follower_pressure(const sim::ShellElasticity<D>& shells, double pressure) {
  return [&shells, pressure](std::span<const sim::Vector<D>> position, std::span<sim::Vector<D>> force) {
    std::vector<sim::Vector<D>> normal(shells.size());
    std::vector<double> area(shells.size());
    sim::shell_normals_and_areas<D>(shells, position, normal, area);
    for (std::size_t i = 0; i < shells.size(); ++i) force[i] -= pressure * area[i] * normal[i];
  };
}

// Dead force (per width in 3-D) on the end face at x = length: on the last two columns, weighted so that its resultant acts at the face.
template <int D>
sim::ShellLoad<D> end_force(const sim::ShellElasticity<D>& shells, double length, double spacing, const sim::Vector<D>& total) {
  return [&shells, length, spacing, total](std::span<const sim::Vector<D>>, std::span<sim::Vector<D>> force) {
    double last = 0, before = 0;
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t i = 0; i < shells.size(); ++i) {
        const double x = shells.rest_position[i].x();
        if (x <= length - 2 * spacing) continue;
        const bool end = x > length - spacing;
        if (pass == 0) {
          (end ? last : before) += shells.area[i];
        } else {
          force[i] += total * (shells.area[i] * (end ? 1.5 / last : -0.5 / before));
        }
      }
  };
}

// Mean displacement of the end face at x = length, extrapolated from the last two columns.
template <int D>
sim::Vector<D> end_displacement(const sim::ShellElasticity<D>& shells, std::span<const sim::Vector<D>> position, double length,
                                double spacing) {
  sim::Vector<D> last = sim::Vector<D>::Zero(), before = last;
  double last_area = 0, before_area = 0;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    const double x = shells.rest_position[i].x();
    if (x <= length - 2 * spacing) continue;
    const bool end = x > length - spacing;
    (end ? last : before) += shells.area[i] * (position[i] - shells.rest_position[i]);
    (end ? last_area : before_area) += shells.area[i];
  }
  return 1.5 * last / last_area - 0.5 * before / before_area;
}

}  // namespace shell_scenes
