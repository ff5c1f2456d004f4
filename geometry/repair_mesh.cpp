#include "geometry/repair_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <stdexcept>

#include "geometry/double_wall.h"
#include "geometry/openings.h"
#include "geometry/repair_cgal.h"
#include "geometry/triangle_tree.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<std::int32_t, 3>;

Vector3d center_of(const TriangleMesh& mesh, const Triangle& t) {
  return (mesh.vertices[std::size_t(t[0])] + mesh.vertices[std::size_t(t[1])] + mesh.vertices[std::size_t(t[2])]) / 3;
}

double area_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])], &c = mesh.vertices[std::size_t(t[2])];
  return (b - a).cross(c - a).norm() / 2;
}

std::string millimetres(const Vector3d& at) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.1f, %.1f, %.1f) mm", 1e3 * at.x(), 1e3 * at.y(), 1e3 * at.z());
  return text;
}

// Keeps the triangles for which `keep` holds; counts and locates the others as one defect.
template <class Keep>
void drop_triangles(TriangleMesh& mesh, const std::string& kind, RepairReport& report, Keep&& keep) {
  Defect defect{kind, 0, Vector3d::Zero(), true};
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (keep(t)) {
      kept.push_back(mesh.triangles[t]);
    } else if (defect.count++ == 0) {
      defect.at = center_of(mesh, mesh.triangles[t]);
    }
  }
  if (defect.count == 0) return;
  mesh.triangles = std::move(kept);
  report.defects.push_back(defect);
}

void drop_collapsed(TriangleMesh& mesh, RepairReport& report) {
  drop_triangles(mesh, "degenerate_faces", report, [&](std::size_t i) {
    const Triangle& t = mesh.triangles[i];
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
  });
}

void drop_duplicates(TriangleMesh& mesh, RepairReport& report) {
  std::set<Triangle> seen;
  drop_triangles(mesh, "duplicate_faces", report, [&](std::size_t i) {
    Triangle sorted = mesh.triangles[i];
    std::sort(sorted.begin(), sorted.end());
    return seen.insert(sorted).second;
  });
}

// Vertices that lie side by side where the surface should be one: welded when that closes borders.
void weld_split_borders(TriangleMesh& mesh, double tolerance, RepairReport& report) {
  const std::size_t before = measure_topology(mesh).border_edges;
  if (before == 0) return;
  TriangleMesh welded = mesh;
  const std::size_t gone = weld_vertices(welded, tolerance);
  RepairReport scratch;
  drop_collapsed(welded, scratch);
  drop_duplicates(welded, scratch);
  if (gone == 0 || measure_topology(welded).border_edges >= before) return;
  report.defects.push_back({"split_vertices", gone, mesh.vertices[0], true});
  mesh = std::move(welded);
}

// Turns faces so that neighbours agree (across edges with exactly two faces); in each connected part the minority by area is turned.
void unify_orientation(TriangleMesh& mesh, RepairReport& report) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::int32_t>> faces_at;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
      faces_at[{std::min(a, b), std::max(a, b)}].push_back(std::int32_t(t));
    }
  auto runs_forward = [&](std::int32_t t, std::int32_t a, std::int32_t b) {
    const Triangle& corners = mesh.triangles[std::size_t(t)];
    for (std::size_t c = 0; c < 3; ++c)
      if (corners[c] == a && corners[(c + 1) % 3] == b) return true;
    return false;
  };
  std::vector<std::int8_t> turned(mesh.triangles.size(), -1);
  Defect defect{"flipped_faces", 0, Vector3d::Zero(), true};
  for (std::size_t seed = 0; seed < turned.size(); ++seed) {
    if (turned[seed] >= 0) continue;
    std::vector<std::int32_t> part{std::int32_t(seed)};
    turned[seed] = 0;
    double area[2] = {0, 0};
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::int32_t t = part[i];
      area[turned[std::size_t(t)]] += area_of(mesh, mesh.triangles[std::size_t(t)]);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t a = mesh.triangles[std::size_t(t)][c], b = mesh.triangles[std::size_t(t)][(c + 1) % 3];
        const auto& pair = faces_at[{std::min(a, b), std::max(a, b)}];
        if (pair.size() != 2) continue;
        const std::int32_t other = pair[0] == t ? pair[1] : pair[0];
        if (turned[std::size_t(other)] >= 0) continue;
        turned[std::size_t(other)] = std::int8_t(turned[std::size_t(t)] ^ std::int8_t(runs_forward(other, a, b)));
        part.push_back(other);
      }
    }
    const std::int8_t wrong = area[1] <= area[0] ? 1 : 0;
    for (std::int32_t t : part)
      if (turned[std::size_t(t)] == wrong) {
        Triangle& corners = mesh.triangles[std::size_t(t)];
        std::swap(corners[1], corners[2]);
        if (defect.count++ == 0) defect.at = center_of(mesh, corners);
      }
  }
  if (defect.count > 0) report.defects.push_back(defect);
}

void drop_specks(TriangleMesh& mesh, double share, RepairReport& report) {
  const MeshTopology topology = measure_topology(mesh);
  if (topology.components < 2) return;
  std::vector<double> area(topology.components, 0);
  std::vector<Vector3d> place(topology.components, Vector3d::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto part = std::size_t(topology.component_of_triangle[t]);
    area[part] += area_of(mesh, mesh.triangles[t]);
    place[part] = center_of(mesh, mesh.triangles[t]);
  }
  const double least = share * *std::max_element(area.begin(), area.end());
  Defect defect{"specks", 0, Vector3d::Zero(), true};
  for (std::size_t part = 0; part < area.size(); ++part)
    if (area[part] < least && defect.count++ == 0) defect.at = place[part];
  if (defect.count == 0) return;
  RepairReport scratch;
  drop_triangles(mesh, "specks", scratch, [&](std::size_t t) { return area[std::size_t(topology.component_of_triangle[t])] >= least; });
  drop_unused_vertices(mesh);
  report.defects.push_back(defect);
  report.warnings.push_back("dropped " + std::to_string(defect.count) + " loose part(s) smaller than " + std::to_string(int(100 * share)) +
                            " % of the surface, the first at " + millimetres(defect.at));
}

std::size_t count_flat_faces(const TriangleMesh& mesh, Vector3d& at) {
  std::size_t count = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])], &c = mesh.vertices[std::size_t(t[2])];
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).norm() > 1e-10 * longest) continue;
    if (count++ == 0) at = center_of(mesh, t);
  }
  return count;
}

// Farthest that the mended surface strays from the original or the original from it, over the vertices that are not in both.
double movement_between(const TriangleMesh& before, const TriangleMesh& after) {
  auto order = [](const Vector3d& a, const Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  auto one_way = [&](const TriangleMesh& from, const TriangleMesh& to) {
    std::vector<Vector3d> known = to.vertices;
    std::sort(known.begin(), known.end(), order);
    const TriangleTree tree(to);
    double farthest = 0;
    for (const Vector3d& v : from.vertices)
      if (!std::binary_search(known.begin(), known.end(), v, order)) farthest = std::max(farthest, tree.distance(v));
    return farthest;
  };
  return std::max(one_way(before, after), one_way(after, before));
}

// Non-manifold edges, faces without area, self-intersections: one pass of CGAL, kept only when it moved nothing too far.
void mend_manifold(TriangleMesh& mesh, double most_movement, RepairReport& report) {
  const MeshTopology topology = measure_topology(mesh);
  const auto crossings = self_intersections(mesh);
  Vector3d flat_at = Vector3d::Zero();
  const std::size_t flat = count_flat_faces(mesh, flat_at);
  const Vector3d crossing_at =
      crossings.empty() ? Vector3d(Vector3d::Zero()) : center_of(mesh, mesh.triangles[std::size_t(crossings[0][0])]);
  if (topology.non_manifold_edges == 0 && topology.mismatched_edges == 0 && crossings.empty() && flat == 0) return;
  constexpr std::size_t most_crossings = 1500;  // pairs; removing more takes minutes and rebuilds the surface rather than mends it
  const bool uncross = !crossings.empty() && crossings.size() <= most_crossings;
  TriangleMesh mended = mesh;
  bool done = detail::mend_surface(mended, uncross);
  double moved = done ? movement_between(mesh, mended) : 0;
  if ((!done || moved > most_movement) && uncross) {  // without touching the crossings
    mended = mesh;
    done = detail::mend_surface(mended, false);
    moved = done ? movement_between(mesh, mended) : 0;
  }
  const bool kept = done && moved <= most_movement;
  if (kept) {
    mesh = std::move(mended);
    report.moved = std::max(report.moved, moved);
  }
  const MeshTopology now = measure_topology(mesh);
  Vector3d ignored;
  const std::size_t left = crossings.empty() ? 0 : self_intersections(mesh).size();
  if (topology.non_manifold_edges > 0)
    report.defects.push_back({"non_manifold_edges", topology.non_manifold_edges, topology.non_manifold_at, now.non_manifold_edges == 0});
  if (flat > 0) report.defects.push_back({"degenerate_faces", flat, flat_at, count_flat_faces(mesh, ignored) == 0});
  if (!crossings.empty()) {
    report.defects.push_back({"self_intersections", crossings.size(), crossing_at, left == 0});
    if (left > 0)
      report.warnings.push_back(std::to_string(left) +
                                " pairs of triangles still cross each other; removing them would change the surface too much");
  }
}

void close_holes(TriangleMesh& mesh, const RepairOptions& options, RepairReport& report) {
  Defect defect{"holes", 0, Vector3d::Zero(), true};
  double largest = 0;
  for (int round = 0; round < 2000; ++round) {
    bool closed_one = false;
    for (const auto& loop : border_loops(mesh)) {
      if (is_vessel_end(mesh, loop, options.end_diameter)) continue;
      std::vector<Vector3d> rim;
      for (std::int32_t v : loop) rim.push_back(mesh.vertices[std::size_t(v)]);
      const OpenEnd hole = measure_loop(rim);
      if (loop.size() <= 4 || !detail::fill_hole(mesh, loop)) cap_loop(mesh, loop);
      ++defect.count;
      if (2 * hole.radius > largest || defect.count == 1) {
        largest = 2 * hole.radius;
        defect.at = hole.center;
      }
      closed_one = true;
      break;  // the loops' vertex numbers are stale now
    }
    if (!closed_one) break;
  }
  if (defect.count == 0) return;
  report.defects.push_back(defect);
  char text[160];
  std::snprintf(text, sizeof text, "closed %zu hole(s) in the wall, the largest %.1f mm wide at %s", defect.count, 1e3 * largest,
                millimetres(defect.at).c_str());
  report.warnings.push_back(text);
}

// Each connected part outward, as if its ends were capped.
void turn_outward(TriangleMesh& mesh, RepairReport& report) {
  TriangleMesh capped = mesh;
  for (const auto& loop : border_loops(mesh)) cap_loop(capped, loop);
  const MeshTopology topology = measure_topology(capped);
  std::vector<double> volume(topology.components, 0);
  const Vector3d origin = mesh.vertices[0];
  for (std::size_t t = 0; t < capped.triangles.size(); ++t) {
    const Triangle& corners = capped.triangles[t];
    const Vector3d a = capped.vertices[std::size_t(corners[0])] - origin, b = capped.vertices[std::size_t(corners[1])] - origin,
                   c = capped.vertices[std::size_t(corners[2])] - origin;
    volume[std::size_t(topology.component_of_triangle[t])] += a.dot(b.cross(c));
  }
  Defect defect{"inward_normals", 0, Vector3d::Zero(), true};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (volume[std::size_t(topology.component_of_triangle[t])] >= 0) continue;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    if (defect.count++ == 0) defect.at = center_of(mesh, mesh.triangles[t]);
  }
  if (defect.count > 0) report.defects.push_back(defect);
}

}  // namespace

RepairReport repair_mesh(TriangleMesh& mesh, const RepairOptions& options) {
  RepairReport report;
  Vector3d low, high;
  bounding_box(mesh, low, high);
  const double diagonal = (high - low).norm();
  drop_collapsed(mesh, report);
  drop_duplicates(mesh, report);
  weld_split_borders(mesh, 1e-6 * diagonal, report);
  unify_orientation(mesh, report);
  drop_specks(mesh, options.speck, report);
  const DoubleWall wall = reduce_double_wall(mesh);
  if (wall.found) {
    if (!wall.reduced)
      throw std::runtime_error("has a double wall at " + millimetres(wall.at) + ": " + wall.reason +
                               "; export the blood's own surface (the lumen)");
    report.defects.push_back({"double_wall", 1, wall.at, true});
    report.warnings.push_back("the vessel has a double wall; the lumen is taken by its inner surface, " +
                              std::to_string(wall.triangles_dropped) + " triangles of the outer one are left out");
  }
  mend_manifold(mesh, options.movement * diagonal, report);
  drop_specks(mesh, options.speck, report);  // a fin comes off as a part of its own
  close_holes(mesh, options, report);
  turn_outward(mesh, report);
  return report;
}

}  // namespace geometry
