#include "fuzz/targets.h"

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "app/scene_file.h"
#include "geometry/mesh_readers.h"
#include "sim/run_file.h"

namespace fuzz {
namespace {

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// A file of this process's own with the bytes in it, in memory where there is /dev/shm.
std::string file_with(Bytes bytes, const char* ending) {
  static const std::string folder = std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path().string();
  const std::string path = folder + "/cusp_fuzz_" + std::to_string(getpid()) + ending;
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0 || write(file, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
    throw std::logic_error("can't write " + path);
  close(file);
  return path;
}

}  // namespace

void mesh(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  geometry::detail::sniff_format(text);
  for (const auto& read : {geometry::detail::read_vtp, geometry::detail::read_legacy_vtk}) {
    try {
      geometry::LoadedMesh loaded = read(text);
      geometry::detail::check_loaded(loaded, text);
    } catch (const std::runtime_error&) {
    }
  }
}

void scene(Bytes bytes) {
  std::string text(text_of(bytes));
  std::vector<std::string> settings;
  if (text.rfind("#set ", 0) == 0) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    settings.push_back(text.substr(5, end - 5));
  }
  try {
    app::parse_scene_text(text, "/nowhere/scene.toml", settings);
  } catch (const app::SceneError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) throw std::logic_error("a refusal of more than one line");
  }
}

void wave(Bytes bytes) {
  const std::string path = file_with(bytes, ".csv");
  try {
    const sim::TimeTable table = app::read_time_table(path, {"scene.toml", 1, "port.inlet.pressure"});
    for (double t : {-1.0, 0.0, 0.1, 1e9})
      if (!(table.at(t) == table.at(t))) throw std::logic_error("a table that was accepted has no number somewhere");
  } catch (const app::SceneError&) {
  }
}

void run(Bytes bytes) {
  const std::string path = file_with(bytes, ".h5");
  try {
    const sim::RunReader reader(path);
    reader.series(), reader.warnings(), reader.status();
    for (const auto& line : reader.header().lines) reader.line(line.name);
    for (std::size_t k = 0; k < std::min<std::size_t>(reader.frame_count(), 3); ++k) reader.frame_time(k), reader.frame(k);
    if (reader.has_checkpoint() && reader.header().dimension == 2) reader.checkpoint<2>();
  } catch (const std::runtime_error&) {
  }
}

}  // namespace fuzz
