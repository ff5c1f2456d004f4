#include "sim/valve_sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "sim/point_grid.h"

namespace sim {
namespace {

using Eigen::Vector3d;

// Edges of one triangle alone that are not wholly held, as neighbours of each row.
std::map<std::int32_t, std::vector<std::int32_t>> free_border(const ValveSheet& sheet) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> uses;
  for (const auto& element : sheet.elements)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(element[k], element[(k + 1) % 3]);
      ++uses[{low, high}];
    }
  std::map<std::int32_t, std::vector<std::int32_t>> next;
  for (const auto& [edge, count] : uses)
    if (count == 1 && !(sheet.held[edge.first] && sheet.held[edge.second]))
      next[edge.first].push_back(edge.second), next[edge.second].push_back(edge.first);
  return next;
}

double length_of(const ValveSheet& sheet, const std::vector<std::int32_t>& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (sheet.rest[path[i]] - sheet.rest[path[i - 1]]).norm();
  return length;
}

// The longest path along the free border of each leaflet: from a held row to a held row, or round where nothing is held.
void find_free_edges(ValveSheet& sheet) {
  auto next = free_border(sheet);
  const auto walk = [&](std::int32_t start) {
    std::vector<std::int32_t> path{start};
    for (;;) {
      auto& onward = next[path.back()];
      if (onward.empty()) return path;
      const std::int32_t to = onward.back();
      onward.pop_back();
      auto& back = next[to];
      back.erase(std::find(back.begin(), back.end(), path.back()));
      path.push_back(to);
      if (sheet.held[to] || to == start) return path;
    }
  };
  for (const bool from_held : {true, false})
    for (auto& [start, onward] : next)
      while (!onward.empty() && (!from_held || sheet.held[start])) {
        std::vector<std::int32_t> path = walk(start);
        auto& edge = sheet.leaflets[static_cast<std::size_t>(sheet.leaflet[start])].free_edge;
        if (length_of(sheet, path) > length_of(sheet, edge)) edge = std::move(path);
      }
}

// The row half-way along the free edge; where the edge is a ring (nothing held), its row nearest to the axis.
std::int32_t tip_of(const ValveSheet& sheet, const std::vector<std::int32_t>& edge) {
  if (edge.empty()) return -1;
  if (edge.front() == edge.back()) {
    const auto off_axis = [&](std::int32_t i) { return sheet.frame.axis.cross(sheet.rest[i] - sheet.frame.annulus_center).norm(); };
    return *std::min_element(edge.begin(), edge.end(), [&](std::int32_t a, std::int32_t b) { return off_axis(a) < off_axis(b); });
  }
  const double half = 0.5 * length_of(sheet, edge);
  double length = 0;
  for (std::size_t i = 1; i < edge.size(); ++i) {
    const double step = (sheet.rest[edge[i]] - sheet.rest[edge[i - 1]]).norm();
    if (length + step >= half) return half - length < 0.5 * step ? edge[i - 1] : edge[i];
    length += step;
  }
  return edge[edge.size() / 2];
}

double distance_to(const PointGrid<3>& grid, const Vector3d& x, double reach) {
  double nearest = reach * reach;
  grid.for_each_near(x, reach, [&](std::int32_t, double squared) { nearest = std::min(nearest, squared); });
  return std::sqrt(nearest);
}

// Bands by distance at rest: clamp < max(h, 2 l0) <= attachment < that + 2 l0; commissure within a reach of the free edge's ends (and clear
// of the clamp); free edge within 1.5 l0; belly the rest.
void find_regions(ValveSheet& sheet) {
  const double l0 = sheet.spacing, clamp = std::max(sheet.thickness, 2 * l0), band = clamp + 2 * l0;
  std::vector<Vector3d> held, edge, ends;
  for (std::size_t i = 0; i < sheet.size(); ++i)
    if (sheet.held[i]) held.push_back(sheet.rest[i]);
  double chord = 0;
  for (const ValveSheet::Leaflet& leaflet : sheet.leaflets) {
    for (std::int32_t i : leaflet.free_edge) edge.push_back(sheet.rest[i]);
    if (leaflet.free_edge.empty() || !sheet.held[leaflet.free_edge.front()]) continue;
    ends.push_back(sheet.rest[leaflet.free_edge.front()]), ends.push_back(sheet.rest[leaflet.free_edge.back()]);
    chord = std::max(chord, (ends.back() - ends[ends.size() - 2]).norm());
  }
  const double reach = std::max(clamp + 2 * l0, 0.15 * chord), widest = std::max(band, reach) + l0;
  const PointGrid<3> near_held(held, widest), near_edge(edge, widest), near_end(ends, widest);
  sheet.region.assign(sheet.size(), LeafletRegion::belly);
  for (std::size_t i = 0; i < sheet.size(); ++i) {
    const double from_held = distance_to(near_held, sheet.rest[i], widest);
    if (sheet.held[i] || from_held < clamp)
      sheet.region[i] = LeafletRegion::clamp;
    else if (distance_to(near_end, sheet.rest[i], widest) < reach)
      sheet.region[i] = LeafletRegion::commissure;
    else if (from_held < band)
      sheet.region[i] = LeafletRegion::attachment;
    else if (distance_to(near_edge, sheet.rest[i], widest) < 1.5 * l0)
      sheet.region[i] = LeafletRegion::free_edge;
  }
}

void find_directions(ValveSheet& sheet) {
  std::vector<Vector3d> sum(sheet.leaflets.size(), Vector3d::Zero());
  std::vector<double> count(sheet.leaflets.size(), 0);
  for (std::size_t i = 0; i < sheet.size(); ++i)
    sum[sheet.leaflet[i]] += sheet.rest[i] - sheet.frame.annulus_center, ++count[sheet.leaflet[i]];
  for (std::size_t k = 0; k < sheet.leaflets.size(); ++k) {
    Vector3d out = sum[k] / std::max(1.0, count[k]);
    out -= sheet.frame.axis * sheet.frame.axis.dot(out);
    sheet.leaflets[k].outward = out.norm() > 0 ? Vector3d(out.normalized()) : sheet.frame.axis.unitOrthogonal();
  }
}

}  // namespace

const char* region_name(LeafletRegion region) {
  static const char* const names[] = {"clamp", "commissure", "attachment", "free_edge", "belly"};
  return names[static_cast<int>(region)];
}

ValveSheet make_valve_sheet(const ValveFrame& frame, double spacing, double thickness, const std::vector<std::int32_t>& leaflet,
                            std::vector<Vector3d> rest, std::vector<std::uint8_t> held, std::vector<std::array<std::int32_t, 3>> elements) {
  if (elements.empty()) throw std::invalid_argument("valve figures: the leaflets have no triangle mesh");
  ValveSheet sheet;
  sheet.frame = frame, sheet.spacing = spacing, sheet.thickness = thickness;
  sheet.leaflet = leaflet, sheet.rest = std::move(rest), sheet.held = std::move(held), sheet.elements = std::move(elements);
  sheet.leaflets.resize(static_cast<std::size_t>(*std::max_element(leaflet.begin(), leaflet.end())) + 1);
  find_free_edges(sheet);
  for (ValveSheet::Leaflet& one : sheet.leaflets) one.tip = tip_of(sheet, one.free_edge);
  find_regions(sheet);
  find_directions(sheet);
  return sheet;
}

ValveSheet make_valve_sheet(const Scene<3>& scene) {
  const ShellElasticity<3>& shells = *scene.shells;
  const std::vector<std::int32_t>& wanted = scene.description.valve->leaflet_bodies;
  std::vector<std::int32_t> sheet_row(shells.size(), -1), leaflet;
  std::vector<std::int64_t> row;
  std::vector<Vector3d> rest;
  std::vector<std::uint8_t> held;
  double thickness = 0;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    const ShellBody& body = shells.bodies[shells.body[i]];
    const auto found = std::find(wanted.begin(), wanted.end(), body.body);
    if (found == wanted.end()) continue;
    sheet_row[i] = static_cast<std::int32_t>(rest.size());
    leaflet.push_back(static_cast<std::int32_t>(found - wanted.begin()));
    row.push_back(shells.first_row + static_cast<std::int64_t>(i));
    rest.push_back(shells.rest_position[i]), held.push_back((shells.fixed[i] & 7) == 7), thickness = std::max(thickness, body.thickness);
  }
  std::vector<std::array<std::int32_t, 3>> elements;
  for (const auto& element : shells.elements)
    if (sheet_row[element[0]] >= 0) elements.push_back({sheet_row[element[0]], sheet_row[element[1]], sheet_row[element[2]]});
  ValveSheet sheet = make_valve_sheet(*scene.description.valve, scene.description.spacing, thickness, leaflet, std::move(rest),
                                      std::move(held), std::move(elements));
  sheet.row = std::move(row);
  return sheet;
}

ValveSheet make_valve_sheet(const RunReader& run) {
  const RunHeader& header = run.header();
  if (!header.valve || run.frame_count() == 0) throw std::runtime_error("valve figures: the run has no valve or no frame");
  const RunFrame first = run.frame(0), middle = run.frame(run.frame_count() / 2), last = run.frame(run.frame_count() - 1);
  std::vector<std::int32_t> leaflet;
  std::vector<std::int64_t> row;
  std::vector<Vector3d> rest;
  std::vector<std::uint8_t> held;
  std::vector<std::array<std::int32_t, 3>> elements;
  double thickness = 0;
  for (std::size_t k = 0; k < header.valve->leaflet_bodies.size(); ++k) {
    const std::int32_t wanted = header.valve->leaflet_bodies[k];
    const auto offset = static_cast<std::int32_t>(rest.size());
    thickness = std::max(thickness, header.bodies[static_cast<std::size_t>(wanted)].thickness);
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first.body[i] != wanted || first.kind[i] != static_cast<std::uint8_t>(Kind::shell)) continue;
      leaflet.push_back(static_cast<std::int32_t>(k)), row.push_back(static_cast<std::int64_t>(i));
      rest.emplace_back(first.position[i].data());
      held.push_back(run.frame_count() > 1 && first.position[i] == middle.position[i] && first.position[i] == last.position[i]);
    }
    for (const RunHeader::ShellInfo& shell : header.shells)
      if (shell.body == wanted)
        for (const auto& element : shell.elements) elements.push_back({element[0] + offset, element[1] + offset, element[2] + offset});
  }
  ValveSheet sheet =
      make_valve_sheet(*header.valve, header.spacing, thickness, leaflet, std::move(rest), std::move(held), std::move(elements));
  sheet.row = std::move(row);
  return sheet;
}

void sheet_normals_and_areas(const ValveSheet& sheet, std::span<const Vector3d> position, std::vector<Vector3d>& normal,
                             std::vector<double>& area) {
  normal.assign(sheet.size(), Vector3d::Zero());
  area.assign(sheet.size(), 0.0);
  for (const auto& e : sheet.elements) {
    const Vector3d twice = (position[e[1]] - position[e[0]]).cross(position[e[2]] - position[e[0]]);
    for (std::int32_t i : e) normal[i] += twice, area[i] += twice.norm() / 6;
  }
  for (Vector3d& n : normal) n.normalize();
}

}  // namespace sim
