#include "app/run_case.h"

#include <omp.h>

#include <cstdio>

#include "app/limits.h"
#include "app/progress.h"

namespace app {
namespace {

sim::RunSurface surface_of(const geometry::TriangleMesh& mesh) {
  sim::RunSurface surface;
  for (const Eigen::Vector3d& v : mesh.vertices)
    surface.vertices.push_back({static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])});
  surface.triangles = mesh.triangles;
  return surface;
}

// The scene's folder as seen from the run file, so that both can be moved together and no absolute path is stored.
std::string folder_from(const std::filesystem::path& run, const std::filesystem::path& scene) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::weakly_canonical(fs::absolute(scene)).parent_path(),
                 base = fs::weakly_canonical(fs::absolute(run)).parent_path();
  return folder.lexically_relative(base).string();
}

}  // namespace

sim::RunResult run_case(const SceneFile& scene_file, const RunCaseOptions& options) {
  if (options.threads > 0) omp_set_num_threads(options.threads);
  const MemoryLimit memory(scene_file.limits.memory);
  sim::RunResult result;
  with_scene(scene_file, options, [&](auto& built, const auto& scene) {
    sim::RunSetup setup;
    setup.file = options.output, setup.resume = options.resume, setup.checkpoint_seconds = options.checkpoint_seconds;
    setup.trace_events = options.trace_events;
    setup.header.program_version = CUSP_VERSION;
    setup.header.scene_text = scene_file.text, setup.header.settings = scene_file.settings;
    setup.header.scene_name = scene_file.path.filename().string();
    setup.header.scene_folder = folder_from(options.output, scene_file.path);
    setup.header.lumen = surface_of(built.lumen);
    setup.warnings = built.warnings;
    if (!options.quiet)
      for (const std::string& warning : built.warnings) std::fprintf(stderr, "warning: %s\n", warning.c_str());
    ProgressPrinter printer(options.quiet);
    setup.progress = [&](const sim::RunProgress& progress) {
      printer(progress);
      if (options.progress) options.progress(progress);
    };
    setup.stop = &stop_on_signal();
    result = sim::run(scene, setup);
    printer.finish();
  });
  return result;
}

}  // namespace app
