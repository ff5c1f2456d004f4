// cusp export RUN.h5 [--vtp --ply --gltf --csv] [--time …]: leaflets and particles of a frame in others' formats.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>

#include "app/clinical.h"
#include "app/commands.h"
#include "app/mesh_files.h"
#include "app/scene_error.h"
#include "sim/run_file.h"

namespace app {
namespace {

struct Options {
  std::string run, output;
  double time = -1;
  bool vtp = false, ply = false, gltf = false, csv = false, every = false;
};

NamedField scalar(const std::string& name, const std::vector<float>& values) { return {name, 1, values}; }

// Rows of a frame that belong to `body` (-1: all), with their fields.
ExportSurface part_of(const sim::RunFrame& frame, std::int32_t body) {
  ExportSurface part;
  NamedField stress = scalar("von_mises_stress", {}), principal = scalar("largest_principal_stress", {}), pressure = scalar("pressure", {}),
             kind = scalar("kind", {});
  NamedField velocity{"velocity", 3, {}}, tensor{"stress", 6, {}};
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (body >= 0 && frame.body[i] != body) continue;
    part.points.push_back({float(frame.position[i][0]), float(frame.position[i][1]), float(frame.position[i][2])});
    stress.values.push_back(frame.von_mises[i]), principal.values.push_back(frame.principal_stress[i]),
        pressure.values.push_back(frame.pressure[i]);
    kind.values.push_back(frame.kind[i]);
    velocity.values.insert(velocity.values.end(), frame.velocity[i].begin(), frame.velocity[i].end());
    for (const int k : {0, 3, 5, 1, 4, 2}) tensor.values.push_back(frame.stress[i][static_cast<std::size_t>(k)]);  // VTK: xx yy zz xy yz xz
  }
  for (NamedField* field : {&stress, &principal, &pressure, &tensor}) field->units = "Pa";
  velocity.units = "m/s";
  part.fields = {stress, principal, pressure, kind, velocity, tensor};
  part.time = frame.time;
  return part;
}

void write_csv(const sim::RunFrame& frame, const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw std::runtime_error(file.string() + ": can't be written; is the folder there?");
  out << "# " << standing_notice << "; SI units (m, m/s, Pa); t = " << frame.time << " s\n";
  out << "id,kind,body,x,y,z,vx,vy,vz,pressure,von_mises,principal_stress,sxx,sxy,sxz,syy,syz,szz\n";
  out.precision(9);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    out << frame.id[i] << "," << int(frame.kind[i]) << "," << frame.body[i];
    for (double x : frame.position[i]) out << "," << x;
    for (float v : frame.velocity[i]) out << "," << v;
    out << "," << frame.pressure[i] << "," << frame.von_mises[i] << "," << frame.principal_stress[i];
    for (float s : frame.stress[i]) out << "," << s;
    out << "\n";
  }
}

std::size_t nearest(const sim::RunReader& run, double time) {
  std::size_t best = run.frame_count() - 1;
  for (std::size_t k = 0; time >= 0 && k < run.frame_count(); ++k)
    if (std::abs(run.frame_time(k) - time) < std::abs(run.frame_time(best) - time)) best = k;
  return best;
}

void export_frame(const sim::RunReader& run, std::size_t index, const Options& options, const std::filesystem::path& stem) {
  const sim::RunFrame frame = run.frame(index);
  char number[16];
  std::snprintf(number, sizeof number, "_%04zu", index);
  const std::string base = stem.string() + number;
  const auto say = [](const std::string& file) { std::printf("%s\n", file.c_str()); };
  if (options.csv) write_csv(frame, base + ".csv"), say(base + ".csv");
  if (options.vtp) write_vtp(part_of(frame, -1), base + "_particles.vtp"), say(base + "_particles.vtp");
  if (options.ply) write_ply(part_of(frame, -1), base + "_particles.ply"), say(base + "_particles.ply");
  for (const sim::RunHeader::ShellInfo& shell : run.header().shells) {
    ExportSurface surface = part_of(frame, shell.body);
    for (const auto& element : shell.elements)
      if (element[2] >= 0) surface.triangles.push_back(element);
    if (surface.triangles.empty()) continue;
    const std::string name = base + "_" + run.header().bodies[static_cast<std::size_t>(shell.body)].name;
    if (options.vtp) write_vtp(surface, name + ".vtp"), say(name + ".vtp");
    if (options.ply) write_ply(surface, name + ".ply"), say(name + ".ply");
    if (options.gltf) write_gltf(surface, name + ".gltf"), say(name + ".gltf");
  }
}

int export_run(Options options) {
  std::unique_ptr<sim::RunReader> run;
  try {
    run = std::make_unique<sim::RunReader>(options.run);
  } catch (const std::runtime_error& error) {
    throw SceneError(error.what());
  }
  if (run->frame_count() == 0) throw SceneError(options.run + ": holds no frame");
  if (!options.vtp && !options.ply && !options.gltf && !options.csv) options.vtp = true;
  std::filesystem::path stem =
      options.output.empty() ? std::filesystem::path(options.run).replace_extension() : std::filesystem::path(options.output);
  if (!options.output.empty()) {
    std::filesystem::create_directories(stem);
    stem /= std::filesystem::path(options.run).stem();
  }
  if (!options.every) export_frame(*run, nearest(*run, options.time), options, stem);
  for (std::size_t k = 0; options.every && k < run->frame_count(); ++k) export_frame(*run, k, options, stem);
  return 0;
}

}  // namespace

void add_export_command(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("export", "write leaflets and particles of a run in others' formats");
  command->footer("Example: cusp export run.h5 --vtp --gltf --time 0.12 -o exported");
  command->add_option("RUN", options->run, "run file (.h5)")->required();
  command->add_flag("--vtp", options->vtp, "VTK polydata: particles, and each leaflet as a surface (the default)");
  command->add_flag("--ply", options->ply, "PLY: the same");
  command->add_flag("--gltf", options->gltf, "glTF: leaflets, coloured by von Mises stress");
  command->add_flag("--csv", options->csv, "CSV: one row a particle");
  command->add_option("--time", options->time, "s: the nearest frame (default: the last)");
  command->add_flag("--every", options->every, "all frames");
  command->add_option("-o,--output", options->output, "folder (default: beside the run)");
  command->callback([options, &exit_code] { exit_code = export_run(*options); });
}

}  // namespace app
