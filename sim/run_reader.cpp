#include <sstream>
#include <stdexcept>

#include "sim/journal_file.h"
#include "sim/run_layout.h"

namespace sim {

struct RunReader::Data {
  std::filesystem::path path;
  h5::Handle file;
  RunHeader header;
  std::vector<std::string> frames;
};

RunReader::RunReader(const std::filesystem::path& file) : data_(std::make_unique<Data>()) {
  h5::quiet();
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": no such file; give a run file (.h5)");
  recover_journal(file);
  data_->path = file;
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (opened < 0) throw std::runtime_error(file.string() + ": is no HDF5 file, or was killed before its first frame; run it again");
  data_->file = h5::Handle(opened, H5Fclose, file.string());
  const std::int64_t version = h5::integer_attribute(data_->file, "layout_version", 0);
  if (version < 1) throw std::runtime_error(file.string() + ": is no run of this program; give a file written by `cusp run`");
  if (version > run_layout_version) throw std::runtime_error(file.string() + ": was written by a newer program; update cusp");
  data_->header = read_header(data_->file);
  data_->frames = h5::children(h5::group(data_->file, "frames"));
}

RunReader::RunReader(RunReader&&) noexcept = default;
RunReader::~RunReader() = default;

const RunHeader& RunReader::header() const { return data_->header; }
std::size_t RunReader::frame_count() const { return data_->frames.size(); }

double RunReader::frame_time(std::size_t frame) const {
  return h5::number_attribute(h5::group(h5::group(data_->file, "frames"), data_->frames.at(frame)), "time");
}

RunFrame RunReader::frame(std::size_t frame) const {
  h5::Handle group = h5::group(h5::group(data_->file, "frames"), data_->frames.at(frame));
  RunFrame result;
  result.time = h5::number_attribute(group, "time");
  result.step = h5::integer_attribute(group, "step");
  result.id = h5::read_array<std::int64_t>(group, "id");
  result.kind = h5::read_array<std::uint8_t>(group, "kind");
  result.body = h5::read_array<std::int32_t>(group, "body");
  const std::size_t rows = result.id.size();
  const auto check = [&](const char* name, std::size_t columns) {
    if (h5::extent(group, name) != std::pair<std::size_t, std::size_t>{rows, columns})
      throw std::runtime_error(data_->path.string() + ": frame " + data_->frames[frame] + ": " + name + " has a wrong size");
  };
  const auto read = [&](const char* name, auto& array, hid_t type, std::size_t columns) {
    check(name, columns);
    array.resize(rows);
    if (rows > 0) h5::read_raw(group, name, type, array.data());
  };
  read("position", result.position, H5T_NATIVE_DOUBLE, 3);
  read("velocity", result.velocity, H5T_NATIVE_FLOAT, 3);
  read("pressure", result.pressure, H5T_NATIVE_FLOAT, 1);
  read("stress", result.stress, H5T_NATIVE_FLOAT, 6);
  read("von_mises", result.von_mises, H5T_NATIVE_FLOAT, 1);
  read("principal_stress", result.principal_stress, H5T_NATIVE_FLOAT, 1);
  return result;
}

namespace {
std::vector<std::vector<double>> table(hid_t group) {
  const auto [rows, columns] = h5::extent(group, "values");
  const std::vector<double> values = h5::read_array<double>(group, "values");
  std::vector<std::vector<double>> result(rows);
  for (std::size_t i = 0; i < rows; ++i)
    result[i].assign(values.begin() + static_cast<std::ptrdiff_t>(i * columns),
                     values.begin() + static_cast<std::ptrdiff_t>((i + 1) * columns));
  return result;
}
}  // namespace

std::vector<std::vector<double>> RunReader::series() const { return table(h5::group(data_->file, "series")); }

std::vector<double> RunReader::column(const std::string& name) const {
  std::vector<double> result;
  for (std::size_t k = 0; k < data_->header.columns.size(); ++k)
    if (data_->header.columns[k] == name)
      for (const auto& row : series()) result.push_back(row[k]);
  return result;
}

std::vector<std::vector<double>> RunReader::line(const std::string& name) const {
  h5::Handle lines = h5::group(data_->file, "lines");
  if (!h5::exists(lines, name)) throw std::runtime_error(data_->path.string() + ": has no line probe \"" + name + "\"");
  return table(h5::group(lines, name));
}

std::vector<std::string> RunReader::warnings() const {
  std::vector<std::string> result;
  std::stringstream text(h5::read_text(data_->file, "warnings"));
  for (std::string line; std::getline(text, line);) result.push_back(line);
  return result;
}

std::string RunReader::status() const { return h5::read_text(data_->file, "status"); }
double RunReader::wall_seconds() const { return h5::number_attribute(data_->file, "wall_seconds"); }
std::int64_t RunReader::steps() const { return h5::integer_attribute(data_->file, "steps"); }
bool RunReader::has_checkpoint() const {
  return h5::exists(data_->file, "checkpoint") && h5::integer_attribute(h5::group(data_->file, "checkpoint"), "taken") != 0;
}

template <int D>
std::pair<State<D>, Checkpoint> RunReader::checkpoint() const {
  if (!has_checkpoint()) throw std::runtime_error(data_->path.string() + ": holds no checkpoint; start the run again without --continue");
  if (data_->header.dimension != D) throw std::runtime_error(data_->path.string() + ": is a run in another dimension");
  h5::Handle group = h5::group(data_->file, "checkpoint");
  State<D> state;
  for_each_array(state, [&](const char* name, auto& array) {
    using Entry = typename std::decay_t<decltype(array)>::value_type;
    const auto [rows, columns] = h5::extent(group, name);
    array.resize(rows);
    if (rows == 0) return;
    if constexpr (std::is_same_v<Entry, Kind>) {
      h5::read_raw(group, name, H5T_NATIVE_UINT8, array.data());
    } else if constexpr (std::is_same_v<Entry, Vector<D>>) {
      if (columns != D) throw std::runtime_error(data_->path.string() + ": the checkpoint is damaged");
      h5::read_raw(group, name, H5T_NATIVE_DOUBLE, array.data());
    } else {
      h5::read_raw(group, name, h5::type_of<Entry>(), array.data());
    }
  });
  for_each_scalar(state, [&](const char* name, auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>) {
      value = h5::number_attribute(group, name, value);
    } else {
      value = h5::integer_attribute(group, name, value);
    }
  });
  Checkpoint checkpoint;
  checkpoint.frames = h5::integer_attribute(group, "frames");
  checkpoint.rows = h5::integer_attribute(group, "rows");
  checkpoint.wall_seconds = h5::number_attribute(group, "wall_seconds");
  checkpoint.next_output = h5::number_attribute(group, "next_output");
  if (h5::exists(group, "memory")) {
    h5::Handle memory = h5::group(group, "memory");
    for (const std::string& name : h5::children(memory)) checkpoint.memory[name] = h5::read_array<double>(memory, name);
  }
  return {std::move(state), checkpoint};
}
template std::pair<State<2>, Checkpoint> RunReader::checkpoint<2>() const;
template std::pair<State<3>, Checkpoint> RunReader::checkpoint<3>() const;

}  // namespace sim
