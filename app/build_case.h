// From a scene file to what the solver takes: particles placed, regions resolved into rows, everything checked.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/scene_file.h"
#include "geometry/triangle_mesh.h"
#include "sim/scene_description.h"

namespace app {

template <int D>
struct BuiltCase {
  sim::SceneDescription<D> description;
  std::vector<std::string> warnings;
  geometry::TriangleMesh lumen;  // m; a patient's blood vessel as it is simulated, for drawing; else empty
  double placement_seconds = 0;
};

// The particles of a scene before materials, loads and ports are given to them: the dear part of building a case (import, mesh, template,
// placement). Scenes that differ in nothing that places particles (replay.h) can share it.
struct CaseParticles;
std::shared_ptr<const CaseParticles> place_case(const SceneFile& scene);

// Throws SceneError (one line, with file and key) on overlapping bodies, a body outside the domain, too many particles, a region without
// particles, an elastic body that nothing holds in a static scene.
template <int D>
BuiltCase<D> build_case(const SceneFile& scene);
template <int D>
BuiltCase<D> build_case(const SceneFile& scene, const CaseParticles& placed);

// Bytes that a run of so many particles takes, about.
std::int64_t estimated_memory(std::int64_t particles, int dimension);

}  // namespace app
