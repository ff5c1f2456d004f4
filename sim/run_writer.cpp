#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "sim/journal_file.h"
#include "sim/run_layout.h"
#include "sim/xdmf.h"

namespace sim {
namespace {

namespace fs = std::filesystem;

fs::path beside(const fs::path& file, const std::string& suffix) {
  fs::path result = file;
  return result.replace_extension(suffix);
}

std::string csv_line(const std::vector<double>& values) {
  std::string line;
  char number[32];
  for (double value : values) {
    std::snprintf(number, sizeof number, "%.10g", value);
    if (!line.empty()) line += ',';
    line += number;
  }
  return line + "\n";
}

std::string csv_heading(const std::vector<std::string>& columns) {
  std::string line;
  for (const std::string& column : columns) line += (line.empty() ? "" : ",") + column;
  return line + "\n";
}

void write_file(const fs::path& file, const std::string& text, bool append) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (append ? O_APPEND : O_TRUNC), 0666);
  const off_t before = descriptor >= 0 ? lseek(descriptor, 0, SEEK_END) : 0;
  errno = 0;
  const bool good = descriptor >= 0 && ::write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const std::string why = errno ? std::strerror(errno) : "the disk is full";
  if (descriptor >= 0 && !good && ftruncate(descriptor, before) != 0) errno = 0;  // no half row; where even that fails, --continue mends it
  if (descriptor >= 0) close(descriptor);
  if (!good) throw std::runtime_error(file.string() + ": can't be written: " + why);
}

std::string line_text(const RunHeader::LineInfo& line, double time, const std::vector<double>& values) {
  const std::size_t components = line.components.size();
  std::string text;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    std::vector<double> row{time, line.points[i][0], line.points[i][1], line.points[i][2]};
    row.insert(row.end(), values.begin() + static_cast<std::ptrdiff_t>(i * components),
               values.begin() + static_cast<std::ptrdiff_t>((i + 1) * components));
    text += csv_line(row);
  }
  return text;
}

}  // namespace

struct RunWriter::Data {
  fs::path path;
  RunHeader header;
  h5::Handle file;
  std::unique_ptr<XdmfFile> xdmf;
  std::size_t frames = 0;
  std::vector<std::pair<double, std::size_t>> new_frames;  // time, particles; not yet in the XDMF
  std::string new_rows;                                    // not yet in the CSV
  std::vector<std::string> new_line_rows;

  fs::path csv() const { return beside(path, ".csv"); }
  fs::path line_csv(const RunHeader::LineInfo& line) const { return beside(path, "." + line.name + ".csv"); }

  void start_csv() {
    write_file(csv(), csv_heading(header.columns), false);
    for (const RunHeader::LineInfo& line : header.lines) {
      std::vector<std::string> columns{"time", "x", "y", "z"};
      columns.insert(columns.end(), line.components.begin(), line.components.end());
      write_file(line_csv(line), csv_heading(columns), false);
    }
    new_line_rows.resize(header.lines.size());
  }

  void rewrite_beside() {  // XDMF and CSV from what the run file holds
    xdmf = std::make_unique<XdmfFile>(beside(path, ".xmf"), path.filename().string());
    h5::Handle all = h5::group(file, "frames");
    for (std::size_t i = 0; i < frames; ++i) {
      h5::Handle group = h5::group(all, frame_name(i));
      xdmf->add_frame(frame_name(i), h5::number_attribute(group, "time"), h5::extent(group, "id").first);
    }
    start_csv();
    h5::Handle series = h5::group(file, "series");
    const std::size_t width = header.columns.size();
    const std::vector<double> values = h5::read_array<double>(series, "values");
    std::string text;
    for (std::size_t at = 0; at + width <= values.size(); at += width)
      text += csv_line({values.begin() + static_cast<std::ptrdiff_t>(at), values.begin() + static_cast<std::ptrdiff_t>(at + width)});
    write_file(csv(), text, true);
    h5::Handle lines = h5::group(file, "lines");
    for (const RunHeader::LineInfo& line : header.lines) {
      const std::size_t entries = line.points.size() * line.components.size();
      const std::vector<double> all_values = h5::read_array<double>(h5::group(lines, line.name), "values");
      text.clear();
      for (std::size_t row = 0; (row + 1) * entries <= all_values.size(); ++row)
        text += line_text(line, values[row * width],
                          {all_values.begin() + static_cast<std::ptrdiff_t>(row * entries),
                           all_values.begin() + static_cast<std::ptrdiff_t>((row + 1) * entries)});
      write_file(line_csv(line), text, true);
    }
  }
};

RunWriter::RunWriter(std::unique_ptr<Data> data) : data_(std::move(data)) {}
RunWriter::RunWriter(RunWriter&&) noexcept = default;
RunWriter& RunWriter::operator=(RunWriter&&) noexcept = default;
RunWriter::~RunWriter() = default;

RunWriter RunWriter::create(const fs::path& file, const RunHeader& header) {
  h5::quiet();
  std::error_code error;
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), error);
  if (recover_journal(file)) throw std::runtime_error(file.string() + ": another run is writing it; wait for it, or stop it");
  auto data = std::make_unique<Data>();
  data->path = file, data->header = header;
  h5::Handle access(journal_access(), H5Pclose, file.string());
  const hid_t opened = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  if (opened < 0) throw std::runtime_error(file.string() + ": can't be written: " + journal_problem());
  data->file = h5::Handle(opened, H5Fclose, file.string());
  write_header(data->file, header);
  h5::write_text(data->file, "status", "running");
  data->xdmf = std::make_unique<XdmfFile>(beside(file, ".xmf"), file.filename().string());
  data->start_csv();
  RunWriter writer(std::move(data));
  writer.finish();
  return writer;
}

RunWriter RunWriter::resume(const fs::path& file, const Checkpoint& checkpoint) {
  h5::quiet();
  if (recover_journal(file)) throw std::runtime_error(file.string() + ": another run is writing it; wait for it, or stop it");
  auto data = std::make_unique<Data>();
  data->path = file;
  h5::Handle access(journal_access(), H5Pclose, file.string());
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDWR, access);
  if (opened < 0) throw std::runtime_error(file.string() + ": can't be written: " + journal_problem());
  data->file = h5::Handle(opened, H5Fclose, file.string());
  data->header = read_header(data->file);
  data->frames = static_cast<std::size_t>(checkpoint.frames);
  {
    h5::Handle frames = h5::group(data->file, "frames");
    for (const std::string& name : h5::children(frames))
      if (name >= frame_name(data->frames)) h5::remove(frames, name);
    h5::cut_table(h5::group(data->file, "series"), "values", static_cast<std::size_t>(checkpoint.rows));
    h5::Handle lines = h5::group(data->file, "lines");
    for (const std::string& name : h5::children(lines))
      h5::cut_table(h5::group(lines, name), "values", static_cast<std::size_t>(checkpoint.rows));
  }
  data->rewrite_beside();
  RunWriter writer(std::move(data));
  writer.finish();
  return writer;
}

void RunWriter::add_frame(const RunFrame& frame) {
  h5::Handle frames = h5::group(data_->file, "frames");
  const std::string name = frame_name(data_->frames);
  h5::remove(frames, name);
  h5::Handle group = h5::group(frames, name);
  h5::set_attribute(group, "time", frame.time);
  h5::set_attribute(group, "step", frame.step);
  h5::write_array(group, "id", frame.id);
  h5::write_array(group, "kind", frame.kind);
  h5::write_array(group, "body", frame.body);
  const std::size_t rows = frame.size();
  h5::write_raw(group, "position", H5T_NATIVE_DOUBLE, frame.position.data(), rows, 3, "m", true);
  h5::write_raw(group, "velocity", H5T_NATIVE_FLOAT, frame.velocity.data(), rows, 3, "m/s", true);
  h5::write_array(group, "pressure", frame.pressure, 1, "Pa");
  h5::write_raw(group, "stress", H5T_NATIVE_FLOAT, frame.stress.data(), rows, 6, "Pa", true);
  h5::write_array(group, "von_mises", frame.von_mises, 1, "Pa");
  h5::write_array(group, "principal_stress", frame.principal_stress, 1, "Pa");
  data_->new_frames.emplace_back(frame.time, rows);
  ++data_->frames;
}

void RunWriter::add_row(const std::vector<double>& row, const std::vector<std::vector<double>>& line_values) {
  h5::append_row(h5::group(data_->file, "series"), "values", row);
  data_->new_rows += csv_line(row);
  h5::Handle lines = h5::group(data_->file, "lines");
  for (std::size_t i = 0; i < line_values.size(); ++i) {
    const RunHeader::LineInfo& line = data_->header.lines[i];
    h5::append_row(h5::group(lines, line.name), "values", line_values[i]);
    data_->new_line_rows[i] += line_text(line, row.front(), line_values[i]);
  }
}

template <int D>
void RunWriter::set_checkpoint(const State<D>& state, const Checkpoint& checkpoint) {
  h5::Handle group = h5::group(data_->file, "checkpoint");
  State<D>& readable = const_cast<State<D>&>(state);  // the visitor is written for both ways; nothing is changed
  for_each_array(readable, [&](const char* name, auto& array) {
    using Entry = typename std::decay_t<decltype(array)>::value_type;
    if constexpr (std::is_same_v<Entry, Kind>) {
      h5::write_raw(group, name, H5T_NATIVE_UINT8, array.data(), array.size(), 1, "", false);
    } else if constexpr (std::is_same_v<Entry, Vector<D>>) {
      h5::write_raw(group, name, H5T_NATIVE_DOUBLE, array.data(), array.size(), D, "", false);
    } else {
      h5::write_raw(group, name, h5::type_of<Entry>(), array.data(), array.size(), 1, "", false);
    }
  });
  for_each_scalar(state, [&](const char* name, const auto& value) { h5::set_attribute(group, name, value); });
  h5::set_attribute(group, "frames", checkpoint.frames);
  h5::set_attribute(group, "rows", checkpoint.rows);
  h5::set_attribute(group, "wall_seconds", checkpoint.wall_seconds);
  h5::set_attribute(group, "next_output", checkpoint.next_output);
  h5::Handle memory = h5::group(group, "memory");
  for (const auto& [name, values] : checkpoint.memory) h5::write_array(memory, name, values, 1, "", false);
  h5::set_attribute(group, "taken", static_cast<std::int64_t>(1));
}
template void RunWriter::set_checkpoint<2>(const State<2>&, const Checkpoint&);
template void RunWriter::set_checkpoint<3>(const State<3>&, const Checkpoint&);

void RunWriter::add_warning(const std::string& text) {
  h5::write_text(data_->file, "warnings", h5::read_text(data_->file, "warnings") + text + "\n");
}

void RunWriter::set_status(const std::string& status, double wall_seconds, std::int64_t steps) {
  h5::write_text(data_->file, "status", status);
  h5::set_attribute(data_->file, "wall_seconds", wall_seconds);
  h5::set_attribute(data_->file, "steps", steps);
}

void RunWriter::finish() {
  if (H5Fflush(data_->file, H5F_SCOPE_GLOBAL) < 0) throw std::runtime_error(data_->path.string() + ": can't be written; is the disk full? What was finished before is kept");
  std::size_t number = data_->frames - data_->new_frames.size();
  for (const auto& [time, particles] : data_->new_frames) data_->xdmf->add_frame(frame_name(number++), time, particles);
  data_->new_frames.clear();
  if (!data_->new_rows.empty()) write_file(data_->csv(), data_->new_rows, true);
  data_->new_rows.clear();
  for (std::size_t i = 0; i < data_->new_line_rows.size(); ++i) {
    if (!data_->new_line_rows[i].empty()) write_file(data_->line_csv(data_->header.lines[i]), data_->new_line_rows[i], true);
    data_->new_line_rows[i].clear();
  }
}

}  // namespace sim
