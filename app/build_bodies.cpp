// Places the bodies of a scene made of shapes.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "app/build_case.h"
#include "app/case_parts.h"
#include "app/to_geometry.h"
#include "geometry/place_particles.h"

namespace app {
namespace {

std::string count_text(double value) {
  std::ostringstream stream;
  stream.precision(3);
  stream << value;
  return stream.str();
}

std::string point_text(const Eigen::Vector3d& x, int dimension) {
  std::ostringstream stream;
  stream.precision(4);
  stream << "(" << x[0] << ", " << x[1];
  if (dimension == 3) stream << ", " << x[2];
  stream << ")";
  return stream.str();
}

void check_inside_domain(const SceneFile& scene, const BodySpec& body, const geometry::Shape& shape) {
  if (!scene.domain.present) return;
  const geometry::BoundingBox box = geometry::bounding_box(shape, scene.dimension);
  const double slack = 1e-6 * scene.spacing;
  for (int axis = 0; axis < scene.dimension; ++axis)
    if (box.min[axis] < scene.domain.min[axis] - slack || box.max[axis] > scene.domain.max[axis] + slack)
      refuse(body.shape.spot, "reaches out of the domain along " + std::string(1, "xyz"[axis]), "make [domain] larger or the body smaller");
}

void check_counts(const SceneFile& scene, const std::vector<geometry::PlacedBody>& bodies, const geometry::PlacementOptions& options) {
  double total = 0, coarser = 1;
  for (geometry::PlacementOptions tried = options;; coarser *= 100) {  // far too small a spacing: counted at a larger one
    tried.spacing = options.spacing * coarser;
    total = 0;
    for (std::int64_t count : geometry::estimate_particle_counts(bodies, tried)) total += static_cast<double>(count);
    if (total < 1e12) break;
  }
  total *= std::pow(coarser, scene.dimension);
  const auto fits = [&](double allowed) { return count_text(scene.spacing * std::pow(total / allowed, 1.0 / scene.dimension) * 1.01); };
  if (total > static_cast<double>(scene.limits.particles))
    refuse(scene.spacing_spot,
           "makes about " + count_text(total) + " particles, more than limits.particles = " + std::to_string(scene.limits.particles),
           "a spacing of " + fits(static_cast<double>(scene.limits.particles)) + " would fit");
  const double bytes = static_cast<double>(estimated_memory(static_cast<std::int64_t>(total), scene.dimension));
  const double program = static_cast<double>(estimated_memory(0, scene.dimension)), allowed = static_cast<double>(scene.limits.memory);
  if (scene.limits.memory == 0 || bytes <= allowed) return;
  if (allowed <= program)
    refuse(scene.spacing_spot, "needs about " + count_text(bytes) + " bytes, more than limits.memory",
           "give it more than the " + count_text(program) + " bytes of the program itself");
  refuse(scene.spacing_spot, "needs about " + count_text(bytes) + " bytes, more than limits.memory",
         "a spacing of " + fits(total * (allowed - program) / (bytes - program)) + " would fit");
}

// Before its particles are made: those of a thin box.
void check_thin_box(const SceneFile& scene, const BodySpec& body, int thin) {
  double total = 1;
  for (int axis = 0; axis < scene.dimension; ++axis)
    if (axis != thin) total *= std::max(1.0, (body.shape.max[axis] - body.shape.min[axis]) / scene.spacing);
  const double allowed = static_cast<double>(scene.limits.particles);
  if (total > allowed)
    refuse(scene.spacing_spot,
           "makes about " + count_text(total) + " particles, more than limits.particles = " + std::to_string(scene.limits.particles),
           "a spacing of " + count_text(scene.spacing * std::pow(total / allowed, 1.0 / (scene.dimension - 1)) * 1.01) + " would fit");
}

// A sheet's faces lie half its thickness beside its particles: neither may lie in another solid. (Blood is cut out around particles.)
void check_shell_overlap(const SceneFile& scene, const BodyParticles& shell, const std::vector<geometry::PlacedBody>& placed) {
  for (const geometry::PlacedBody& other : placed)
    for (std::size_t k = 0; k < shell.size(); ++k)
      for (const double side : {-0.5, 0.0, 0.5}) {
        if (side != 0 && other.matter != geometry::Matter::elastic) continue;
        const Eigen::Vector3d x = shell.position[k] + side * shell.thickness * shell.normal[k];
        if (geometry::signed_distance(other.shape, x, scene.dimension) < -0.02 * scene.spacing)
          refuse(scene.bodies[shell.source].shape.spot, "overlaps body \"" + other.name + "\" at " + point_text(x, scene.dimension),
                 "subtract one from the other");
      }
}

geometry::Matter matter_of(sim::Kind kind) {
  return kind == sim::Kind::fluid ? geometry::Matter::fluid : kind == sim::Kind::wall ? geometry::Matter::wall : geometry::Matter::elastic;
}

BodyParticles from_set(const geometry::ParticleSet& set, const BodySpec& body, int source) {
  BodyParticles result;
  result.source = source, result.name = body.name, result.kind = body.kind;
  result.position = set.position, result.volume = set.volume, result.normal = set.normal, result.depth = set.depth;
  result.surface_area = set.surface_area, result.surface = set.surface;
  if (body.kind == sim::Kind::elastic) result.fibre.assign(set.size(), Eigen::Vector3d::UnitX());
  return result;
}

}  // namespace

std::int64_t estimated_memory(std::int64_t particles, int dimension) { return particles * (dimension == 2 ? 1200 : 3600) + 60'000'000; }

CaseParticles place_bodies(const SceneFile& scene) {
  CaseParticles result;
  result.bodies.resize(scene.bodies.size());
  std::vector<geometry::PlacedBody> placed;
  std::vector<int> source;
  geometry::PlacementOptions options;
  options.dimension = scene.dimension;
  options.spacing = scene.spacing;
  options.periodic = scene.domain.periodic;
  options.domain_min = scene.domain.min;
  options.domain_max = scene.domain.max;
  options.particle_limit = scene.limits.particles;
  std::vector<int> shells;
  for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i) {
    const BodySpec& body = scene.bodies[i];
    if (body.shape.type == ShapeType::patient) refuse(body.shape.spot, "type \"patient\" belongs to [patient]", "use another shape");
    const int thin = body.kind == sim::Kind::elastic ? thin_axis(body.shape, scene.dimension, scene.spacing) : -1;
    if (body.shape.type == ShapeType::shell || thin >= 0) {
      if (body.kind != sim::Kind::elastic)
        refuse(body.shape.spot, "only an elastic body can be a shell", "set kind = \"elastic\", or use a solid shape");
      if (thin >= 0) check_thin_box(scene, body, thin);
      result.bodies[i] = thin >= 0 ? box_shell(body, i, scene.dimension, scene.spacing, thin) : surface_shell(body, i, scene.spacing);
      if (thin >= 0) check_inside_domain(scene, body, to_geometry(body.shape, scene.dimension, scene.spacing));
      if (result.bodies[i].size() == 0) refuse(body.shape.spot, "holds no particle", "make the spacing smaller");
      shells.push_back(i);
      continue;
    }
    placed.push_back({body.name, matter_of(body.kind), to_geometry(body.shape, scene.dimension, scene.spacing)});
    source.push_back(i);
    try {
      geometry::check_shape(placed.back().shape, scene.dimension, "shape");
    } catch (const std::exception& error) {
      refuse(body.shape.spot, error.what());
    }
    check_inside_domain(scene, body, placed.back().shape);
  }
  check_counts(scene, placed, options);
  for (int i : shells) {
    const BodyParticles& shell = result.bodies[i];
    check_shell_overlap(scene, shell, placed);
    for (std::size_t k = 0; k < shell.size(); ++k) {  // a shell particle fills a whole lattice cell of the blood
      options.obstacle_position.push_back(shell.position[k]);
      options.obstacle_volume.push_back(shell.volume[k] * scene.spacing);
    }
  }
  if (placed.empty()) return result;
  geometry::Placement placement;
  try {
    placement = geometry::place_particles(placed, options);
  } catch (const std::exception& error) {
    refuse({scene.path.string(), 0, "body"}, error.what());
  }
  for (std::size_t k = 0; k < placed.size(); ++k)
    result.bodies[source[k]] = from_set(placement.bodies[k], scene.bodies[source[k]], source[k]);
  result.warnings = placement.warnings;
  result.seconds = placement.seconds;
  return result;
}

}  // namespace app
