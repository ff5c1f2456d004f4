// Fills bodies with particles. Straight, axis-aligned bodies get cell-centred lattices that fit them exactly; where surfaces are curved
// one lattice is shared out by sign and then relaxed until particles follow the true surface (design note "geometry", section 3).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "geometry/shape.h"
#include "geometry/surface_shares.h"

namespace geometry {

enum class Matter { fluid, wall, elastic };

struct PlacedBody {
  std::string name;
  Matter matter = Matter::fluid;
  Shape shape;
};

// What one body's particles are; every array has one row a particle. In 2-D z is 0, volumes are m² and areas m.
struct ParticleSet {
  std::vector<Eigen::Vector3d> position;  // m
  std::vector<double> volume;             // m³; sums to the body's true volume
  std::vector<Eigen::Vector3d> normal;    // wall: unit, from the wall to where fluid can be, at the nearest exposed surface point; else 0
  std::vector<double> depth;              // m, >= 0; wall: below that point; elastic: below the body's surface; fluid: 0
  std::vector<Eigen::Vector3d> surface_area;  // m²; elastic: outward vector area of the body's surface this particle carries; sums to 0
  std::vector<SurfaceShare> surface;  // elastic, where particles were moved off the lattice: the surface in shares, particle by particle
  std::size_t size() const { return position.size(); }
};

struct PlacementOptions {
  int dimension = 3;
  double spacing = 0;  // l0, m
  // Periodic directions run from domain_min to domain_max; elsewhere these are not used.
  std::array<bool, 3> periodic{};
  Eigen::Vector3d domain_min = Eigen::Vector3d::Zero(), domain_max = Eigen::Vector3d::Zero();
  std::int64_t particle_limit = 5'000'000;
  int relaxation_sweeps = 60;
  // Wall particles deeper than this below the exposed surface are left out (m; infinite = keep the wall as given).
  double wall_depth_limit = std::numeric_limits<double>::infinity();
  // Particles placed beforehand (a valve's leaflets): fluid and walls keep off them, and give up their volume. Positions m, volumes m³.
  std::vector<Eigen::Vector3d> obstacle_position;
  std::vector<double> obstacle_volume;
  double obstacle_clearance = 0.7;  // in l0: no fluid or wall centre nearer to an obstacle
};

struct Placement {
  std::vector<ParticleSet> bodies;  // in the order given
  std::vector<std::string> warnings;
  std::size_t relaxed = 0;  // particles that were moved off the lattice
  double seconds = 0;
};

// About how many particles each body will have (its volume over l0^D); cheap.
std::vector<std::int64_t> estimate_particle_counts(const std::vector<PlacedBody>& bodies, const PlacementOptions& options);

// Throws std::invalid_argument with one clear line where two bodies overlap by more than touching (both names and a point), where a body
// gets no particle, where a shape cannot be, or where there would be more than `particle_limit` particles.
// Deterministic, whatever the number of threads.
Placement place_particles(const std::vector<PlacedBody>& bodies, const PlacementOptions& options);

// How even a set of particles is: for each listed row, sum_j V_j W(r_ij) with a Wendland C2 kernel of support 2.4 l0, over the same sum on
// the full lattice (1 = even); and the distance to its nearest neighbour, m.
struct Evenness {
  std::vector<double> density, nearest;
};
Evenness measure_evenness(const std::vector<Eigen::Vector3d>& position, const std::vector<double>& volume, int dimension, double spacing,
                          const PlacementOptions* periodic_domain = nullptr);

}  // namespace geometry
