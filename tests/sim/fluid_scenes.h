// Small fluid scenes for tests, built by hand: no files, no shapes.
#pragma once

#include <cmath>
#include <string>

#include "sim/scene_description.h"

namespace sim::testing {

// Adds bodies and particles one by one.
template <int D>
struct FluidScene {
  SceneDescription<D> description;

  void start_body(const std::string& name, Kind kind) {
    Body body;
    body.name = name;
    body.kind = kind;
    body.first = static_cast<std::int64_t>(description.particles.size());
    description.bodies.push_back(body);
  }
  void add(const Vector<D>& x, const Vector<D>& v = Vector<D>::Zero(), const Vector<D>& normal = Vector<D>::Zero(), double depth = 0) {
    auto& p = description.particles;
    Body& body = description.bodies.back();
    p.position.push_back(x);
    p.velocity.push_back(v);
    p.kind.push_back(body.kind);
    p.body.push_back(static_cast<std::int32_t>(description.bodies.size()) - 1);
    p.volume.push_back(std::pow(description.spacing, D));
    p.normal.push_back(normal);
    p.depth.push_back(depth);
    p.surface_area.push_back(Vector<D>::Zero());
    p.fixed.push_back(0);
    p.stiffness_scale.push_back(1);
    p.fibre.push_back(Vector<D>::Zero());
    ++body.count;
  }
};

// An open tank, `across` particles wide and `high` high, of four wall layers; water fills `filled` columns from the left to `deep` rows.
inline FluidScene<2> tank(double spacing, int across, int high, int filled, int deep) {
  FluidScene<2> scene;
  scene.description.spacing = spacing;
  scene.start_body("tank", Kind::wall);
  for (int j = -4; j < high; ++j)
    for (int i = -4; i < across + 4; ++i) {
      if (i >= 0 && i < across && j >= 0) continue;
      const Vector<2> x((i + 0.5) * spacing, (j + 0.5) * spacing);
      const Vector<2> below(i < 0 ? -x[0] : i >= across ? across * spacing - x[0] : 0, j < 0 ? -x[1] : 0);
      scene.add(x, Vector<2>::Zero(), below.normalized(), below.norm());
    }
  scene.start_body("water", Kind::fluid);
  scene.description.bodies.back().fluid = {1000, Newtonian{1e-3}};
  for (int j = 0; j < deep; ++j)
    for (int i = 0; i < filled; ++i) scene.add({(i + 0.5) * spacing, (j + 0.5) * spacing});
  scene.description.gravity = Vector<2>(0, -9.81);
  return scene;
}

// Blood between plates at y = -half and y = half, `across` particles wide and `along` long from x = 0; the plates go on for `beyond` more
// particles at both ends.
inline FluidScene<2> plates(double half, int across, int along, int beyond, const FluidMaterial& blood) {
  FluidScene<2> scene;
  const double spacing = 2 * half / across;
  scene.description.spacing = spacing;
  scene.start_body("plates", Kind::wall);
  for (int j = -4; j < across + 4; ++j)
    for (int i = -beyond; i < along + beyond; ++i) {
      if (j >= 0 && j < across) continue;
      const double y = -half + (j + 0.5) * spacing;
      scene.add({(i + 0.5) * spacing, y}, Vector<2>::Zero(), {0, j < 0 ? 1.0 : -1.0}, std::abs(y) - half);
    }
  scene.start_body("blood", Kind::fluid);
  scene.description.bodies.back().fluid = blood;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i) scene.add({(i + 0.5) * spacing, -half + (j + 0.5) * spacing});
  return scene;
}

// Blood between plates, periodic along x, driven by a pressure gradient G (Pa/m) as a body force.
inline FluidScene<2> channel(double half, int across, const FluidMaterial& blood, double gradient) {
  FluidScene<2> scene = plates(half, across, across, 0, blood);
  scene.description.domain = {true, {0, -1}, {across * scene.description.spacing, 1}, {true, false}};
  Load<2> drive;
  drive.body = 1;
  const double acceleration = gradient / blood.density;
  drive.acceleration = [acceleration](const Vector<2>&, double) { return Vector<2>(acceleration, 0); };
  scene.description.loads.push_back(drive);
  return scene;
}

}  // namespace sim::testing
