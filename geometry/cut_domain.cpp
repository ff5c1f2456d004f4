#include "geometry/cut_domain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include "geometry/check_mesh.h"
#include "geometry/openings.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<std::int32_t, 3>;
using Edge = std::pair<std::int32_t, std::int32_t>;

struct Cut {
  Vector3d point, normal;  // m; unit, out of the part that is kept
  double missing = 0;      // m, by how much the vessel was too short for the wanted place
};

// --- where to cut ------------------------------------------------------------------------------------------------------------------------

// Arc length at which the centreline crosses a plane, nearest to its centre.
double crossing_arc(const Centreline& line, const RootPlane& plane) {
  double best = line.arc.front(), nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double distance = (line.points[i] - plane.center).norm();
    if (distance < nearest) {
      nearest = distance;
      best = line.arc[i];
    }
  }
  return best;
}

// The station with the smallest section between two arc lengths; where the vessel ends before: the nearest one at which it is still
// open (not a cap's edge, not a dome that closes it).
Cut choose_cut(const TriangleMesh& lumen, const Centreline& line, double from, double to, double sign, double least_area) {
  Cut cut;
  double least = std::numeric_limits<double>::infinity();
  double fallback_gap = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double s = line.arc[i];
    const bool within = s >= std::min(from, to) && s <= std::max(from, to);
    const double gap = within ? 0 : std::min(std::abs(s - from), std::abs(s - to));
    if (within ? least == 0 : gap >= fallback_gap) continue;
    const Section section = section_around(lumen, line.points[i], line.tangents[i]);
    if (section.area < least_area || std::min(s, line.arc.back() - s) < 0.15 * section.diameter()) continue;  // too near an end: its cap
    const bool better = within ? section.area < least || fallback_gap > 0 : gap < fallback_gap;
    if (!better) continue;
    if (within) least = section.area;
    fallback_gap = gap;
    cut = {section.center, sign * line.tangents[i], gap};
  }
  if (fallback_gap == std::numeric_limits<double>::infinity())
    throw std::runtime_error("the lumen has no closed section to cut along; give the root's planes");
  return cut;
}

// --- cutting along one contour
// -------------------------------------------------------------------------------------------------------------

// The triangles crossed by the contour round `cut.point`: walks from the nearest crossing, triangle by triangle.
std::vector<bool> triangles_on_contour(const TriangleMesh& mesh, const std::vector<double>& height, const Cut& cut) {
  std::map<Edge, std::vector<std::int32_t>> crossed;  // cut edge -> triangles
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
      if ((height[std::size_t(a)] >= 0) != (height[std::size_t(b)] >= 0))
        crossed[{std::min(a, b), std::max(a, b)}].push_back(std::int32_t(t));
    }
  // One point of the contour that section_around found picks the chain.
  const Section section = section_around(mesh, cut.point, cut.normal);
  if (section.contour.empty()) throw std::runtime_error("the lumen has no closed section to cut along; give the root's planes");
  const Vector3d anchor = section.contour[0];
  Edge start{};
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [edge, faces] : crossed) {
    const double p = height[std::size_t(edge.first)], q = height[std::size_t(edge.second)];
    const Vector3d at = mesh.vertices[std::size_t(edge.first)] +
                        p / (p - q) * (mesh.vertices[std::size_t(edge.second)] - mesh.vertices[std::size_t(edge.first)]);
    if ((at - anchor).norm() < nearest) {
      nearest = (at - anchor).norm();
      start = edge;
    }
  }
  std::vector<bool> on(mesh.triangles.size(), false);
  std::vector<Edge> stack{start};
  while (!stack.empty()) {
    const Edge edge = stack.back();
    stack.pop_back();
    for (std::int32_t t : crossed[edge]) {
      if (on[std::size_t(t)]) continue;
      on[std::size_t(t)] = true;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t a = mesh.triangles[std::size_t(t)][c], b = mesh.triangles[std::size_t(t)][(c + 1) % 3];
        if ((height[std::size_t(a)] >= 0) != (height[std::size_t(b)] >= 0)) stack.push_back({std::min(a, b), std::max(a, b)});
      }
    }
  }
  return on;
}

std::int32_t vertex_on(const Edge& edge, TriangleMesh& mesh, const std::vector<double>& height, std::map<Edge, std::int32_t>& made) {
  const auto found = made.find(edge);
  if (found != made.end()) return found->second;
  const double p = height[std::size_t(edge.first)], q = height[std::size_t(edge.second)];
  // Kept off the edge's ends, so that no face without area arises; the rim then strays from the plane by a hair.
  const double share = std::clamp(p / (p - q), 0.02, 0.98);
  const Vector3d a = mesh.vertices[std::size_t(edge.first)], b = mesh.vertices[std::size_t(edge.second)];
  mesh.vertices.push_back(a + share * (b - a));
  return made[edge] = std::int32_t(mesh.vertices.size()) - 1;
}

// Cuts the mesh along one contour and keeps the side where the normal points away from, as far as it hangs together with `seed`'s side.
TriangleMesh cut_off(const TriangleMesh& lumen, const Cut& cut, const Vector3d& seed) {
  std::vector<double> height(lumen.vertices.size());
  for (std::size_t v = 0; v < height.size(); ++v) height[v] = (lumen.vertices[v] - cut.point).dot(cut.normal);
  const std::vector<bool> on = triangles_on_contour(lumen, height, cut);
  TriangleMesh out{lumen.vertices, {}};
  std::map<Edge, std::int32_t> made;
  std::vector<bool> above;  // per triangle made from a crossed one: beyond the cut
  for (std::size_t t = 0; t < lumen.triangles.size(); ++t) {
    const Triangle& corners = lumen.triangles[t];
    if (!on[t]) {
      out.triangles.push_back(corners);
      above.push_back(false);
      continue;
    }
    std::size_t lone = 0;  // the corner alone on its side
    for (std::size_t c = 0; c < 3; ++c) {
      const bool here = height[std::size_t(corners[c])] >= 0, next = height[std::size_t(corners[(c + 1) % 3])] >= 0,
                 last = height[std::size_t(corners[(c + 2) % 3])] >= 0;
      if (here != next && here != last) lone = c;
    }
    const std::int32_t a = corners[lone], b = corners[(lone + 1) % 3], c = corners[(lone + 2) % 3];
    const std::int32_t ab = vertex_on({std::min(a, b), std::max(a, b)}, out, height, made),
                       ca = vertex_on({std::min(a, c), std::max(a, c)}, out, height, made);
    const bool lone_above = height[std::size_t(a)] >= 0;
    out.triangles.push_back({a, ab, ca});
    above.push_back(lone_above);
    out.triangles.push_back({ab, b, c});
    above.push_back(!lone_above);
    out.triangles.push_back({ab, c, ca});
    above.push_back(!lone_above);
  }
  // Flood from the seed over edges, never along the cut.
  const auto first_new = std::int32_t(lumen.vertices.size());
  std::map<Edge, std::vector<std::int32_t>> faces;
  for (std::size_t t = 0; t < out.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = out.triangles[t][c], b = out.triangles[t][(c + 1) % 3];
      faces[{std::min(a, b), std::max(a, b)}].push_back(std::int32_t(t));
    }
  std::size_t start = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    const Vector3d middle = (out.vertices[std::size_t(out.triangles[t][0])] + out.vertices[std::size_t(out.triangles[t][1])] +
                             out.vertices[std::size_t(out.triangles[t][2])]) /
                            3;
    if (!above[t] && (middle - seed).norm() < nearest) {
      nearest = (middle - seed).norm();
      start = t;
    }
  }
  std::vector<bool> kept(out.triangles.size(), false);
  std::vector<std::size_t> stack{start};
  kept[start] = true;
  while (!stack.empty()) {
    const std::size_t t = stack.back();
    stack.pop_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = out.triangles[t][c], b = out.triangles[t][(c + 1) % 3];
      for (std::int32_t other : faces[{std::min(a, b), std::max(a, b)}]) {
        const bool across_cut = a >= first_new && b >= first_new && above[std::size_t(other)] != above[t];
        if (kept[std::size_t(other)] || across_cut || above[std::size_t(other)]) continue;
        kept[std::size_t(other)] = true;
        stack.push_back(std::size_t(other));
      }
    }
  }
  TriangleMesh part{out.vertices, {}};
  for (std::size_t t = 0; t < out.triangles.size(); ++t)
    if (kept[t]) part.triangles.push_back(out.triangles[t]);
  drop_unused_vertices(part);
  return part;
}

// --- extensions
// ----------------------------------------------------------------------------------------------------------------------------

// Rim points at even steps of arc length would lose the wall's own vertices; the rim is kept as it is and drawn out straight.
DomainPort extend(TriangleMesh& mesh, const std::vector<std::int32_t>& loop, const Vector3d& normal, double length) {
  std::vector<Vector3d> rim;
  for (std::int32_t v : loop) rim.push_back(mesh.vertices[std::size_t(v)]);
  const OpenEnd base = measure_loop(rim);
  double edge = 0;
  for (std::size_t i = 0; i < rim.size(); ++i) edge += (rim[i] - rim[(i + 1) % rim.size()]).norm() / double(rim.size());
  const int rings = std::max(1, int(std::lround(length / std::max(2 * edge, 0.05 * length))));
  std::vector<std::int32_t> before = loop;
  for (int ring = 1; ring <= rings; ++ring) {
    std::vector<std::int32_t> next;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const double off_plane = (rim[i] - base.center).dot(normal);  // the end is flat even where the rim is not
      next.push_back(std::int32_t(mesh.vertices.size()));
      mesh.vertices.push_back(rim[i] + (length - off_plane) * ring / rings * normal);
    }
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const std::size_t j = (i + 1) % rim.size();  // the wall runs i -> j along the loop; the new faces run j -> i
      mesh.triangles.push_back({before[j], before[i], next[i]});
      mesh.triangles.push_back({before[j], next[i], next[j]});
    }
    before = next;
  }
  std::vector<Vector3d> outer;
  for (std::int32_t v : before) outer.push_back(mesh.vertices[std::size_t(v)]);
  const OpenEnd end = measure_loop(outer);
  cap_loop(mesh, before);
  return {"", end.center, normal, end.radius_max, end.area};
}

std::size_t loop_nearest(const TriangleMesh& mesh, const std::vector<std::vector<std::int32_t>>& loops, const Vector3d& point) {
  std::size_t best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t l = 0; l < loops.size(); ++l) {
    Vector3d mean = Vector3d::Zero();
    for (std::int32_t v : loops[l]) mean += mesh.vertices[std::size_t(v)] / double(loops[l].size());
    if ((mean - point).norm() < nearest) {
      nearest = (mean - point).norm();
      best = l;
    }
  }
  return best;
}

}  // namespace

CutDomain cut_domain(const TriangleMesh& lumen, const Centreline& centreline, const AorticRoot& root, const CutOptions& options) {
  if (centreline.size() < 4) throw std::runtime_error("the lumen has no centreline to cut across");
  const double annulus_arc = crossing_arc(centreline, root.annulus), junction_arc = crossing_arc(centreline, root.sinotubular_junction);
  if (junction_arc <= annulus_arc)
    throw std::runtime_error("the centreline does not run from the annulus to the sinotubular junction; check the root's planes");
  const double scale = std::clamp(root.annulus.mean_diameter / 0.023, 0.3, 1.3);  // an adult's lengths, for a child's root
  const double root_area = root.annulus.mean_diameter * root.annulus.mean_diameter * std::numbers::pi / 4;
  const double junction_area = root.sinotubular_junction.mean_diameter * root.sinotubular_junction.mean_diameter * std::numbers::pi / 4;
  const Cut lower = choose_cut(lumen, centreline, annulus_arc - scale * options.below_annulus_min,
                               annulus_arc - scale * options.below_annulus_max, -1, 0.6 * root_area);
  const Cut upper = choose_cut(lumen, centreline, junction_arc + scale * options.above_junction_min,
                               junction_arc + scale * options.above_junction_max, +1, 0.5 * junction_area);
  CutDomain domain;
  domain.surface = cut_off(cut_off(lumen, lower, root.sinuses.center), upper, root.sinuses.center);
  for (const auto& [cut, name] : {std::pair{lower, "ventricle"}, std::pair{upper, "aorta"}}) {
    const auto loops = border_loops(domain.surface);
    if (loops.empty()) throw std::runtime_error("cutting the lumen left no opening; check the root's planes");
    DomainPort port =
        extend(domain.surface, loops[loop_nearest(domain.surface, loops, cut.point)], cut.normal, scale * options.extension + cut.missing);
    port.name = name;
    domain.ports.push_back(port);
    if (cut.missing > 0) {
      char text[160];
      std::snprintf(text, sizeof text, "the lumen ends %.1f mm early towards the %s; its straight extension is longer by that",
                    1e3 * cut.missing, name);
      domain.warnings.push_back(text);
    }
  }
  drop_unused_vertices(domain.surface);
  if (!measure_topology(domain.surface).closed()) throw std::runtime_error("the cut domain does not close; check the root's planes");
  return domain;
}

}  // namespace geometry
