// RUN.h5 with RUN.xmf and RUN.csv beside it (docs/run_file.md): written frame by frame so that a run killed at any moment keeps every
// finished frame; read by render, report, export, info. Nothing here knows a solver: frames are plain arrays, three-dimensional throughout
// (z = 0 in 2-D), SI units.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/particles.h"
#include "sim/scene_description.h"

namespace sim {

struct RunSurface {                            // for drawing: the vessel's lumen
  std::vector<std::array<float, 3>> vertices;  // m
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// What stands once in a run file.
struct RunHeader {
  int layout_version = 1;
  std::string program_version, title, scene_name, scene_text;
  std::string scene_folder;           // of the scene's relative paths, relative to the run file where possible
  std::vector<std::string> settings;  // the --set on top of scene_text
  std::string scheme;                 // "accurate" or "paper"
  int dimension = 3;
  double spacing = 0, end = 0, output = 0;
  bool statics = false;
  struct BodyInfo {
    std::string name;
    Kind kind = Kind::fluid;
    std::int64_t first = 0, count = 0;  // rows at the start
    double density = 0, youngs_modulus = 0, poisson_ratio = 0, thickness = 0;
    std::string material;  // law or rheology in words
  };
  std::vector<BodyInfo> bodies;
  struct ShellInfo {
    std::int32_t body = -1;
    std::vector<std::array<std::int32_t, 3>> elements;  // 2-D: the third is -1
  };
  std::vector<ShellInfo> shells;
  std::vector<std::string> ports;
  std::optional<ValveFrame> valve;
  RunSurface lumen;
  std::vector<std::string> columns;  // of the series, "time" first
  std::vector<std::string> units;    // of the columns
  struct LineInfo {
    std::string name, units;
    std::vector<std::array<double, 3>> points;
    std::vector<std::string> components;  // "value", or "value.x", ...
  };
  std::vector<LineInfo> lines;
};

// One frame: all particles of one moment. Arrays have one row a particle; stress entries are 0 where there is no elastic particle.
struct RunFrame {
  double time = 0;  // s (static: load factor)
  std::int64_t step = 0;
  std::vector<std::int64_t> id;
  std::vector<std::uint8_t> kind;  // sim::Kind
  std::vector<std::int32_t> body;
  std::vector<std::array<double, 3>> position;     // m
  std::vector<std::array<float, 3>> velocity;      // m/s
  std::vector<float> pressure;                     // Pa
  std::vector<std::array<float, 6>> stress;        // Pa, Cauchy: xx xy xz yy yz zz
  std::vector<float> von_mises, principal_stress;  // Pa
  std::size_t size() const { return position.size(); }
};

using NamedNumbers = std::map<std::string, std::vector<double>>;

// Everything a run goes on from, beside the state.
struct Checkpoint {
  std::int64_t frames = 0, rows = 0;  // finished when it was taken
  double wall_seconds = 0;            // spent so far
  double next_output = 0;             // s
  NamedNumbers memory{};              // of the solver (work_memory.h)
};

class RunWriter {
 public:
  // Replaces what is there.
  static RunWriter create(const std::filesystem::path& file, const RunHeader& header);
  // Goes on with a run from its last checkpoint: frames and rows after it are dropped.
  static RunWriter resume(const std::filesystem::path& file, const Checkpoint& checkpoint);
  RunWriter(RunWriter&&) noexcept;
  RunWriter& operator=(RunWriter&&) noexcept;
  ~RunWriter();

  void add_frame(const RunFrame& frame);
  void add_row(const std::vector<double>& row,
               const std::vector<std::vector<double>>& line_values);  // one entry a column; a line, points x components
  template <int D>
  void set_checkpoint(const State<D>& state, const Checkpoint& checkpoint);
  void add_warning(const std::string& text);
  void set_status(const std::string& status, double wall_seconds,
                  std::int64_t steps);  // "running", "finished", "stopped: ...", "failed: ..."
  void finish();                        // makes all of it one finished state on disk, the XDMF and the CSV too

 private:
  struct Data;
  explicit RunWriter(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

class RunReader {
 public:
  // Throws std::runtime_error (one line) where the file is no run.
  explicit RunReader(const std::filesystem::path& file);
  RunReader(RunReader&&) noexcept;
  ~RunReader();

  const RunHeader& header() const;
  std::size_t frame_count() const;
  double frame_time(std::size_t frame) const;
  RunFrame frame(std::size_t frame) const;
  std::vector<std::vector<double>> series() const;                       // rows, one entry a column
  std::vector<double> column(const std::string& name) const;             // empty where there is none
  std::vector<std::vector<double>> line(const std::string& name) const;  // rows: points x components, flat
  std::vector<std::string> warnings() const;
  std::string status() const;
  double wall_seconds() const;
  std::int64_t steps() const;
  bool has_checkpoint() const;
  template <int D>
  std::pair<State<D>, Checkpoint> checkpoint() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

RunHeader::BodyInfo body_info(const Body& body);

}  // namespace sim
