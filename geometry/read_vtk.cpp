#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

#include "geometry/mesh_readers.h"
#include "geometry/vtk_bytes.h"

namespace geometry::detail {
namespace {

// --- polygons -> triangles, shared by both dialects --------------------------------------------------------------------------------------

std::int32_t checked_index(double value, std::size_t vertices) {
  if (!(value >= 0) || value >= double(vertices))
    throw std::runtime_error("is malformed: a face names a vertex that does not exist; export it again");
  return std::int32_t(value);
}

// A polygon as a fan from its first corner.
void append_polygon(const double* corners, std::size_t count, std::size_t first_vertex, std::size_t vertices, std::int32_t group,
                    LoadedMesh& out) {
  for (std::size_t c = 2; c < count; ++c) {
    std::array<std::int32_t, 3> triangle;
    const double picked[3] = {corners[0], corners[c - 1], corners[c]};
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = std::int32_t(first_vertex) + checked_index(picked[k], vertices);
    out.mesh.triangles.push_back(triangle);
    out.group_of_triangle.push_back(group);
  }
}

// A strip's triangles, every second one turned round.
void append_strip(const double* corners, std::size_t count, std::size_t first_vertex, std::size_t vertices, std::int32_t group,
                  LoadedMesh& out) {
  for (std::size_t c = 2; c < count; ++c) {
    double picked[3] = {corners[c - 2], corners[c - 1], corners[c]};
    if (c % 2 == 1) std::swap(picked[0], picked[1]);
    append_polygon(picked, 3, first_vertex, vertices, group, out);
  }
}

void append_points(const std::vector<double>& values, LoadedMesh& out) {
  for (std::size_t v = 0; v + 2 < values.size(); v += 3) out.mesh.vertices.emplace_back(values[v], values[v + 1], values[v + 2]);
}

std::int32_t group_named(const std::string& name, LoadedMesh& out) {
  const auto found = std::find(out.group_names.begin(), out.group_names.end(), name);
  if (found != out.group_names.end()) return std::int32_t(found - out.group_names.begin());
  out.group_names.push_back(name);
  return std::int32_t(out.group_names.size()) - 1;
}

using Appender = void (*)(const double*, std::size_t, std::size_t, std::size_t, std::int32_t, LoadedMesh&);

void append_cells(const std::vector<double>& connectivity, const std::vector<double>& ends, std::size_t first_vertex,
                  const std::vector<double>& face_ids, std::size_t first_cell, Appender append, LoadedMesh& out) {
  const std::size_t vertices = out.mesh.vertices.size() - first_vertex;
  std::size_t begin = 0;
  for (std::size_t cell = 0; cell < ends.size(); ++cell) {
    if (!(ends[cell] >= double(begin)) || ends[cell] > double(connectivity.size()))
      throw std::runtime_error("is malformed: its cell offsets do not fit; export it again");
    const auto end = std::size_t(ends[cell]);
    const std::size_t id = first_cell + cell;
    const std::string name = id < face_ids.size() ? "ModelFaceID " + std::to_string(std::int64_t(face_ids[id])) : "surface";
    append(connectivity.data() + begin, end - begin, first_vertex, vertices, group_named(name, out), out);
    begin = end;
  }
}

// --- .vtp: just enough XML for what VTK writes -------------------------------------------------------------------------------------------

struct Tag {
  std::string name;  // "/Points" for an end tag
  std::map<std::string, std::string> attributes;
  std::size_t after = 0;  // position behind '>'
  bool empty = false;     // <x/>
};

Tag read_tag(std::string_view xml, std::size_t open) {
  Tag tag;
  const std::size_t close = xml.find('>', open);
  if (close == std::string_view::npos) throw std::runtime_error("is truncated: it ends inside a tag; export it again");
  tag.after = close + 1;
  std::string_view inside = xml.substr(open + 1, close - open - 1);
  if (!inside.empty() && inside.back() == '/') {
    tag.empty = true;
    inside.remove_suffix(1);
  }
  std::size_t at = std::min(inside.find_first_of(" \t\r\n"), inside.size());
  tag.name = inside.substr(0, at);
  while ((at = inside.find('=', at)) != std::string_view::npos) {
    std::size_t name_end = at, name_begin;
    while (name_end > 0 && std::isspace(static_cast<unsigned char>(inside[name_end - 1]))) --name_end;
    for (name_begin = name_end; name_begin > 0 && !std::isspace(static_cast<unsigned char>(inside[name_begin - 1]));) --name_begin;
    const std::size_t quote = inside.find_first_of("\"'", at);
    if (quote == std::string_view::npos) break;
    const std::size_t end = inside.find(inside[quote], quote + 1);
    if (end == std::string_view::npos) break;
    tag.attributes[std::string(inside.substr(name_begin, name_end - name_begin))] = inside.substr(quote + 1, end - quote - 1);
    at = end + 1;
  }
  return tag;
}

struct DataArray {
  std::string type, format;
  std::size_t offset = 0;
  std::string_view text;  // inline content
};

struct Piece {
  std::map<std::string, DataArray> arrays;  // "Points", "Polys/connectivity", "Polys/offsets", "CellData/ModelFaceID", ...
  std::size_t verts = 0, lines = 0, polys = 0;
};

struct VtpFile {
  VtkEncoding encoding;
  std::vector<Piece> pieces;
  std::string_view appended;  // behind the underscore
  bool appended_raw = false;
};

std::size_t count_attribute(const Tag& tag, const std::string& name) {
  const auto found = tag.attributes.find(name);
  return found == tag.attributes.end() ? 0 : std::size_t(std::strtoull(found->second.c_str(), nullptr, 10));
}

void take_file_attributes(const Tag& tag, VtpFile& file) {
  auto attribute = [&](const char* name) { return tag.attributes.count(name) ? tag.attributes.at(name) : std::string(); };
  if (attribute("type") != "PolyData")
    throw std::runtime_error("is a VTK \"" + attribute("type") + "\" file, not PolyData; extract its surface");
  file.encoding.big_endian = attribute("byte_order") == "BigEndian";
  file.encoding.header_bytes = attribute("header_type") == "UInt64" ? 8 : 4;
  const std::string compressor = attribute("compressor");
  file.encoding.compressed = !compressor.empty();
  if (file.encoding.compressed && compressor != "vtkZLibDataCompressor")
    throw std::runtime_error("is compressed by " + compressor + "; save it with zlib or uncompressed");
}

void take_data_array(const Tag& tag, const std::string& section, std::string_view xml, Piece& piece) {
  DataArray array;
  auto attribute = [&](const char* name) { return tag.attributes.count(name) ? tag.attributes.at(name) : std::string(); };
  array.type = attribute("type");
  array.format = attribute("format").empty() ? "ascii" : attribute("format");
  array.offset = count_attribute(tag, "offset");
  const std::size_t end = tag.empty ? tag.after : xml.find('<', tag.after);
  array.text = xml.substr(tag.after, std::min(end, xml.size()) - tag.after);
  const std::string key = section == "Points" ? "Points" : section + "/" + attribute("Name");
  piece.arrays[key] = array;
}

VtpFile scan_vtp(std::string_view xml) {
  VtpFile file;
  std::string section;
  bool typed = false, complete = false;
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at)) {
    const Tag tag = read_tag(xml, at);
    at = tag.after;
    if (tag.name == "VTKFile") {
      take_file_attributes(tag, file);
      typed = true;
    } else if (tag.name == "Piece") {
      file.pieces.emplace_back();
      file.pieces.back().verts = count_attribute(tag, "NumberOfVerts");
      file.pieces.back().lines = count_attribute(tag, "NumberOfLines");
      file.pieces.back().polys = count_attribute(tag, "NumberOfPolys");
    } else if (tag.name == "DataArray" && !file.pieces.empty()) {
      take_data_array(tag, section, xml, file.pieces.back());
    } else if (tag.name == "AppendedData") {
      const std::size_t underscore = xml.find('_', tag.after);
      const std::size_t end = xml.rfind("</AppendedData>");
      complete = underscore != std::string_view::npos && end != std::string_view::npos && end > underscore &&
                 xml.rfind("</VTKFile>") != std::string_view::npos;
      if (!complete) break;
      file.appended = xml.substr(underscore + 1, end - underscore - 1);
      file.appended_raw = tag.attributes.count("encoding") && tag.attributes.at("encoding") == "raw";
      break;  // raw bytes may hold '<'
    } else if (tag.name == "Points" || tag.name == "Polys" || tag.name == "Strips" || tag.name == "CellData" || tag.name == "PointData" ||
               tag.name == "Verts" || tag.name == "Lines") {
      section = tag.name;
    } else if (tag.name == "/VTKFile") {
      complete = true;
    }
  }
  if (!typed || !complete) throw std::runtime_error("is truncated: it does not end with </VTKFile>; export it again");
  return file;
}

std::vector<double> decode(const VtpFile& file, const Piece& piece, const std::string& key, bool needed) {
  const auto found = piece.arrays.find(key);
  if (found == piece.arrays.end()) {
    if (needed) throw std::runtime_error("has no array \"" + key + "\"; export it as PolyData with polygons");
    return {};
  }
  const DataArray& array = found->second;
  if (array.format == "ascii") return values_of_text(array.text);
  if (array.format == "binary") return values_of(decode_base64_array(array.text, file.encoding), array.type, file.encoding.big_endian);
  if (array.offset > file.appended.size()) throw std::runtime_error("is truncated: an array lies behind the file's end; export it again");
  const std::string_view from = file.appended.substr(array.offset);
  return values_of(file.appended_raw ? decode_raw_array(from, file.encoding) : decode_base64_array(from, file.encoding), array.type,
                   file.encoding.big_endian);
}

}  // namespace

LoadedMesh read_vtp(std::string_view bytes) {
  const VtpFile file = scan_vtp(bytes);
  LoadedMesh out;
  for (const Piece& piece : file.pieces) {
    const std::size_t first_vertex = out.mesh.vertices.size();
    append_points(decode(file, piece, "Points", true), out);
    const std::vector<double> face_ids = decode(file, piece, "CellData/ModelFaceID", false);
    const std::size_t first_cell = piece.verts + piece.lines;
    append_cells(decode(file, piece, "Polys/connectivity", true), decode(file, piece, "Polys/offsets", true), first_vertex, face_ids,
                 first_cell, append_polygon, out);
    append_cells(decode(file, piece, "Strips/connectivity", false), decode(file, piece, "Strips/offsets", false), first_vertex, face_ids,
                 first_cell + piece.polys, append_strip, out);
  }
  return out;
}

// --- legacy .vtk
// ---------------------------------------------------------------------------------------------------------------------------
namespace {

class LegacyReader {
 public:
  explicit LegacyReader(std::string_view bytes) : bytes_(bytes) {
    skip_line();  // "# vtk DataFile Version x"
    skip_line();  // title
    binary_ = lower(word()) == "binary";
    if (lower(word()) != "dataset" || lower(word()) != "polydata")
      throw std::runtime_error("is a VTK file but not POLYDATA; extract its surface");
  }
  LoadedMesh read() {
    LoadedMesh out;
    for (std::string key = lower(word()); !key.empty(); key = lower(word())) {
      if (key == "points")
        read_points(out);
      else if (key == "polygons")
        read_cells(append_polygon, out);
      else if (key == "triangle_strips")
        read_cells(append_strip, out);
      else if (key == "vertices" || key == "lines")
        skip_cells();
      else if (key == "metadata")
        skip_metadata();
      else if (key == "cell_data" || key == "point_data" || key == "field")
        break;  // nothing behind is needed
    }
    return out;
  }

 private:
  static std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
  }
  void skip_line() { at_ = std::min(bytes_.find('\n', at_), bytes_.size() - 1) + 1; }
  std::string word() {
    while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
    return std::string(bytes_.substr(begin, at_ - begin));
  }
  std::size_t count() {
    const std::string text = word();
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(value >= 0) || value > double(bytes_.size()))
      throw std::runtime_error("is malformed or truncated: the count \"" + text + "\" cannot be; export it again");
    return std::size_t(value);
  }
  // VTK writes binary legacy data big-endian, behind one line feed.
  std::vector<double> numbers(std::size_t count, const std::string& type) {
    std::vector<double> out;
    if (binary_) {
      skip_line();
      const std::size_t width = type == "double" || type == "vtktypeint64" || type == "long" ? 8 : type == "float" || type == "int" ? 4 : 0;
      if (width == 0) throw std::runtime_error("holds " + type + " numbers, which this reader does not know; save it as float or int");
      if (at_ + width * count > bytes_.size()) throw std::runtime_error("is truncated: an array ends early; export it again");
      out = values_of(bytes_.substr(at_, width * count), type, true);
      at_ += width * count;
    } else {
      out.reserve(count);
      for (std::size_t n = 0; n < count; ++n) {
        const std::string text = word();
        char* end = nullptr;
        out.push_back(std::strtod(text.c_str(), &end));
        if (text.empty() || *end != '\0')
          throw std::runtime_error("is truncated or malformed: \"" + text.substr(0, 12) +
                                   "\" stands where a number should; export it again");
      }
    }
    return out;
  }
  void read_points(LoadedMesh& out) {
    const std::size_t points = count();
    const std::string type = lower(word());
    append_points(numbers(3 * points, type), out);
  }
  // Both layouts: classic "n size" with counts inside, and version 5 OFFSETS / CONNECTIVITY.
  void cells(std::vector<double>& connectivity, std::vector<double>& ends) {
    const std::size_t first = count(), second = count();
    const std::size_t mark = at_;
    if (lower(word()) == "offsets") {
      const std::string offset_type = lower(word());
      const std::vector<double> offsets = numbers(first, offset_type);
      if (lower(word()) != "connectivity") throw std::runtime_error("is malformed: OFFSETS without CONNECTIVITY; export it again");
      const std::string type = lower(word());
      connectivity = numbers(second, type);
      if (!offsets.empty()) ends.assign(offsets.begin() + 1, offsets.end());
      return;
    }
    at_ = mark;
    const std::vector<double> mixed = numbers(second, "int");
    for (std::size_t at = 0; ends.size() < first;) {
      if (at >= mixed.size() || !(mixed[at] >= 0 && mixed[at] <= double(mixed.size() - at - 1)))
        throw std::runtime_error("is malformed: its faces do not fit their count; export it again");
      const auto corners = std::size_t(mixed[at]);
      connectivity.insert(connectivity.end(), mixed.begin() + std::ptrdiff_t(at) + 1, mixed.begin() + std::ptrdiff_t(at + 1 + corners));
      ends.push_back(double(connectivity.size()));
      at += 1 + corners;
    }
  }
  void read_cells(Appender append, LoadedMesh& out) {
    std::vector<double> connectivity, ends;
    cells(connectivity, ends);
    append_cells(connectivity, ends, 0, {}, 0, append, out);
  }
  void skip_cells() {
    std::vector<double> connectivity, ends;
    cells(connectivity, ends);
  }
  void skip_metadata() {  // ends with an empty line
    skip_line();
    while (at_ < bytes_.size() && bytes_[at_] != '\n' && bytes_[at_] != '\r') skip_line();
  }
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

}  // namespace

LoadedMesh read_legacy_vtk(std::string_view bytes) { return LegacyReader(bytes).read(); }

}  // namespace geometry::detail
