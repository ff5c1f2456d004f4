#include "geometry/place_valve_case.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>

#include "geometry/leak_path.h"
#include "geometry/point_grid.h"

namespace geometry {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// The lattice's z along the first port's normal: there the lattice runs undisturbed up to the port's plane.
Matrix3d lattice_rotation(const std::vector<DomainPort>& ports) {
  if (ports.empty()) throw std::invalid_argument("a valve case needs its ventricle and aorta ports");
  return Eigen::Quaterniond::FromTwoVectors(ports[0].normal, -Vector3d::UnitZ()).toRotationMatrix();
}

std::vector<PlacedBody> lumen_bodies(std::shared_ptr<const TriangleMesh> lumen, const std::vector<DomainPort>& ports,
                                     const ValveCaseOptions& options) {
  const double thickness = options.wall_layers * options.spacing;
  const Shape inside = mesh_shape(std::move(lumen), options.spacing, thickness + 2.5 * options.spacing);
  Shape wall = inside;
  wall.grow = thickness;
  wall.subtract.push_back(inside);
  for (const DomainPort& port : ports) {  // open at the ports: only beyond the plane and near it, the vessel may turn back
    const double reach = thickness + 3 * options.spacing;
    wall.subtract.push_back(cylinder_shape(port.point, port.point + reach * port.normal, port.radius + reach));
  }
  return {{"blood", Matter::fluid, inside}, {"aorta", Matter::wall, wall}};
}

struct Everything {
  std::vector<Vector3d> position;
  std::vector<double> volume;
};

// Fluid first, wall, then leaflets with the thickness of one spacing.
Everything collect(const ValveCase& result, double spacing) {
  Everything all;
  for (const ParticleSet* set : {&result.fluid, &result.wall}) {
    all.position.insert(all.position.end(), set->position.begin(), set->position.end());
    all.volume.insert(all.volume.end(), set->volume.begin(), set->volume.end());
  }
  for (const SurfaceParticles& leaflet : result.leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i) {
      all.position.push_back(leaflet.position[i]);
      all.volume.push_back(leaflet.area[i] * spacing);
    }
  return all;
}

void measure(ValveCase& result, const std::vector<PlacedBody>& bodies, const std::vector<DomainPort>& ports, double spacing) {
  const Everything all = collect(result, spacing);
  const Evenness even = measure_evenness(all.position, all.volume, 3, spacing);
  std::vector<Vector3d> leaflet_points;
  for (const SurfaceParticles& leaflet : result.leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i)
      if (!leaflet.embedded[i]) leaflet_points.push_back(leaflet.position[i]);
  const PointGrid leaflets(leaflet_points, 1.5 * spacing);
  double sum = 0, square = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.fluid.size(); ++i) {
    const Vector3d& at = all.position[i];
    bool by_port = false;
    for (const DomainPort& port : ports)
      by_port |= std::abs((at - port.point).dot(port.normal)) < 3 * spacing && (at - port.point).norm() < port.radius + 3 * spacing;
    bool interface = signed_distance(bodies[0].shape, at, 3) > -1.2 * spacing;
    leaflets.for_each_near(at, [&](std::size_t, const Vector3d&, double) { interface = true; });
    if (by_port || !interface) continue;
    sum += even.density[i];
    square += even.density[i] * even.density[i];
    ++count;
  }
  result.fluid_density_mean = count ? sum / count : 1;
  result.fluid_density_deviation = count ? std::sqrt(std::max(0.0, square / count - std::pow(sum / count, 2))) : 0;
  result.nearest = 1;
  for (std::size_t i = 0; i < result.fluid.size() + result.wall.size(); ++i)
    result.nearest = std::min(result.nearest, even.nearest[i] / spacing);
}

// Points that stitch each leaflet's free edge to its neighbours', so that only other ways past the valve are left.
void stitch_free_edges(const std::vector<SurfaceParticles>& leaflets, double spacing, std::vector<Vector3d>& points) {
  std::vector<std::vector<Vector3d>> edges;
  for (const SurfaceParticles& leaflet : leaflets) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> count;
    for (const auto& t : leaflet.triangles)
      for (int k = 0; k < 3; ++k) ++count[std::minmax(t[k], t[(k + 1) % 3])];
    std::vector<std::uint8_t> border(leaflet.size(), 0);
    for (const auto& [edge, times] : count)
      if (times == 1) border[edge.first] = border[edge.second] = 1;
    edges.emplace_back();
    for (std::size_t i = 0; i < leaflet.size(); ++i)
      if (border[i] && !leaflet.embedded[i]) edges.back().push_back(leaflet.position[i]);
  }
  for (std::size_t a = 0; a < edges.size(); ++a)
    for (const Vector3d& p : edges[a]) {
      std::vector<Vector3d> across;  // the nearest point of each other edge, nearest first
      for (std::size_t b = 0; b < edges.size(); ++b)
        if (a != b && !edges[b].empty())
          across.push_back(*std::min_element(edges[b].begin(), edges[b].end(), [&](const Vector3d& q, const Vector3d& r) {
            return (q - p).squaredNorm() < (r - p).squaredNorm();
          }));
      std::sort(across.begin(), across.end(),
                [&](const Vector3d& q, const Vector3d& r) { return (q - p).squaredNorm() < (r - p).squaredNorm(); });
      if (across.empty()) continue;
      // A line to the nearest; near the middle, where three edges meet, the triangle between them.
      const Vector3d one = across[0] - p;
      const bool middle = across.size() > 1 && (across[1] - p).norm() < 2 * one.norm() + 2 * spacing;
      const Vector3d two = middle ? Vector3d(across[1] - p) : Vector3d::Zero();
      const int parts = int(std::ceil(std::max(one.norm(), two.norm()) / (0.4 * spacing)));
      for (int i = 0; i <= parts; ++i)
        for (int j = 0; j <= (middle ? parts - i : 0); ++j) points.push_back(p + one * i / parts + two * j / parts);
    }
}

double leak_clearance(const ValveCase& result, const Shape& lumen, const std::vector<DomainPort>& ports, double spacing,
                      Vector3d* narrowest) {
  std::vector<Vector3d> solids = result.wall.position;
  Vector3d low = Vector3d::Constant(1e300), high = -low, flow = Vector3d::Zero();
  for (const SurfaceParticles& leaflet : result.leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i) {
      solids.push_back(leaflet.position[i]);
      if (leaflet.embedded[i]) continue;
      low = low.cwiseMin(leaflet.position[i]);
      high = high.cwiseMax(leaflet.position[i]);
      flow += leaflet.area[i] * leaflet.normal[i];
    }
  stitch_free_edges(result.leaflets, spacing, solids);
  if (ports.size() > 1 && flow.dot(ports[1].point - ports[0].point) < 0) flow = -flow;
  flow.normalize();
  double bottom = 1e300, top = -1e300;
  for (const SurfaceParticles& leaflet : result.leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i) {
      if (leaflet.embedded[i]) continue;
      bottom = std::min(bottom, leaflet.position[i].dot(flow));
      top = std::max(top, leaflet.position[i].dot(flow));
    }
  LeakSearch search;
  search.min = low.array() - 3 * spacing;
  search.max = high.array() + 3 * spacing;
  search.step = 0.25 * spacing;
  search.largest = 1.5 * spacing;
  search.open = [&](const Vector3d& at) { return signed_distance(lumen, at, 3) < 0; };
  search.side = [&](const Vector3d& at) { return at.dot(flow) < bottom - spacing ? 1 : at.dot(flow) > top + spacing ? 2 : 0; };
  return widest_path(solids, search, narrowest) / spacing;
}

void rotate(ParticleSet& set, const Matrix3d& rotation) {
  for (Vector3d& p : set.position) p = rotation * p;
  for (Vector3d& n : set.normal) n = rotation * n;
}

void rotate(SurfaceParticles& set, const Matrix3d& rotation) {
  for (auto* vectors : {&set.position, &set.normal, &set.fibre})
    for (Vector3d& v : *vectors) v = rotation * v;
}

}  // namespace

ValveCase place_valve_case(const TriangleMesh& lumen, const std::vector<DomainPort>& ports, std::vector<SurfaceParticles> leaflets,
                           const ValveCaseOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const Matrix3d to_lattice = lattice_rotation(ports);
  auto turned = std::make_shared<TriangleMesh>(lumen);
  for (Vector3d& p : turned->vertices) p = to_lattice * p;
  std::vector<DomainPort> turned_ports = ports;
  for (DomainPort& port : turned_ports) {
    port.point = to_lattice * port.point;
    port.normal = to_lattice * port.normal;
  }
  for (SurfaceParticles& leaflet : leaflets) rotate(leaflet, to_lattice);
  const std::vector<PlacedBody> bodies = lumen_bodies(turned, turned_ports, options);
  PlacementOptions placing;
  placing.spacing = options.spacing;
  placing.particle_limit = options.particle_limit;
  for (const SurfaceParticles& leaflet : leaflets)
    for (std::size_t i = 0; i < leaflet.size(); ++i) {
      placing.obstacle_position.push_back(leaflet.position[i]);
      placing.obstacle_volume.push_back(leaflet.area[i] * options.spacing);
    }
  Placement placement = place_particles(bodies, placing);
  ValveCase result;
  result.fluid = std::move(placement.bodies[0]);
  result.wall = std::move(placement.bodies[1]);
  result.warnings = std::move(placement.warnings);
  result.leaflets = std::move(leaflets);
  measure(result, bodies, turned_ports, options.spacing);
  if (options.measure_leak && !result.leaflets.empty())
    result.leak_clearance = leak_clearance(result, bodies[0].shape, turned_ports, options.spacing, &result.leak_place);
  result.leak_place = to_lattice.transpose() * result.leak_place;
  rotate(result.fluid, to_lattice.transpose());
  rotate(result.wall, to_lattice.transpose());
  for (SurfaceParticles& leaflet : result.leaflets) rotate(leaflet, to_lattice.transpose());
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

ValveCase place_valve_case(const TriangleMesh& lumen, const std::vector<DomainPort>& ports, const ValveTemplate& valve,
                           const ValveCaseOptions& options) {
  std::vector<SurfaceParticles> leaflets;
  for (const LeafletSurface& leaflet : valve.leaflets)
    leaflets.push_back(leaflet_particles(leaflet, options.leaflet_spacing * options.spacing, options.embedded_rows));
  ValveCase result = place_valve_case(lumen, ports, std::move(leaflets), options);
  result.warnings.insert(result.warnings.begin(), valve.warnings.begin(), valve.warnings.end());
  return result;
}

}  // namespace geometry
