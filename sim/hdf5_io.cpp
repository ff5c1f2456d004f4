#include "sim/hdf5_io.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace sim::h5 {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error("run file: can't access " + what + " (disk full, or no file of this program?)");
}

void check(herr_t status, const std::string& what) {
  if (status < 0) fail(what);
}

Handle open_set(hid_t parent, const std::string& name) { return {H5Dopen2(parent, name.c_str(), H5P_DEFAULT), H5Dclose, name}; }

Handle text_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "text type");
  H5Tset_size(type, std::max<std::size_t>(1, size));
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

template <class Write>
void replace_attribute(hid_t object, const std::string& name, hid_t type, const Write& write) {
  if (H5Aexists(object, name.c_str()) > 0) check(H5Adelete(object, name.c_str()), name);
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  write(attribute);
}

}  // namespace

Handle::Handle(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
  if (id < 0) fail(what);
}

void quiet() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

bool exists(hid_t parent, const std::string& name) { return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0; }

Handle group(hid_t parent, const std::string& name) {
  if (exists(parent, name)) return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, name};
  return {H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, name};
}

void remove(hid_t parent, const std::string& name) {
  if (exists(parent, name)) check(H5Ldelete(parent, name.c_str(), H5P_DEFAULT), name);
}

std::vector<std::string> children(hid_t parent) {
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  check(H5Literate(parent, H5_INDEX_NAME, H5_ITER_INC, nullptr, visit, &names), "the list of a group");
  std::sort(names.begin(), names.end());
  return names;
}

void write_raw(hid_t parent, const std::string& name, hid_t type, const void* data, std::size_t rows, std::size_t columns,
               const std::string& units, bool compress) {
  remove(parent, name);
  const std::array<hsize_t, 2> size{rows, columns};
  Handle space(H5Screate_simple(columns == 1 ? 1 : 2, size.data(), nullptr), H5Sclose, name);
  Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  if (compress && rows * columns > 256) {
    const std::array<hsize_t, 2> chunk{std::min<hsize_t>(rows, 65536), columns};
    H5Pset_chunk(create, columns == 1 ? 1 : 2, chunk.data());
    H5Pset_shuffle(create);
    H5Pset_deflate(create, 1);
  }
  Handle set(H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, create, H5P_DEFAULT), H5Dclose, name);
  if (rows * columns > 0) check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), name);
  if (!units.empty()) set_attribute(set, "units", units);
}

namespace {

// A damaged or hostile file may claim any extent; no array of the file is larger than the file unpacked, and deflate packs 1032 to 1 at
// most.
hsize_t most_entries(hid_t object) {
  constexpr hsize_t packed = 1100, always = 16 << 20;
  Handle file(H5Iget_file_id(object), H5Fclose, "the file");
  hsize_t bytes = 0;
  check(H5Fget_filesize(file, &bytes), "the file's size");
  return std::max(always, packed * bytes);
}

// No more entries than there are chunks for either: the library plans a piece of work for every chunk that an extent claims, kept or not,
// and a damaged extent over small chunks would fill all memory.
hsize_t most_entries(hid_t set, hid_t space, const std::string& name) {
  const hsize_t most = most_entries(set);
  Handle create(H5Dget_create_plist(set), H5Pclose, name);
  if (H5Pget_layout(create) != H5D_CHUNKED) return most;
  std::array<hsize_t, 2> chunk{1, 1};
  if (H5Pget_chunk(create, 2, chunk.data()) < 1) fail(name);
  hsize_t chunks = 0;
  check(H5Dget_num_chunks(set, space, &chunks), name);
  const hsize_t entries = std::max<hsize_t>(1, chunk[0]) * std::max<hsize_t>(1, chunk[1]);
  return chunks > most / entries ? most : chunks * entries;
}

}  // namespace

std::pair<std::size_t, std::size_t> extent(hid_t parent, const std::string& name) {
  Handle set = open_set(parent, name);
  Handle space(H5Dget_space(set), H5Sclose, name);
  std::array<hsize_t, 2> size{0, 1};
  if (H5Sget_simple_extent_ndims(space) > 2) fail(name);
  check(H5Sget_simple_extent_dims(space, size.data(), nullptr), name);
  if (size[1] > 0 && size[0] > most_entries(set, space, name) / size[1]) fail(name);
  return {size[0], size[1]};
}

void read_raw(hid_t parent, const std::string& name, hid_t type, void* data) {
  Handle set = open_set(parent, name);
  check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), name);
}

void make_table(hid_t parent, const std::string& name, std::size_t columns) {
  const std::array<hsize_t, 2> size{0, columns}, limit{H5S_UNLIMITED, columns},
      chunk{std::max<hsize_t>(1, 8192 / std::max<std::size_t>(1, columns)), columns};
  Handle space(H5Screate_simple(2, size.data(), limit.data()), H5Sclose, name);
  Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  H5Pset_chunk(create, 2, chunk.data());
  Handle set(H5Dcreate2(parent, name.c_str(), H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, create, H5P_DEFAULT), H5Dclose, name);
}

void append_row(hid_t parent, const std::string& name, const std::vector<double>& row) {
  const auto [rows, columns] = extent(parent, name);
  if (columns != row.size()) fail(name);
  Handle set = open_set(parent, name);
  const std::array<hsize_t, 2> size{rows + 1, columns}, start{rows, 0}, count{1, columns};
  check(H5Dset_extent(set, size.data()), name);
  Handle space(H5Dget_space(set), H5Sclose, name);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  Handle memory(H5Screate_simple(2, count.data(), nullptr), H5Sclose, name);
  check(H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, row.data()), name);
}

void cut_table(hid_t parent, const std::string& name, std::size_t rows) {
  const auto [present, columns] = extent(parent, name);
  if (rows >= present) return;
  Handle set = open_set(parent, name);
  const std::array<hsize_t, 2> size{rows, columns};
  check(H5Dset_extent(set, size.data()), name);
}

void write_text(hid_t parent, const std::string& name, const std::string& text) {
  remove(parent, name);
  Handle type = text_type(text.size());
  Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  Handle set(H5Dcreate2(parent, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose, name);
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  check(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), name);
}

std::string read_text(hid_t parent, const std::string& name, const std::string& fallback) {
  if (!exists(parent, name)) return fallback;
  Handle set = open_set(parent, name);
  Handle type(H5Dget_type(set), H5Tclose, name);
  if (H5Tget_size(type) > most_entries(set)) fail(name);
  std::string text(H5Tget_size(type), '\0');
  check(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), name);
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

void set_attribute(hid_t object, const std::string& name, double value) {
  replace_attribute(object, name, H5T_NATIVE_DOUBLE, [&](hid_t a) { check(H5Awrite(a, H5T_NATIVE_DOUBLE, &value), name); });
}
void set_attribute(hid_t object, const std::string& name, std::int64_t value) {
  replace_attribute(object, name, H5T_NATIVE_INT64, [&](hid_t a) { check(H5Awrite(a, H5T_NATIVE_INT64, &value), name); });
}
void set_attribute(hid_t object, const std::string& name, const std::string& value) {
  Handle type = text_type(value.size());
  const std::string padded = value.empty() ? std::string(1, '\0') : value;
  replace_attribute(object, name, type, [&](hid_t a) { check(H5Awrite(a, type, padded.data()), name); });
}

double number_attribute(hid_t object, const std::string& name, double fallback) {
  if (H5Aexists(object, name.c_str()) <= 0) return fallback;
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  check(H5Aread(attribute, H5T_NATIVE_DOUBLE, &fallback), name);
  return fallback;
}

std::int64_t integer_attribute(hid_t object, const std::string& name, std::int64_t fallback) {
  if (H5Aexists(object, name.c_str()) <= 0) return fallback;
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  check(H5Aread(attribute, H5T_NATIVE_INT64, &fallback), name);
  return fallback;
}

std::string text_attribute(hid_t object, const std::string& name, const std::string& fallback) {
  if (H5Aexists(object, name.c_str()) <= 0) return fallback;
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, name);
  Handle type(H5Aget_type(attribute), H5Tclose, name);
  if (H5Tget_size(type) > most_entries(attribute)) fail(name);
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), name);
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

}  // namespace sim::h5
