// The little of HDF5 that run files need: owned handles, arrays of numbers, texts. Throws std::runtime_error naming the object.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace sim::h5 {

class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what);  // throws where id < 0
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }
  bool open() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

template <class T>
hid_t type_of();
template <>
inline hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
inline hid_t type_of<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
inline hid_t type_of<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
inline hid_t type_of<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
inline hid_t type_of<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

void quiet();                                         // the library prints no error stacks of its own
Handle group(hid_t parent, const std::string& name);  // opened, or made
bool exists(hid_t parent, const std::string& name);
void remove(hid_t parent, const std::string& name);  // where it exists
std::vector<std::string> children(hid_t parent);     // sorted

// Array of rows x columns (columns = 1: one-dimensional). Compressed where `compress`. Replaces what has the name.
void write_raw(hid_t parent, const std::string& name, hid_t type, const void* data, std::size_t rows, std::size_t columns,
               const std::string& units, bool compress);
template <class T>
void write_array(hid_t parent, const std::string& name, const std::vector<T>& data, std::size_t columns = 1, const std::string& units = "",
                 bool compress = true) {
  write_raw(parent, name, type_of<T>(), data.data(), data.size() / columns, columns, units, compress);
}
std::pair<std::size_t, std::size_t> extent(hid_t parent, const std::string& name);  // rows, columns; refuses more than the file can hold
void read_raw(hid_t parent, const std::string& name, hid_t type, void* data);
template <class T>
std::vector<T> read_array(hid_t parent, const std::string& name) {
  const auto [rows, columns] = extent(parent, name);
  std::vector<T> data(rows * columns);
  if (!data.empty()) read_raw(parent, name, type_of<T>(), data.data());
  return data;
}

// A table that grows by rows.
void make_table(hid_t parent, const std::string& name, std::size_t columns);
void append_row(hid_t parent, const std::string& name, const std::vector<double>& row);
void cut_table(hid_t parent, const std::string& name, std::size_t rows);  // keeps the first `rows`

void write_text(hid_t parent, const std::string& name, const std::string& text);  // a dataset; replaces
std::string read_text(hid_t parent, const std::string& name, const std::string& fallback = "");
void set_attribute(hid_t object, const std::string& name, double value);
void set_attribute(hid_t object, const std::string& name, std::int64_t value);
void set_attribute(hid_t object, const std::string& name, const std::string& value);
double number_attribute(hid_t object, const std::string& name, double fallback = 0);
std::int64_t integer_attribute(hid_t object, const std::string& name, std::int64_t fallback = 0);
std::string text_attribute(hid_t object, const std::string& name, const std::string& fallback = "");

}  // namespace sim::h5
