// Pieces of build_case: sets of particles before they are put in rows. Internal to app/build_*.cpp.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/scene_file.h"
#include "geometry/surface_shares.h"
#include "geometry/triangle_mesh.h"

namespace app {

// One body's particles, three-dimensional whatever the scene (z = 0 in 2-D).
struct BodyParticles {
  int source = -1;  // index into SceneFile::bodies
  std::string name;
  sim::Kind kind = sim::Kind::fluid;
  double thickness = 0;  // m, shells
  std::vector<Eigen::Vector3d> position, normal, surface_area, fibre;
  std::vector<double> volume, depth;
  std::vector<geometry::SurfaceShare> surface;        // solids off the lattice (geometry/place_particles.h)
  std::vector<std::uint8_t> held;                     // 1: attached to the wall by construction (leaflets)
  std::vector<std::array<std::int32_t, 3>> elements;  // shells: triangles; in 2-D the first two make a segment
  std::size_t size() const { return position.size(); }
};

struct CaseParticles {
  std::vector<BodyParticles> bodies;
  std::vector<std::string> warnings;
  geometry::TriangleMesh lumen;
  std::optional<sim::ValveFrame> valve;
  std::vector<sim::Port<3>> ports;  // of a patient: where the ends are, by name
  double seconds = 0;
};

// A thin elastic box as one layer of particles in its mid-plane.
BodyParticles box_shell(const BodySpec& body, int source, int dimension, double spacing, int thin);
// A surface mesh as one layer of particles.
BodyParticles surface_shell(const BodySpec& body, int source, double spacing);
CaseParticles place_bodies(const SceneFile& scene);
CaseParticles place_patient(const SceneFile& scene);
// The pressure or Windkessel of a patient's port that the user left to the built-in beat.
void set_patient_wave(const PatientSpec& patient, sim::Port<3>& port);

}  // namespace app
