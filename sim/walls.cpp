#include "sim/walls.h"

#include <Eigen/Geometry>

#include "sim/time_table.h"

namespace sim {
namespace {

template <int D>
bool moves(const Motion<D>& motion) {
  for (const auto& table : motion.velocity)
    if (!table.value.empty()) return true;
  return !motion.angular_velocity.value.empty();
}

// How far the wall has slid since the start, and where its centre of rotation is.
template <int D>
Vector<D> slide(const Motion<D>& motion, double time) {
  Vector<D> way = Vector<D>::Zero();
  for (int k = 0; k < D; ++k) way[k] = integral(motion.velocity[k], time);
  return way;
}

// Velocity of a wall's point x at a time, its centre of rotation being where it is then.
template <int D>
Vector<D> wall_velocity(const Motion<D>& motion, const Vector<D>& center, const Vector<D>& x, double time) {
  Vector<D> v = Vector<D>::Zero();
  for (int k = 0; k < D; ++k)
    if (!motion.velocity[k].value.empty()) v[k] = motion.velocity[k].at(time);
  if (motion.angular_velocity.value.empty()) return v;
  const double omega = motion.angular_velocity.at(time);
  const Vector<D> r = x - center;
  if constexpr (D == 2)
    v += omega * Vector<2>(-r[1], r[0]);
  else
    v += omega * motion.axis.normalized().cross(r);
  return v;
}

template <int D>
Tensor<D> turn(double angle, const Eigen::Vector3d& axis) {
  if constexpr (D == 2)
    return Eigen::Rotation2Dd(angle).toRotationMatrix();
  else
    return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace

template <int D>
void move_walls(const Scene<D>& scene, State<D>& state, double dt) {
  for (const auto& motion : scene.description.motions) {
    if (!moves(motion)) continue;
    const Body& body = scene.description.bodies[motion.body];
    const Vector<D> before = motion.center + slide(motion, state.time), after = motion.center + slide(motion, state.time + dt);
    const bool turns = !motion.angular_velocity.value.empty();
    Tensor<D> rotation = Tensor<D>::Identity();
    if (turns)
      rotation = turn<D>(integral(motion.angular_velocity, state.time + dt) - integral(motion.angular_velocity, state.time), motion.axis);
    for (std::int64_t i = body.first; i < body.first + body.count; ++i) {
      state.position[i] = after + rotation * (state.position[i] - before);
      if (scene.space.any && !turns) state.position[i] = scene.space.wrapped(state.position[i]);
      state.velocity[i] = wall_velocity<D>(motion, after, state.position[i], state.time + dt);
    }
  }
}

template <int D>
void boundary_surfaces(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) {
  const InitialParticles<D>& particles = scene.description.particles;
  const std::size_t first = static_cast<std::size_t>(scene.first_fluid);
  work.boundary_normal.assign(particles.normal.begin(), particles.normal.begin() + static_cast<std::ptrdiff_t>(first));
  work.boundary_velocity.assign(state.velocity.begin(), state.velocity.begin() + static_cast<std::ptrdiff_t>(first));
  work.boundary_curvature = scene.curvature;
  if (!scene.solid_normal.empty()) {  // carried along by the deformation: n = cof(F) n0
    const auto solids = static_cast<std::size_t>(scene.elastic_count);
    solid_derivatives<D>(*scene.solids, std::span(state.position).first(solids), work.solid_motion.work);
    for (std::size_t b = 0; b < solids; ++b) {
      const Tensor<D> gradient = Tensor<D>::Identity() + work.solid_motion.work.derivatives[b].template leftCols<D>();
      const Vector<D> normal = cofactor<D>(gradient) * scene.solid_normal[b];
      work.boundary_normal[b] = normal.squaredNorm() > 0 ? Vector<D>(normal.normalized()) : scene.solid_normal[b];
    }
  }
  if (scene.shells) {
    std::vector<double> area(static_cast<std::size_t>(scene.shell_count));
    const auto first_shell = static_cast<std::size_t>(scene.elastic_count), shells = area.size();
    shell_normals_and_areas<D>(*scene.shells, std::span(state.position).subspan(first_shell, shells),
                               std::span(work.boundary_normal).subspan(first_shell, shells), area);
  }
  for (const auto& motion : scene.description.motions) {
    const Body& body = scene.description.bodies[motion.body];
    if (!motion.angular_velocity.value.empty() && body.count > 1) {
      // Normals turn with the wall, and its surface, not its particles' centres, is what drags.
      const Tensor<D> rotation = turn<D>(integral(motion.angular_velocity, state.time), motion.axis);
      const Vector<D> center = motion.center + slide(motion, state.time);
      for (std::int64_t i = body.first; i < body.first + body.count; ++i) {
        work.boundary_normal[i] = rotation * particles.normal[i];
        if (!scene.curvature.empty()) work.boundary_curvature[i] = rotation * scene.curvature[i] * rotation.transpose();
        work.boundary_velocity[i] +=
            wall_velocity<D>(motion, center, state.position[i] + particles.depth[i] * work.boundary_normal[i], state.time) -
            wall_velocity<D>(motion, center, state.position[i], state.time);
      }
    }
    for (std::int64_t i = body.first; i < body.first + body.count; ++i) work.boundary_velocity[i] += motion.surface_velocity;
  }
}

template <int D>
std::vector<double> far_faces(const Scene<D>& scene) {
  const InitialParticles<D>& particles = scene.description.particles;
  const std::size_t n = static_cast<std::size_t>(scene.first_fluid);
  std::vector<double> result(n, 0);
  if (scene.wall_count == 0) return result;
  std::vector<Search> search(n, Search::none);
  std::vector<std::uint8_t> is_fluid(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (particles.kind[i] == Kind::wall) search[i] = Search::all;
  Neighbors neighbors;
  CellGrid<D> grid;
  find_neighbors<D>(neighbors, grid, std::span(particles.position).first(n), search, is_fluid, scene.description.domain,
                    1.5 * scene.lattice.radius);
  const double beside = 0.75 * scene.lattice.spacing;
#pragma omp parallel for schedule(dynamic, 256)
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i)
    for (std::int32_t j : neighbors.of(static_cast<std::size_t>(i))) {
      if (particles.kind[j] != Kind::wall || particles.normal[i].dot(particles.normal[j]) > -0.7) continue;
      const Vector<D> face =
          scene.space.difference(particles.position[i], particles.position[j]) + particles.depth[j] * particles.normal[j];
      const double away = -face.dot(particles.normal[i]);
      if (away <= 0 || (face + away * particles.normal[i]).norm() > beside) continue;
      if (result[i] == 0 || away < result[i]) result[i] = away;
    }
  return result;
}

#define INSTANTIATE(D)                                          \
  template std::vector<double> far_faces(const Scene<D>&);      \
  template void move_walls(const Scene<D>&, State<D>&, double); \
  template void boundary_surfaces(const Scene<D>&, const State<D>&, Workspace<D>&);
INSTANTIATE(2)
INSTANTIATE(3)
#undef INSTANTIATE

}  // namespace sim
