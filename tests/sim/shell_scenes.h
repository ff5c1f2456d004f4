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
inline sim::SceneDescription<2> beam(double length, double spacing, int held, const sim::ElasticMaterial& material, bool both_ends = false) {
  sim::SceneDescription<2> scene;
  scene.spacing = spacing;
  const int count = static_cast<int>(std::lround(length / spacing)), behind = both_ends ? held : 0;
  for (int i = -held; i < count + behind; ++i)
    append<2>(scene, {(i + 0.5) * spacing, 0}, {0, 1}, spacing, i < 0 || i >= count);
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

template <int D>
sim::ShellLoad<D> no_load() {
  return [](std::span<const sim::Vector<D>>, std::span<sim::Vector<D>>) {};
}

}  // namespace shell_scenes
