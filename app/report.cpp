// What the report page shows of a run, as data.
#include "app/report.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <regex>

#include "app/assets.h"
#include "app/base64.h"
#include "app/clinical.h"
#include "app/html_page.h"
#include "app/movie.h"
#include "app/report_model.h"
#include "app/scene_error.h"

namespace app {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json rounded(const std::vector<double>& values) {
  json list = json::array();
  for (const double value : values) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    list.push_back(std::isfinite(value) ? json(std::atof(text)) : json());
  }
  return list;
}

// Curves of the page: of a valve its figures and ports, of another run its probes; plus the ledger's last row.
void add_series(json& data, const sim::RunReader& run, const std::optional<ClinicalFigures>& clinical) {
  const sim::RunHeader& header = run.header();
  const sim::ValveSeries series = clinical ? clinical->series : sim::ValveSeries{header.columns, run.series(), false};
  std::size_t first_metric = header.columns.size(), first_ledger = header.columns.size();
  for (std::size_t k = 0; k < header.columns.size(); ++k) {
    if (header.columns[k] == "maximum_speed") first_metric = k;
    if (header.columns[k] == "particles") first_ledger = k;
  }
  for (std::size_t k = 0; k < series.columns.size(); ++k) {
    const std::string& name = series.columns[k];
    const bool ledger = k >= first_ledger && k < header.columns.size();
    if (ledger && !series.rows.empty()) data["ledger"].push_back({name, series.rows.back()[k], header.units[k]});
    if (ledger || name.rfind("leaflet_1.", 0) == 0 || name.rfind("leaflet_2.", 0) == 0 || name.rfind("leaflet_3.", 0) == 0) continue;
    if (k > 0 && !clinical && (k >= first_metric ? name != "maximum_speed" : k > 12)) continue;
    std::vector<double> values;
    for (const auto& row : series.rows) values.push_back(k < row.size() ? row[k] : NAN);
    data["series"][name] = rounded(values);
    if (k < header.units.size()) data["units"][name] = header.units[k];
  }
}

void add_settings(json& data, const sim::RunReader& run) {
  const sim::RunHeader& header = run.header();
  static const char* const kinds[] = {"elastic", "shell", "wall", "fluid", "port"};
  for (const auto& body : header.bodies)
    data["bodies"].push_back({{"name", body.name},
                              {"kind", kinds[static_cast<int>(body.kind)]},
                              {"particles", body.count},
                              {"material", body.material},
                              {"density", body.density},
                              {"youngs_modulus", body.youngs_modulus},
                              {"poisson_ratio", body.poisson_ratio},
                              {"thickness", body.thickness}});
  for (const std::string& setting : header.settings) data["settings"].push_back(without_file_names(setting));
  data["scene_text"] = without_file_names(header.scene_text);
  data["warnings"] = run.warnings();
}

// What `cusp import` found, where its import.json lies beside the scene.
void add_import(json& data, const sim::RunHeader& header, const fs::path& file) {
  const fs::path found = file.parent_path() / header.scene_folder / "import.json";
  if (!fs::is_regular_file(found)) return;
  const json import = json::parse(text_of(found), nullptr, false);
  if (import.is_object()) data["import"] = import;
}

// How far to trust it: what the spacing resolves, and what half of it would cost. Particles grow as l0^-3 and steps as l0^-1.
void add_accuracy(json& data, const sim::RunReader& run, const std::optional<ClinicalFigures>& clinical) {
  const sim::RunHeader& header = run.header();
  const double minutes = run.wall_seconds() / 60, growth = header.dimension == 3 ? 16 : 8;
  json& accuracy = data["accuracy"];
  accuracy["spacing"] = header.spacing, accuracy["minutes"] = minutes;
  accuracy["minutes_at_three_quarters"] = minutes * std::pow(4.0 / 3, header.dimension + 1);
  accuracy["minutes_at_half"] = minutes * growth;
  if (!clinical) return;
  if (const sim::Figure* area = clinical->summary.find("orifice_area"); area && area->value > 0) {
    accuracy["orifice_across"] = std::sqrt(4 * area->value / M_PI) / header.spacing;
    accuracy["orifice_error"] = area->uncertainty / area->value;
  }
}

// A still at a time, drawn anew into a temporary file; nothing where drawing fails (no EGL): the page does without.
json still(const fs::path& run, double time, const std::string& name) {
  const fs::path file = fs::temp_directory_path() / ("cusp_still_" + std::to_string(::getpid()) + "_" + name + ".png");
  try {
    MovieJob job;
    job.runs = {run}, job.output = file, job.time = time, job.width = 1280, job.height = 720, job.quality = 1;
    make_movie(job);
    json picture{{"name", name}, {"time", time}, {"data", data_address(file, "image/png")}};
    fs::remove(file);
    return picture;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "no picture \"%s\": %s\n", name.c_str(), error.what());
    return {};
  }
}

void add_pictures(json& data, const fs::path& file, const sim::RunReader& run, const std::optional<ClinicalFigures>& clinical) {
  std::vector<std::pair<std::string, double>> wanted{{"end", run.frame_time(run.frame_count() - 1)}};
  if (clinical) {
    const ReportMoments moments = report_moments(*clinical);
    wanted = {{"open", moments.open}, {"closed", moments.closed}};
  }
  for (const auto& [name, time] : wanted)
    if (json picture = still(file, time, name); !picture.is_null()) data["pictures"].push_back(picture);
}

void add_movie(json& data, const fs::path& file, const fs::path& chosen) {
  for (const fs::path& movie : {chosen, file.parent_path() / "movie.mp4", fs::path(file).replace_extension(".mp4")})
    if (!movie.empty() && fs::is_regular_file(movie)) {
      data["movie"] = data_address(movie, "video/mp4");
      return;
    }
  if (!chosen.empty()) throw SceneError(chosen.string() + ": no such movie; leave --movie out, or make it with cusp render");
}

}  // namespace

std::string without_file_names(const std::string& text) {
  static const std::regex name(R"((["'])[^"'\n]*\.(stl|ply|obj|vtp|vtk|vtu|off|csv|toml|h5|glb|gltf|3mf|STL|PLY|OBJ|VTP)\1)");
  return std::regex_replace(text, name, "\"(file)\"");
}

nlohmann::json report_run(const fs::path& file, const ReportOptions& options) {
  if (!fs::is_regular_file(file)) throw SceneError(file.string() + ": no such file; give a run (.h5)");
  std::unique_ptr<sim::RunReader> run;
  try {
    run = std::make_unique<sim::RunReader>(file);
  } catch (const std::runtime_error& error) {
    throw SceneError(error.what());
  }
  if (run->frame_count() == 0) throw SceneError(file.string() + ": holds no frame; run it further");
  const sim::RunHeader& header = run->header();
  const std::optional<ClinicalFigures> clinical = clinical_figures(*run, file);
  const std::size_t index = static_cast<std::size_t>(std::find(options.runs.begin(), options.runs.end(), file) - options.runs.begin());
  json data{{"title", index < options.labels.size() ? options.labels[index] : header.title},
            {"version", header.program_version},
            {"status", run->status()},
            {"dimension", header.dimension},
            {"spacing", header.spacing},
            {"scheme", header.scheme},
            {"end", header.end},
            {"frames", run->frame_count()},
            {"steps", run->steps()},
            {"wall_seconds", run->wall_seconds()},
            {"ports", header.ports},
            {"ledger", json::array()},
            {"pictures", json::array()},
            {"settings", json::array()}};
  if (clinical) {
    data["clinical"] = clinical_json(*clinical);
    data["model"] = report_model(*run, report_moments(*clinical));
  }
  add_series(data, *run, clinical);
  add_settings(data, *run);
  add_import(data, header, file);
  add_accuracy(data, *run, clinical);
  if (options.with_pictures) add_pictures(data, file, *run, clinical);
  if (options.with_movie) add_movie(data, file, index < options.movies.size() ? options.movies[index] : fs::path());
  return data;
}

std::string report_page(const json& data) { return html_page("Valve report", {"curves.js", "viewer.js", "page.js"}, data); }

std::uintmax_t write_report(const ReportOptions& options) {
  json data{{"notice", standing_notice}, {"runs", json::array()}};
  for (const fs::path& run : options.runs) data["runs"].push_back(report_run(run, options));
  std::ofstream out(options.output, std::ios::binary);
  if (!out || !(out << report_page(data)) || !out.flush())
    throw std::runtime_error(options.output.string() + ": can't be written; is the folder there?");
  return fs::file_size(options.output);
}

}  // namespace app
