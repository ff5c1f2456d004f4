#include "geometry/import_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "geometry/centreline.h"
#include "geometry/import_units.h"
#include "geometry/repair_mesh.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

// Up to six group names, those that sound like an aorta first.
std::string name_parts(const std::vector<std::string>& names) {
  std::vector<std::string> sorted = names;
  auto fits = [](const std::string& name) { return name.find("aort") != std::string::npos || name.find("Aort") != std::string::npos; };
  std::stable_partition(sorted.begin(), sorted.end(), fits);
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(6, sorted.size()); ++i) text += (i ? ", " : "") + sorted[i];
  return text + (sorted.size() > 6 ? ", ..." : "");
}

void select_part(LoadedMesh& loaded, const std::string& part) {
  if (part.empty()) return;
  std::vector<std::array<std::int32_t, 3>> kept;
  for (std::size_t t = 0; t < loaded.mesh.triangles.size(); ++t)
    if (loaded.group_names[std::size_t(loaded.group_of_triangle[t])] == part) kept.push_back(loaded.mesh.triangles[t]);
  if (kept.empty()) throw std::runtime_error("has no part \"" + part + "\"; its parts: " + name_parts(loaded.group_names));
  loaded.mesh.triangles = std::move(kept);
}

void settle_units(const LoadedMesh& loaded, const ImportOptions& options, ImportResult& result) {
  if (!options.units.empty()) {
    result.units = options.units;
    if (loaded.metres_per_unit > 0 && std::abs(metres_per_unit(options.units) - loaded.metres_per_unit) > 1e-12)
      result.warnings.push_back("the " + loaded.format + " format is in metres by its definition, but is read in " + options.units +
                                " as asked");
  } else if (loaded.metres_per_unit > 0) {
    result.units = "m";
  } else {
    result.units = detail::propose_units(loaded.mesh);
    result.units_proposed = true;
    result.warnings.push_back("units taken as " + result.units + ", by the size of the vessel; --units says otherwise");
  }
  result.metres_per_unit = metres_per_unit(result.units);
}

// One lumen is one surface: many large ones side by side are a whole organ, or a vessel in pieces.
void refuse_collections(const TriangleMesh& mesh, const LoadedMesh& loaded, std::size_t most) {
  const MeshTopology topology = measure_topology(mesh);
  std::vector<double> area(topology.components, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& c = mesh.triangles[t];
    area[std::size_t(topology.component_of_triangle[t])] += (mesh.vertices[std::size_t(c[1])] - mesh.vertices[std::size_t(c[0])])
                                                                .cross(mesh.vertices[std::size_t(c[2])] - mesh.vertices[std::size_t(c[0])])
                                                                .norm() /
                                                            2;
  }
  const double largest = *std::max_element(area.begin(), area.end());
  const auto large = std::size_t(std::count_if(area.begin(), area.end(), [&](double a) { return a > 0.02 * largest; }));
  if (large <= most) return;
  std::string text = "holds " + std::to_string(large) + " separate surfaces; the lumen must be one";
  if (loaded.group_names.size() > 1) text += ": choose one part (" + name_parts(loaded.group_names) + ")";
  throw std::runtime_error(text + ", or export the blood's own surface (the lumen) in one piece");
}

// Caps what is open; finds what was capped already. cap_of_triangle goes along.
void close_ends(ImportResult& result) {
  std::vector<OpenEnd> flat = find_flat_caps(result.lumen, 0.003);
  result.cap_of_triangle.assign(result.lumen.triangles.size(), -1);
  for (const auto& loop : border_loops(result.lumen)) {
    std::vector<Vector3d> rim;
    for (std::int32_t v : loop) rim.push_back(result.lumen.vertices[std::size_t(v)]);
    result.open_ends.push_back(measure_loop(rim));
    const std::size_t added = cap_loop(result.lumen, loop);
    result.cap_of_triangle.insert(result.cap_of_triangle.end(), added, std::int32_t(result.open_ends.size()) - 1);
  }
  for (OpenEnd& end : flat) {
    const auto number = std::int32_t(result.open_ends.size());
    for (std::size_t t = 0; t < result.lumen.triangles.size(); ++t) {
      if (result.cap_of_triangle[t] >= 0) continue;
      const auto& corners = result.lumen.triangles[t];
      const bool on_cap = std::all_of(corners.begin(), corners.end(), [&](std::int32_t v) {
        const Vector3d d = result.lumen.vertices[std::size_t(v)] - end.center;
        return std::abs(d.dot(end.normal)) < 0.02 * end.radius && d.norm() < 1.01 * end.radius_max;
      });
      if (on_cap) result.cap_of_triangle[t] = number;
    }
    result.open_ends.push_back(std::move(end));
  }
}

// The ends' roles from where the root is, or, without one, from their sizes and the way the vessel bends.
void assign_roles(const LumenField& field, ImportResult& result) {
  auto& ends = result.open_ends;
  if (ends.empty()) return;
  std::size_t largest = 0;
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (ends[i].area > ends[largest].area) largest = i;
  for (OpenEnd& end : ends) end.role = "branch";
  if (result.root && !result.root->built) {
    const RootPlane &annulus = result.root->annulus, &junction = result.root->sinotubular_junction;
    std::vector<double> from_junction;
    std::size_t far_end = ends.size();
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const double to_annulus = geodesic_distance(field, annulus.center - 0.5 * annulus.mean_diameter * annulus.normal, ends[i].center);
      const double to_junction = geodesic_distance(field, junction.center + 0.3 * junction.mean_diameter * junction.normal, ends[i].center);
      if (to_annulus < to_junction)
        ends[i].role = "ventricle";
      else if (far_end == ends.size() || ends[i].area > ends[far_end].area)
        far_end = i;
    }
    if (far_end < ends.size())
      ends[far_end].role = geodesic_distance(field, junction.center, ends[far_end].center) > 0.15 ? "descending" : "ascending";
    return;
  }
  // No root: the way from the widest end to the next widest; an arch turns back on itself.
  std::size_t second = ends.size();
  for (std::size_t i = 0; i < ends.size(); ++i)
    if (i != largest && (second == ends.size() || ends[i].area > ends[second].area)) second = i;
  constexpr double arch_turn = 100 * std::numbers::pi / 180;
  // (a ventricle's two valves face the same way too, but lie side by side)
  const bool arch = second < ends.size() &&
                    geodesic_distance(field, ends[largest].center, ends[second].center) > 5 * ends[largest].radius &&
                    std::acos(std::clamp(-ends[largest].normal.dot(ends[second].normal), -1.0, 1.0)) > arch_turn;
  ends[largest].role = arch ? "ascending" : "inlet";
  if (arch)
    ends[second].role = "descending";
  else if (ends.size() == 2)
    ends[second].role = "outlet";
}

void name_ends(const ImportOptions& options, ImportResult& result) {
  auto number = [&] {
    std::map<std::string, int> total, used;
    for (const OpenEnd& end : result.open_ends) ++total[end.role];
    for (OpenEnd& end : result.open_ends) end.name = total[end.role] == 1 ? end.role : end.role + std::to_string(++used[end.role]);
  };
  number();
  for (const EndOverride& given : options.ends) {
    const auto found =
        std::find_if(result.open_ends.begin(), result.open_ends.end(), [&](const OpenEnd& end) { return end.name == given.name; });
    if (found == result.open_ends.end()) throw std::runtime_error("has no end named \"" + given.name + "\" to give the role " + given.role);
    found->role = given.role;
  }
  if (!options.ends.empty()) number();
}

// Where the lumen ends: its open ends, and, where it has fewer than two, its farthest places.
std::vector<Vector3d> end_points(const LumenField& field, const std::vector<OpenEnd>& ends) {
  std::vector<Vector3d> points;
  for (const OpenEnd& end : ends) points.push_back(end.center);
  for (const Vector3d& far : find_far_ends(field)) {
    const bool known =
        std::any_of(ends.begin(), ends.end(), [&](const OpenEnd& end) { return (end.center - far).norm() < 1.5 * end.radius_max; });
    if (!known && (ends.empty() || points.size() < 2 || ends.size() < 3)) points.push_back(far);
  }
  return points;
}

// From the first of the points to each other one: every end's neighbourhood lies on one of these paths.
std::vector<Centreline> candidate_lines(const LumenField& field, const std::vector<Vector3d>& points) {
  std::vector<Centreline> lines;
  for (std::size_t j = 1; j < points.size(); ++j) {
    Centreline line = trace_centreline(field, points[0], points[j]);
    if (line.size() > 10) lines.push_back(std::move(line));
  }
  return lines;
}

void find_root(const LumenField& field, const ImportOptions& options, ImportResult& result) {
  // Most aortas: one path, from the widest end or the far end of the ventricle to the other end. Try all of them; three lobes decide.
  std::vector<OpenEnd> wide = result.open_ends;
  std::sort(wide.begin(), wide.end(), [](const OpenEnd& a, const OpenEnd& b) { return a.area > b.area; });
  if (wide.size() > 5) wide.resize(5);
  const std::vector<Centreline> lines = candidate_lines(field, end_points(field, wide));
  RootSearch search = find_aortic_root(result.lumen, lines, options.root);
  if (!search.root && options.build_root && search.likely_annulus) {
    RootOptions guess = options.root;
    guess.annulus = search.likely_annulus;
    RootSearch again = find_aortic_root(result.lumen, {search.centreline}, guess);
    if (again.root) {
      again.root->built = true;
      again.warnings.push_back("the sinuses and the junction are found, the annulus is built: the mesh has no outflow tract");
      search = std::move(again);
    }
  }
  if (!search.root && options.build_root) {
    Centreline line = search.centreline;
    if (line.size() < 4 && wide.size() >= 2) line = trace_centreline(field, wide[0].center, wide[1].center);
    if (line.size() < 4 && !lines.empty()) line = lines[0];
    const std::string found_before = search.reason;
    search = build_aortic_root(result.lumen, line, options.built_root);
    if (!search.root) search.reason = found_before + "; " + search.reason;
  }
  result.root = search.root;
  result.root_reason = search.reason;
  result.centreline = search.centreline;
  result.warnings.insert(result.warnings.end(), search.warnings.begin(), search.warnings.end());
  if (result.centreline.size() > 0) return;
  if (wide.size() >= 2)
    result.centreline = trace_centreline(field, wide[0].center, wide[1].center);
  else if (!lines.empty())
    result.centreline = lines[0];
}

ImportResult import_loaded(LoadedMesh&& loaded, const ImportOptions& options) {
  ImportResult result;
  result.format = loaded.format;
  select_part(loaded, options.part);
  result.triangles_in = loaded.mesh.triangles.size();
  weld_vertices(loaded.mesh);
  settle_units(loaded, options, result);
  result.lumen = loaded.mesh;
  for (Vector3d& v : result.lumen.vertices) v *= result.metres_per_unit;
  bounding_box(result.lumen, result.box_min, result.box_max);
  refuse_collections(result.lumen, loaded, 8);
  const RepairReport repaired = repair_mesh(result.lumen);
  result.defects = repaired.defects;
  result.warnings.insert(result.warnings.end(), repaired.warnings.begin(), repaired.warnings.end());
  refuse_collections(result.lumen, loaded, 1);
  close_ends(result);
  result.triangles_out = result.lumen.triangles.size();
  if (!measure_topology(result.lumen).closed() || !(signed_volume(result.lumen) > 0))
    throw std::runtime_error("could not be closed into a lumen; repair it in your segmentation tool");
  const LumenField field = make_lumen_field(result.lumen);
  find_root(field, options, result);
  assign_roles(field, result);
  name_ends(options, result);
  return result;
}

}  // namespace

ImportResult import_mesh(const std::string& path, const ImportOptions& options) {
  LoadedMesh loaded = load_mesh(path, options.limits);
  try {
    ImportResult result = import_loaded(std::move(loaded), options);
    result.file = path;
    return result;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace geometry
