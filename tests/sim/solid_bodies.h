// Elastic bodies for tests: boxes, rings and spheres of particles as a scene would hold them.
#pragma once

#include <cmath>
#include <functional>

#include "sim/scene_description.h"

namespace solid_bodies {

using sim::Vector;

template <int D>
sim::SceneDescription<D> empty_scene(double spacing, const sim::ElasticMaterial& material) {
  sim::SceneDescription<D> scene;
  scene.spacing = spacing;
  scene.gravity.reset();
  sim::Body body;
  body.name = "solid";
  body.kind = sim::Kind::elastic;
  body.elastic = material;
  scene.bodies.push_back(body);
  return scene;
}

template <int D>
void add_particle(sim::SceneDescription<D>& scene, const Vector<D>& x, double volume, std::uint8_t fixed, const Vector<D>& area,
                  double depth) {
  auto& p = scene.particles;
  p.position.push_back(x);
  p.velocity.push_back(Vector<D>::Zero());
  p.kind.push_back(sim::Kind::elastic);
  p.body.push_back(static_cast<std::int32_t>(scene.bodies.size()) - 1);
  p.volume.push_back(volume);
  p.normal.push_back(Vector<D>::Zero());
  p.depth.push_back(depth);
  p.surface_area.push_back(area);
  p.fixed.push_back(fixed);
  p.stiffness_scale.push_back(1);
  p.fibre.push_back(Vector<D>::Zero());
  ++scene.bodies.back().count;
}

// A lattice box from min to max (multiples of the spacing); fixed(x) gives the axes held there.
template <int D>
sim::SceneDescription<D> box(const Vector<D>& min, const Vector<D>& max, double spacing, const sim::ElasticMaterial& material,
                             const std::function<std::uint8_t(const Vector<D>&)>& fixed) {
  auto scene = empty_scene<D>(spacing, material);
  std::array<int, D> count;
  for (int k = 0; k < D; ++k) count[k] = static_cast<int>(std::lround((max(k) - min(k)) / spacing));
  std::array<int, D> index{};
  while (index[D - 1] < count[D - 1]) {
    Vector<D> x, area = Vector<D>::Zero();
    double depth = 1e300;
    for (int k = 0; k < D; ++k) {
      x(k) = min(k) + (index[k] + 0.5) * spacing;
      if (index[k] == 0) area(k) -= std::pow(spacing, D - 1);
      if (index[k] == count[k] - 1) area(k) += std::pow(spacing, D - 1);
      depth = std::min({depth, x(k) - min(k), max(k) - x(k)});
    }
    add_particle<D>(scene, x, std::pow(spacing, D), fixed(x), area, depth);
    for (int k = 0; k < D; ++k) {
      if (++index[k] < count[k] || k == D - 1) break;
      index[k] = 0;
    }
  }
  return scene;
}

// Rows of the particles for which a condition holds, with equal shares.
template <int D>
sim::Load<D> load_on(const sim::SceneDescription<D>& scene, const std::function<bool(const Vector<D>&)>& where) {
  sim::Load<D> load;
  load.body = 0;
  for (std::size_t i = 0; i < scene.particles.size(); ++i)
    if (where(scene.particles.position[i])) load.rows.push_back(static_cast<std::int64_t>(i));
  load.share.assign(load.rows.size(), 1.0 / static_cast<double>(load.rows.size()));
  return load;
}

}  // namespace solid_bodies
