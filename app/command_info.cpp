// cusp info FILE [--json]: what a run, a scene or a mesh holds.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/clinical.h"
#include "app/commands.h"
#include "app/scene_file.h"
#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"
#include "sim/run_file.h"

namespace app {
namespace {

using nlohmann::json;

const char* kind_word(sim::Kind kind) {
  static const char* const words[] = {"elastic", "shell", "wall", "fluid", "port"};
  return words[static_cast<int>(kind)];
}

// The largest von Mises stress of any particle of any frame, and its time: for checking other readers of the file; at a clamp it means
// nothing.
std::pair<double, double> largest_stress(const sim::RunReader& run) {
  std::pair<double, double> found{0, 0};
  for (std::size_t k = 0; k < run.frame_count(); ++k)
    for (const float value : run.frame(k).von_mises)
      if (value > found.first) found = {value, run.frame_time(k)};
  return found;
}

json run_info(const std::filesystem::path& file) {
  const sim::RunReader run(file);
  const sim::RunHeader& header = run.header();
  json info{{"type", "run"},
            {"title", header.title},
            {"program_version", header.program_version},
            {"scene", header.scene_name},
            {"settings", header.settings},
            {"scheme", header.scheme},
            {"dimension", header.dimension},
            {"spacing", header.spacing},
            {"status", run.status()},
            {"end", header.end},
            {"frames", run.frame_count()},
            {"steps", run.steps()},
            {"wall_seconds", run.wall_seconds()},
            {"warnings", run.warnings()},
            {"continuable", run.has_checkpoint()}};
  for (const auto& body : header.bodies)
    info["bodies"].push_back({{"name", body.name}, {"kind", kind_word(body.kind)}, {"particles", body.count}, {"material", body.material}});
  for (std::size_t k = 0; k < run.frame_count(); ++k) info["frame_times"].push_back(run.frame_time(k));
  const auto series = run.series();
  info["rows"] = series.size();
  for (std::size_t k = 0; k < header.columns.size() && !series.empty(); ++k)
    info["last"][header.columns[k]] = {{"value", series.back()[k]}, {"units", k < header.units.size() ? header.units[k] : ""}};
  if (const auto [value, time] = largest_stress(run); value > 0)
    info["largest_von_mises_in_file"] = {{"value", value}, {"units", "Pa"}, {"time", time}};
  if (const auto clinical = clinical_figures(run, file)) {
    info["clinical"] = clinical_json(*clinical);
    info["clinical_text"] = clinical_text(*clinical);  // for the terminal alone
  }
  return info;
}

json scene_info(const std::filesystem::path& file) {
  const SceneFile scene = read_scene_file(file);
  json info{{"type", "scene"}, {"title", scene.title}, {"dimension", scene.dimension}, {"spacing", scene.spacing}, {"end", scene.time.end}};
  for (const BodySpec& body : scene.bodies) info["bodies"].push_back({{"name", body.name}, {"kind", kind_word(body.kind)}});
  for (const ProbeSpec& probe : scene.probes) info["probes"].push_back(probe.probe.name);
  for (const PortSpec& port : scene.ports) info["ports"].push_back(port.port.name);
  return info;
}

json mesh_info(const std::filesystem::path& file) {
  geometry::LoadedMesh loaded = geometry::load_mesh(file.string());
  const std::size_t triangles = loaded.mesh.triangles.size();
  geometry::weld_vertices(loaded.mesh);
  const geometry::MeshTopology topology = geometry::measure_topology(loaded.mesh);
  Eigen::Vector3d low, high;
  geometry::bounding_box(loaded.mesh, low, high);
  json info{{"type", "mesh"},
            {"format", loaded.format},
            {"triangles", triangles},
            {"vertices", loaded.mesh.vertices.size()},
            {"parts", loaded.group_names},
            {"components", topology.components},
            {"border_edges", topology.border_edges},
            {"non_manifold_edges", topology.non_manifold_edges},
            {"closed", topology.closed()}};
  for (int axis = 0; axis < 3; ++axis)
    info["bounding_box_file_units"]["min"].push_back(low[axis]), info["bounding_box_file_units"]["max"].push_back(high[axis]);
  return info;
}

void print_plain(const json& info, const std::string& indent) {
  for (const auto& [key, value] : info.items()) {
    if (key == "frame_times") continue;
    if (value.is_object() && value.contains("value")) {
      std::printf("%s%s: %s %s\n", indent.c_str(), key.c_str(), value["value"].dump().c_str(), value["units"].get<std::string>().c_str());
    } else if (value.is_object()) {
      std::printf("%s%s:\n", indent.c_str(), key.c_str());
      print_plain(value, indent + "  ");
    } else if (value.is_array() && !value.empty() && value[0].is_object()) {
      std::printf("%s%s:\n", indent.c_str(), key.c_str());
      for (const json& entry : value) {
        std::string line;
        for (const auto& [name, part] : entry.items())
          line += (line.empty() ? "" : ", ") + name + " " + (part.is_string() ? part.get<std::string>() : part.dump());
        std::printf("%s  %s\n", indent.c_str(), line.c_str());
      }
    } else {
      std::printf("%s%s: %s\n", indent.c_str(), key.c_str(), value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
    }
  }
}

int show(const std::string& name, bool as_json) {
  const std::filesystem::path file(name);
  if (!std::filesystem::is_regular_file(file)) throw SceneError(name + ": no such file; give a run (.h5), a scene (.toml) or a mesh");
  json info;
  try {
    info = file.extension() == ".h5" ? run_info(file) : file.extension() == ".toml" ? scene_info(file) : mesh_info(file);
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& error) {  // an unreadable file is bad input
    throw SceneError(error.what());
  }
  const std::string figures = info.value("clinical_text", "");
  info.erase("clinical_text");
  if (as_json) {
    std::printf("%s\n", info.dump(2).c_str());
    return 0;
  }
  info.erase("clinical");
  print_plain(info, "");
  if (!figures.empty()) std::printf("clinical figures (docs/metrics.md):\n%s", figures.c_str());
  return 0;
}

}  // namespace

void add_info_command(CLI::App& program, int& exit_code) {
  auto file = std::make_shared<std::string>();
  auto as_json = std::make_shared<bool>(false);
  CLI::App* command = program.add_subcommand("info", "say what a run, a scene or a mesh holds");
  command->footer("Example: cusp info run.h5 --json");
  command->add_option("FILE", *file, "run (.h5), scene (.toml) or mesh")->required();
  command->add_flag("--json", *as_json, "print one JSON object");
  command->callback([file, as_json, &exit_code] { exit_code = show(*file, *as_json); });
}

}  // namespace app
