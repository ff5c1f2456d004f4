// What stands once in a run file.
#include <cstdio>
#include <sstream>

#include "sim/run_layout.h"

namespace sim {
namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> lines;
  std::stringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

template <class T, std::size_t N>
std::vector<T> flat(const std::vector<std::array<T, N>>& rows) {
  std::vector<T> result;
  result.reserve(rows.size() * N);
  for (const auto& row : rows) result.insert(result.end(), row.begin(), row.end());
  return result;
}

template <class T, std::size_t N>
std::vector<std::array<T, N>> grouped(const std::vector<T>& values) {
  std::vector<std::array<T, N>> rows(values.size() / N);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < N; ++k) rows[i][k] = values[i * N + k];
  return rows;
}

void write_valve(hid_t file, const ValveFrame& valve) {
  h5::Handle group = h5::group(file, "valve");
  for (int axis = 0; axis < 3; ++axis) {
    h5::set_attribute(group, "annulus_center_" + std::string(1, "xyz"[axis]), valve.annulus_center[axis]);
    h5::set_attribute(group, "axis_" + std::string(1, "xyz"[axis]), valve.axis[axis]);
  }
  h5::set_attribute(group, "annulus_radius", valve.annulus_radius);
  h5::set_attribute(group, "commissure_height", valve.commissure_height);
  h5::set_attribute(group, "commissure_radius", valve.commissure_radius);
  h5::set_attribute(group, "ventricle_port", static_cast<std::int64_t>(valve.ventricle_port));
  h5::set_attribute(group, "aorta_port", static_cast<std::int64_t>(valve.aorta_port));
  h5::write_array(group, "leaflet_bodies", valve.leaflet_bodies);
}

ValveFrame read_valve(hid_t file) {
  h5::Handle group = h5::group(file, "valve");
  ValveFrame valve;
  for (int axis = 0; axis < 3; ++axis) {
    valve.annulus_center[axis] = h5::number_attribute(group, "annulus_center_" + std::string(1, "xyz"[axis]));
    valve.axis[axis] = h5::number_attribute(group, "axis_" + std::string(1, "xyz"[axis]));
  }
  valve.annulus_radius = h5::number_attribute(group, "annulus_radius");
  valve.commissure_height = h5::number_attribute(group, "commissure_height");
  valve.commissure_radius = h5::number_attribute(group, "commissure_radius");
  valve.ventricle_port = static_cast<std::int32_t>(h5::integer_attribute(group, "ventricle_port", -1));
  valve.aorta_port = static_cast<std::int32_t>(h5::integer_attribute(group, "aorta_port", -1));
  valve.leaflet_bodies = h5::read_array<std::int32_t>(group, "leaflet_bodies");
  return valve;
}

void write_bodies(hid_t file, const RunHeader& header) {
  h5::Handle bodies = h5::group(file, "bodies");
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const RunHeader::BodyInfo& body = header.bodies[i];
    char number[24];
    std::snprintf(number, sizeof number, "%03zu", i);
    h5::Handle group = h5::group(bodies, number);
    h5::set_attribute(group, "name", body.name);
    h5::set_attribute(group, "kind", kind_name(body.kind));
    h5::set_attribute(group, "kind_number", static_cast<std::int64_t>(body.kind));
    h5::set_attribute(group, "first", body.first);
    h5::set_attribute(group, "count", body.count);
    h5::set_attribute(group, "density", body.density);
    h5::set_attribute(group, "youngs_modulus", body.youngs_modulus);
    h5::set_attribute(group, "poisson_ratio", body.poisson_ratio);
    h5::set_attribute(group, "thickness", body.thickness);
    h5::set_attribute(group, "material", body.material);
    for (const RunHeader::ShellInfo& shell : header.shells)
      if (shell.body == static_cast<std::int32_t>(i)) h5::write_array(group, "elements", flat(shell.elements), 3);
  }
}

void read_bodies(hid_t file, RunHeader& header) {
  h5::Handle bodies = h5::group(file, "bodies");
  for (const std::string& name : h5::children(bodies)) {
    h5::Handle group = h5::group(bodies, name);
    RunHeader::BodyInfo body;
    body.name = h5::text_attribute(group, "name");
    body.kind = static_cast<Kind>(h5::integer_attribute(group, "kind_number"));
    body.first = h5::integer_attribute(group, "first");
    body.count = h5::integer_attribute(group, "count");
    body.density = h5::number_attribute(group, "density");
    body.youngs_modulus = h5::number_attribute(group, "youngs_modulus");
    body.poisson_ratio = h5::number_attribute(group, "poisson_ratio");
    body.thickness = h5::number_attribute(group, "thickness");
    body.material = h5::text_attribute(group, "material");
    if (h5::exists(group, "elements"))
      header.shells.push_back(
          {static_cast<std::int32_t>(header.bodies.size()), grouped<std::int32_t, 3>(h5::read_array<std::int32_t>(group, "elements"))});
    header.bodies.push_back(std::move(body));
  }
}

}  // namespace

std::string frame_name(std::size_t frame) {
  char name[24];
  std::snprintf(name, sizeof name, "%06zu", frame);
  return name;
}

std::string kind_name(Kind kind) {
  switch (kind) {
    case Kind::elastic:
      return "elastic";
    case Kind::shell:
      return "shell";
    case Kind::wall:
      return "wall";
    case Kind::fluid:
      return "fluid";
    case Kind::port:
      return "port";
  }
  return "?";
}

RunHeader::BodyInfo body_info(const Body& body) {
  RunHeader::BodyInfo info;
  info.name = body.name, info.kind = body.kind, info.first = body.first, info.count = body.count;
  if (body.kind == Kind::fluid) {
    static const char* const names[] = {"newtonian", "herschel-bulkley", "casson"};
    info.density = body.fluid.density, info.material = names[body.fluid.rheology.index()];
  } else if (body.kind != Kind::wall) {
    static const char* const names[] = {"linear", "corotated", "st-venant-kirchhoff", "neo-hookean", "fibre-reinforced"};
    info.density = body.elastic.density, info.youngs_modulus = body.elastic.youngs_modulus, info.poisson_ratio = body.elastic.poisson_ratio;
    info.thickness = body.elastic.thickness, info.material = names[static_cast<int>(body.elastic.law)];
  }
  return info;
}

void write_header(hid_t file, const RunHeader& header) {
  h5::set_attribute(file, "layout_version", static_cast<std::int64_t>(run_layout_version));
  h5::set_attribute(file, "program", std::string("cusp"));
  h5::set_attribute(file, "program_version", header.program_version);
  h5::set_attribute(file, "title", header.title);
  h5::set_attribute(file, "scheme", header.scheme);
  h5::set_attribute(file, "dimension", static_cast<std::int64_t>(header.dimension));
  h5::set_attribute(file, "spacing", header.spacing);
  h5::set_attribute(file, "end", header.end);
  h5::set_attribute(file, "output", header.output);
  h5::set_attribute(file, "static", static_cast<std::int64_t>(header.statics));
  h5::Handle scene = h5::group(file, "scene");
  h5::write_text(scene, "text", header.scene_text);
  h5::write_text(scene, "settings", joined(header.settings));
  h5::set_attribute(scene, "name", header.scene_name);
  h5::set_attribute(scene, "folder", header.scene_folder);
  write_bodies(file, header);
  h5::write_text(file, "ports", joined(header.ports));
  if (header.valve) write_valve(file, *header.valve);
  if (!header.lumen.triangles.empty()) {
    h5::Handle lumen = h5::group(file, "lumen");
    h5::write_array(lumen, "vertices", flat(header.lumen.vertices), 3, "m");
    h5::write_array(lumen, "triangles", flat(header.lumen.triangles), 3);
  }
  h5::Handle series = h5::group(file, "series");
  h5::write_text(series, "columns", joined(header.columns));
  h5::write_text(series, "units", joined(header.units));
  h5::make_table(series, "values", header.columns.size());
  h5::Handle lines = h5::group(file, "lines");
  for (const RunHeader::LineInfo& line : header.lines) {
    h5::Handle group = h5::group(lines, line.name);
    h5::write_array(group, "points", flat(line.points), 3, "m");
    h5::write_text(group, "components", joined(line.components));
    h5::set_attribute(group, "units", line.units);
    h5::make_table(group, "values", line.points.size() * line.components.size());
  }
  h5::group(file, "frames");
}

RunHeader read_header(hid_t file) {
  RunHeader header;
  header.layout_version = static_cast<int>(h5::integer_attribute(file, "layout_version", 0));
  header.program_version = h5::text_attribute(file, "program_version");
  header.title = h5::text_attribute(file, "title");
  header.scheme = h5::text_attribute(file, "scheme");
  header.dimension = static_cast<int>(h5::integer_attribute(file, "dimension", 3));
  header.spacing = h5::number_attribute(file, "spacing");
  header.end = h5::number_attribute(file, "end");
  header.output = h5::number_attribute(file, "output");
  header.statics = h5::integer_attribute(file, "static") != 0;
  h5::Handle scene = h5::group(file, "scene");
  header.scene_text = h5::read_text(scene, "text");
  header.settings = split(h5::read_text(scene, "settings"));
  header.scene_name = h5::text_attribute(scene, "name");
  header.scene_folder = h5::text_attribute(scene, "folder");
  read_bodies(file, header);
  header.ports = split(h5::read_text(file, "ports"));
  if (h5::exists(file, "valve")) header.valve = read_valve(file);
  if (h5::exists(file, "lumen")) {
    h5::Handle lumen = h5::group(file, "lumen");
    header.lumen.vertices = grouped<float, 3>(h5::read_array<float>(lumen, "vertices"));
    header.lumen.triangles = grouped<std::int32_t, 3>(h5::read_array<std::int32_t>(lumen, "triangles"));
  }
  h5::Handle series = h5::group(file, "series");
  header.columns = split(h5::read_text(series, "columns"));
  header.units = split(h5::read_text(series, "units"));
  h5::Handle lines = h5::group(file, "lines");
  for (const std::string& name : h5::children(lines)) {
    h5::Handle group = h5::group(lines, name);
    header.lines.push_back({name, h5::text_attribute(group, "units"), grouped<double, 3>(h5::read_array<double>(group, "points")),
                            split(h5::read_text(group, "components"))});
  }
  return header;
}

}  // namespace sim
