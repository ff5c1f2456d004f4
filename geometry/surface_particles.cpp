#include "geometry/surface_particles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "geometry/remesh_surface.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

// Points evenly spaced by arc length along a polyline, both ends kept, spacing as near to `spacing` as divides it.
std::vector<Vector3d> even_line(const std::vector<Vector3d>& line, double spacing) {
  std::vector<double> arc(line.size(), 0);
  for (std::size_t i = 1; i < line.size(); ++i) arc[i] = arc[i - 1] + (line[i] - line[i - 1]).norm();
  const int parts = std::max(2, int(std::lround(arc.back() / spacing)));
  std::vector<Vector3d> points{line.front()};
  std::size_t s = 1;
  for (int k = 1; k < parts; ++k) {
    const double at = arc.back() * k / parts;
    while (s + 1 < line.size() && arc[s] < at) ++s;
    points.push_back(line[s - 1] + (at - arc[s - 1]) / (arc[s] - arc[s - 1]) * (line[s] - line[s - 1]));
  }
  points.push_back(line.back());
  return points;
}

// Triangles between two lines of points that run side by side; `left` lies on the left of `right` seen along them.
void zip(const std::vector<Vector3d>& points, const std::vector<std::int32_t>& right, const std::vector<std::int32_t>& left,
         std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::size_t r = 0, l = 0;
  while (r + 1 < right.size() || l + 1 < left.size()) {
    bool step_right = l + 1 >= left.size();
    if (r + 1 < right.size() && l + 1 < left.size())
      step_right = (points[right[r + 1]] - points[left[l]]).squaredNorm() <= (points[left[l + 1]] - points[right[r]]).squaredNorm();
    if (step_right) {
      triangles.push_back({right[r], right[r + 1], left[l]});
      ++r;
    } else {
      triangles.push_back({right[r], left[l + 1], left[l]});
      ++l;
    }
  }
  std::erase_if(triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

// The leaflet's surface with an evenly divided border: attachment first, then free edge, both from commissure to commissure.
TriangleMesh evenly_bordered(const LeafletSurface& leaflet, double spacing, std::size_t& attachment_count) {
  const auto row_points = [&](int row) {
    return std::vector<Vector3d>(leaflet.reference.begin() + std::ptrdiff_t(leaflet.index(row, 0)),
                                 leaflet.reference.begin() + std::ptrdiff_t(leaflet.index(row, leaflet.columns - 1)) + 1);
  };
  TriangleMesh mesh;
  mesh.vertices = even_line(row_points(0), spacing);
  attachment_count = mesh.vertices.size();
  std::vector<std::int32_t> attachment, edge{0};
  for (std::size_t i = 0; i < attachment_count; ++i) attachment.push_back(std::int32_t(i));
  const std::vector<Vector3d> free_edge = even_line(row_points(leaflet.rows - 1), spacing);
  for (std::size_t i = 1; i + 1 < free_edge.size(); ++i) {
    edge.push_back(std::int32_t(mesh.vertices.size()));
    mesh.vertices.push_back(free_edge[i]);
  }
  edge.push_back(std::int32_t(attachment_count) - 1);
  std::vector<std::vector<std::int32_t>> rows;
  for (int r = 1; r + 1 < leaflet.rows; ++r) {
    rows.push_back({0});  // the ends are the commissures
    for (int c = 1; c + 1 < leaflet.columns; ++c) {
      rows.back().push_back(std::int32_t(mesh.vertices.size()));
      mesh.vertices.push_back(leaflet.reference[leaflet.index(r, c)]);
    }
    rows.back().push_back(std::int32_t(attachment_count) - 1);
  }
  zip(mesh.vertices, attachment, rows.front(), mesh.triangles);
  for (std::size_t r = 0; r + 1 < rows.size(); ++r) zip(mesh.vertices, rows[r], rows[r + 1], mesh.triangles);
  zip(mesh.vertices, rows.back(), edge, mesh.triangles);
  return mesh;
}

double surface_area(const std::vector<Vector3d>& p, const std::vector<std::array<std::int32_t, 3>>& triangles) {
  double area = 0;
  for (const auto& t : triangles) area += 0.5 * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm();
  return area;
}

// Thirds of the triangles' areas, scaled to the true surface's; and area-weighted normals.
void add_areas_and_normals(SurfaceParticles& particles, double true_area) {
  particles.area.assign(particles.size(), 0);
  particles.normal.assign(particles.size(), Vector3d::Zero());
  for (const auto& t : particles.triangles) {
    const Vector3d area =
        0.5 * (particles.position[t[1]] - particles.position[t[0]]).cross(particles.position[t[2]] - particles.position[t[0]]);
    for (auto v : t) {
      particles.area[v] += area.norm() / 3;
      particles.normal[v] += area;
    }
  }
  const double scale = true_area / surface_area(particles.position, particles.triangles);
  for (double& a : particles.area) a *= scale;
  for (Vector3d& n : particles.normal) n.normalize();
}

void make_tangent(std::vector<Vector3d>& fibre, const std::vector<Vector3d>& normal) {
  for (std::size_t i = 0; i < fibre.size(); ++i) {
    const Vector3d flat = fibre[i] - fibre[i].dot(normal[i]) * normal[i];
    fibre[i] = flat.norm() > 1e-9 ? Vector3d(flat.normalized()) : Vector3d(normal[i].unitOrthogonal());
  }
}

// Removes inner vertices that crowd a neighbour (the remesher cannot in the corners between kept borders): the vertex moves into its
// nearest neighbour where the surface allows it.
void collapse_crowded(TriangleMesh& mesh, double least) {
  auto& p = mesh.vertices;
  std::vector<std::uint8_t> border(p.size(), 0), gone(p.size(), 0);
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  for (const auto& [edge, count] : edges)
    if (count == 1) border[edge.first] = border[edge.second] = 1;
  const auto normal = [&](const std::array<std::int32_t, 3>& t) { return Vector3d((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]])); };
  for (std::int32_t v = 0; v < std::int32_t(p.size()); ++v) {
    if (border[v]) continue;
    std::vector<std::size_t> ring;
    std::int32_t nearest = -1;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& corners = mesh.triangles[t];
      if (std::find(corners.begin(), corners.end(), v) == corners.end()) continue;
      ring.push_back(t);
      for (auto n : corners)
        if (n != v && (nearest < 0 || (p[n] - p[v]).norm() < (p[nearest] - p[v]).norm())) nearest = n;
    }
    if (nearest < 0 || (p[nearest] - p[v]).norm() >= least) continue;
    bool good = true;
    std::size_t shared = 0;
    for (std::size_t t : ring) {
      auto moved = mesh.triangles[t];
      const Vector3d before = normal(moved);
      if (std::find(moved.begin(), moved.end(), nearest) != moved.end()) {
        ++shared;
        continue;
      }
      std::replace(moved.begin(), moved.end(), v, nearest);
      good &= normal(moved).dot(before) > 0.3 * normal(moved).norm() * before.norm();
      for (auto n : moved)  // the new edge must not exist already outside the ring
        if (n != nearest && edges.count(std::minmax(n, nearest)))
          good &= std::any_of(ring.begin(), ring.end(), [&](std::size_t other) {
            const auto& corners = mesh.triangles[other];
            return std::find(corners.begin(), corners.end(), n) != corners.end() &&
                   std::find(corners.begin(), corners.end(), nearest) != corners.end();
          });
    }
    if (!good || shared != 2) continue;
    for (std::size_t t : ring) std::replace(mesh.triangles[t].begin(), mesh.triangles[t].end(), v, nearest);
    std::erase_if(mesh.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    edges.clear();
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    gone[v] = 1;
  }
  std::vector<std::int32_t> number(p.size(), -1);
  std::vector<Vector3d> kept;
  for (std::size_t v = 0; v < p.size(); ++v)
    if (!gone[v]) {
      number[v] = std::int32_t(kept.size());
      kept.push_back(p[v]);
    }
  p = std::move(kept);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = number[v];
}

// Puts the rows named first, in that order; the rest follow.
void renumber(SurfaceParticles& particles, const std::vector<std::int32_t>& first) {
  std::vector<std::int32_t> number(particles.size(), -1);
  std::vector<Vector3d> position;
  const auto take = [&](std::int32_t row) {
    if (number[row] >= 0) return;
    number[row] = std::int32_t(position.size());
    position.push_back(particles.position[row]);
  };
  for (auto row : first) take(row);
  for (std::size_t row = 0; row < number.size(); ++row) take(std::int32_t(row));
  particles.position = std::move(position);
  for (auto& t : particles.triangles)
    for (auto& v : t) v = number[v];
}

// Rows that continue the surface beyond the attachment, `spacing` apart, along the surface's own slope there.
void embed(SurfaceParticles& particles, std::size_t attachment_count, double spacing, int rows) {
  std::vector<Vector3d> outward(attachment_count);
  for (std::size_t i = 0; i < attachment_count; ++i) {
    const Vector3d along = particles.position[std::min(i + 1, attachment_count - 1)] - particles.position[i > 0 ? i - 1 : 0];
    outward[i] = along.cross(particles.normal[i]).normalized();  // the surface lies on the left of the attachment
  }
  std::size_t before = 0;
  for (int row = 1; row <= rows; ++row) {
    const std::size_t first = particles.size();
    for (std::size_t i = 0; i < attachment_count; ++i) {
      particles.position.push_back(particles.position[i] + row * spacing * outward[i]);
      particles.normal.push_back(particles.normal[i]);
      particles.fibre.push_back(particles.fibre[i]);
      particles.attached.push_back(1);
      particles.embedded.push_back(1);
      particles.area.push_back(0);
    }
    for (std::size_t i = 0; i + 1 < attachment_count; ++i) {
      const auto a = std::int32_t(before + i), b = a + 1, c = std::int32_t(first + i), d = c + 1;
      particles.triangles.push_back({c, d, b});
      particles.triangles.push_back({c, b, a});
    }
    for (std::size_t i = 0; i < attachment_count; ++i) {
      const Vector3d& left = particles.position[first + (i > 0 ? i - 1 : 0)];
      const Vector3d& right = particles.position[first + std::min(i + 1, attachment_count - 1)];
      particles.area[first + i] = 0.5 * (right - left).norm() * spacing;
    }
    before = first;
  }
}

}  // namespace

SurfaceParticles leaflet_particles(const LeafletSurface& leaflet, double particle_spacing, int embedded_rows) {
  std::size_t attachment_count = 0;
  const TriangleMesh coarse = evenly_bordered(leaflet, particle_spacing, attachment_count);
  TriangleMesh even = remesh_surface(coarse, particle_spacing, true);
  collapse_crowded(even, 0.65 * particle_spacing);
  SurfaceParticles particles;
  particles.position = even.vertices;
  particles.triangles = even.triangles;
  // Border points did not move: find them again, attachment in order, then the free edge.
  std::map<std::array<double, 3>, std::int32_t> row_of;
  for (std::size_t i = 0; i < even.vertices.size(); ++i)
    row_of[{even.vertices[i].x(), even.vertices[i].y(), even.vertices[i].z()}] = std::int32_t(i);
  std::vector<std::int32_t> first;
  for (const Vector3d& p : coarse.vertices) {
    const auto found = row_of.find({p.x(), p.y(), p.z()});
    if (found != row_of.end()) first.push_back(found->second);
    if (first.size() < std::min(attachment_count, std::size_t(&p - coarse.vertices.data()) + 1))
      throw std::runtime_error("the leaflet's attachment could not be meshed evenly; use a finer spacing");
  }
  renumber(particles, first);
  add_areas_and_normals(particles, leaflet.measures.area > 0 ? leaflet.measures.area : surface_area(coarse.vertices, coarse.triangles));
  particles.fibre.resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    std::size_t nearest = 0;
    double best = 1e300;
    for (int r = 0; r < leaflet.rows; ++r)
      for (int c = 1; c + 1 < leaflet.columns; ++c) {  // at a commissure all rows meet
        const double d2 = (leaflet.reference[leaflet.index(r, c)] - particles.position[i]).squaredNorm();
        if (d2 < best) best = d2, nearest = leaflet.index(r, c);
      }
    particles.fibre[i] = leaflet.fibre[nearest];
  }
  make_tangent(particles.fibre, particles.normal);
  particles.attached.assign(particles.size(), 0);
  particles.embedded.assign(particles.size(), 0);
  for (std::size_t i = 0; i < attachment_count; ++i) particles.attached[i] = 1;
  embed(particles, attachment_count, particle_spacing, embedded_rows);
  return particles;
}

SurfaceParticles mesh_particles(const TriangleMesh& mesh, double particle_spacing) {
  if (mesh.empty()) throw std::runtime_error("the surface has no triangles");
  const TriangleMesh even = remesh_surface(mesh, particle_spacing, false);
  SurfaceParticles particles;
  particles.position = even.vertices;
  particles.triangles = even.triangles;
  add_areas_and_normals(particles, surface_area(mesh.vertices, mesh.triangles));
  Vector3d low = even.vertices[0], high = low;
  for (const Vector3d& p : even.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  int longest = 0;
  (high - low).maxCoeff(&longest);
  particles.fibre.assign(particles.size(), Vector3d::Unit(longest));
  make_tangent(particles.fibre, particles.normal);
  particles.attached.assign(particles.size(), 0);
  particles.embedded.assign(particles.size(), 0);
  return particles;
}

}  // namespace geometry
