// cusp import MESH [--units mm] [--build-root] [-o DIR] [--json]
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/commands.h"
#include "app/import_picture.h"
#include "app/mesh_files.h"
#include "app/scene_error.h"
#include "geometry/import_mesh.h"
#include "geometry/root_frame.h"
#include "geometry/valve_template.h"

namespace app {
namespace {

using nlohmann::json;

struct Options {
  std::string mesh, units, part, output;
  std::vector<std::string> ends;
  double annulus_diameter = 0;  // mm
  bool build_root = false, no_picture = false, quiet = false, as_json = false;
};

json in_mm(const Eigen::Vector3d& x) { return {1e3 * x[0], 1e3 * x[1], 1e3 * x[2]}; }
json plain(const Eigen::Vector3d& x) { return {x[0], x[1], x[2]}; }

json plane_json(const geometry::RootPlane& plane) {
  return {{"center_mm", in_mm(plane.center)},
          {"normal", plain(plane.normal)},
          {"diameters_mm", {1e3 * plane.largest_diameter, 1e3 * plane.perpendicular_diameter}}};
}

json root_json(const geometry::ImportResult& found) {
  if (!found.root) return nullptr;
  json root{{"annulus", plane_json(found.root->annulus)},
            {"sinuses", plane_json(found.root->sinuses)},
            {"sinotubular_junction", plane_json(found.root->sinotubular_junction)},
            {"built", found.root->built}};
  for (const Eigen::Vector3d& commissure : found.root->commissures) root["commissures_mm"].push_back(in_mm(commissure));
  return root;
}

json valve_json(const geometry::ValveTemplate& valve) {
  json result{{"annulus_radius_mm", 1e3 * valve.annulus_radius},
              {"commissure_radius_mm", 1e3 * valve.commissure_radius},
              {"commissure_height_mm", 1e3 * valve.commissure_height},
              {"largest_strain", valve.largest_strain}};
  for (const geometry::LeafletSurface& leaflet : valve.leaflets)
    result["leaflets"].push_back({{"free_edge_length_mm", 1e3 * leaflet.measures.free_edge_length},
                                  {"height_mm", 1e3 * leaflet.measures.height},
                                  {"coaptation_height_mm", 1e3 * leaflet.measures.coaptation_height},
                                  {"area_mm2", 1e6 * leaflet.measures.area},
                                  {"attachment_gap_max_mm", 1e3 * leaflet.measures.attachment_gap_max}});
  return result;
}

json import_json(const geometry::ImportResult& found) {
  json result{{"file", std::filesystem::path(found.file).filename().string()},
              {"format", found.format},
              {"units", found.units},
              {"units_proposed", found.units_proposed},
              {"triangles_in", found.triangles_in},
              {"triangles_out", found.triangles_out},
              {"bounding_box_mm", {in_mm(found.box_min), in_mm(found.box_max)}},
              {"defects", json::array()},
              {"open_ends", json::array()},
              {"root", root_json(found)},
              {"valve", nullptr},
              {"warnings", found.warnings}};
  for (const geometry::Defect& defect : found.defects)
    result["defects"].push_back(
        {{"kind", defect.kind}, {"count", defect.count}, {"at_mm", in_mm(defect.at)}, {"repaired", defect.repaired}});
  for (const geometry::OpenEnd& end : found.open_ends)
    result["open_ends"].push_back({{"name", end.name},
                                   {"role", end.role},
                                   {"center_mm", in_mm(end.center)},
                                   {"normal", plain(end.normal)},
                                   {"area_mm2", 1e6 * end.area}});
  if (!found.root) result["reason"] = found.root_reason;
  return result;
}

ExportSurface lumen_in_mm(const geometry::TriangleMesh& mesh) {
  ExportSurface surface;
  for (const Eigen::Vector3d& v : mesh.vertices) surface.points.push_back({float(1e3 * v[0]), float(1e3 * v[1]), float(1e3 * v[2])});
  surface.triangles = mesh.triangles;
  return surface;
}

std::string list_text(const Eigen::Vector3d& x) {
  std::ostringstream text;
  text.precision(6);
  text << "[" << x[0] << ", " << x[1] << ", " << x[2] << "]";
  return text.str();
}

// A scene that `cusp run` simulates as it stands; what was found stands there as comments, ready to be overridden.
std::string scene_text(const geometry::ImportResult& found) {
  std::ostringstream text;
  text << "title = \"Valve in an imported aorta\"\nspacing = 1.5e-3   # m; 1e-3 is finer and about six times slower\n\n[time]\nend = "
          "0.8\noutput = 0.008\n\n[patient]\n"
       << "aorta = { file = \"lumen.stl\", units = \"mm\" }\nvalve = { template = \"tricuspid\", thickness = 0.5e-3 }\nblood = { "
          "hematocrit = 45 }\nheart_rate = 75\n";
  if (!found.root) {
    text << "\n# No aortic root was found: " << found.root_reason
         << "\n# [patient.root]\n# build = true\n# annulus = { center = [0, 0, 0], normal = [0, 0, 1] }   # m\n";
    return text.str();
  }
  if (found.root->built) text << "\n[patient.root]\nbuild = true\nannulus = { diameter = " << found.root->annulus.mean_diameter << " }\n";
  text << "\n# Found in the mesh; take the # away and change what is wrong (m, in the mesh's coordinates).\n# [patient.root]\n# annulus = "
          "{ center = "
       << list_text(found.root->annulus.center) << ", normal = " << list_text(found.root->annulus.normal)
       << " }\n# sinotubular_junction = { center = " << list_text(found.root->sinotubular_junction.center)
       << ", normal = " << list_text(found.root->sinotubular_junction.normal) << " }\n# commissures = [";
  for (int k = 0; k < 3; ++k) text << (k ? ", " : "") << list_text(found.root->commissures[static_cast<std::size_t>(k)]);
  text << "]\n";
  return text.str();
}

void print_plain(const json& about, const std::filesystem::path& folder) {
  std::printf("%s: %zu triangles in, %zu out, units %s%s\n", about["file"].get<std::string>().c_str(),
              about["triangles_in"].get<std::size_t>(), about["triangles_out"].get<std::size_t>(),
              about["units"].get<std::string>().c_str(), about["units_proposed"].get<bool>() ? " (proposed from the size)" : "");
  for (const auto& defect : about["defects"])
    std::printf("  %s: %zu, %s\n", defect["kind"].get<std::string>().c_str(), defect["count"].get<std::size_t>(),
                defect["repaired"].get<bool>() ? "repaired" : "not repaired");
  for (const auto& end : about["open_ends"])
    std::printf("  end %-12s area %.1f mm2 at (%.1f, %.1f, %.1f) mm\n", end["name"].get<std::string>().c_str(),
                end["area_mm2"].get<double>(), end["center_mm"][0].get<double>(), end["center_mm"][1].get<double>(),
                end["center_mm"][2].get<double>());
  if (about["root"].is_null()) {
    std::printf("  no aortic root: %s\n", about["reason"].get<std::string>().c_str());
  } else {
    for (const char* ring : {"annulus", "sinuses", "sinotubular_junction"})
      std::printf("  %-21s %.1f x %.1f mm\n", ring, about["root"][ring]["diameters_mm"][0].get<double>(),
                  about["root"][ring]["diameters_mm"][1].get<double>());
  }
  for (const auto& warning : about["warnings"]) std::printf("  warning: %s\n", warning.get<std::string>().c_str());
  std::printf("%s, import.json, import.png, lumen.stl\n", (folder / "scene.toml").string().c_str());
}

geometry::ImportOptions import_options(const Options& options) {
  geometry::ImportOptions result;
  result.units = options.units, result.part = options.part, result.build_root = options.build_root;
  result.built_root.annulus_diameter = 1e-3 * options.annulus_diameter;
  for (const std::string& text : options.ends) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) throw SceneError("--end " + text + ": is no NAME=ROLE; as in --end branch2=ascending");
    result.ends.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return result;
}

int import(const Options& options) {
  geometry::ImportResult found;
  try {
    found = geometry::import_mesh(options.mesh, import_options(options));
  } catch (const std::runtime_error& error) {  // what can't become a lumen is bad input
    throw SceneError(error.what());
  }
  json about = import_json(found);
  std::vector<geometry::TriangleMesh> leaflets;
  if (found.root) {
    try {
      const geometry::RootFrame frame = geometry::make_root_frame(*found.root);
      const geometry::WallRadius wall(found.lumen, frame);
      const geometry::ValveTemplate valve =
          geometry::make_valve_template(frame, [&](double theta, double z) { return wall.radius_at(theta, z); });
      about["valve"] = valve_json(valve);
      for (const std::string& warning : valve.warnings) about["warnings"].push_back(warning);
      for (const auto& leaflet : valve.leaflets) leaflets.push_back(geometry::leaflet_mesh(leaflet, leaflet.reference));
    } catch (const std::runtime_error& error) {
      about["warnings"].push_back(std::string("no valve could be placed: ") + error.what());
    }
  }
  const std::filesystem::path folder =
      options.output.empty() ? "import-" + std::filesystem::path(options.mesh).stem().string() : options.output;
  std::filesystem::create_directories(folder);
  write_stl(lumen_in_mm(found.lumen), folder / "lumen.stl");
  std::ofstream(folder / "scene.toml") << scene_text(found);
  if (!options.no_picture) {
    try {
      write_import_picture(found, leaflets, folder / "import.png");
    } catch (const std::runtime_error& error) {
      about["warnings"].push_back(std::string("no import.png: ") + error.what());
    }
  }
  std::ofstream(folder / "import.json") << about.dump(2) << "\n";
  if (options.as_json)
    std::printf("%s\n", about.dump(2).c_str());
  else
    print_plain(about, folder);
  return 0;
}

}  // namespace

void add_import_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("import", "read a patient's mesh, mend it, find its ends and its aortic root, place a valve");
  command->footer("Example: cusp import aorta.stl --units mm -o patient");
  command->add_option("MESH", options->mesh, "STL, OBJ, PLY, OFF, GLB/glTF, VTP or VTK")->required();
  command->add_option("--units", options->units, "of the file: m, cm, mm, um (default: proposed from the size)");
  command->add_option("--part", options->part, "one group or node of the file instead of all");
  command->add_option("--end", options->ends, "NAME=ROLE of an open end (ventricle, ascending, descending, branch); may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--build-root", options->build_root, "put a root on a vessel that has none");
  command->add_option("--annulus-diameter", options->annulus_diameter, "mm, of a built root (default: from the vessel's bore)")
      ->check(CLI::PositiveNumber);
  command->add_option("-o,--output", options->output, "folder (default: import-MESH)");
  command->add_flag("--no-picture", options->no_picture, "no import.png");
  command->add_flag("--quiet", options->quiet, "no progress");
  command->add_flag("--json", options->as_json, "print import.json");
  command->callback([options, &exit_code] { exit_code = import(*options); });
}

}  // namespace app
