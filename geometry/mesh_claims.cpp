// What the first bytes of a mesh file say about the rest, checked before any parser believes it.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "geometry/mesh_readers.h"

namespace geometry::detail {
namespace {

constexpr std::size_t stl_header = 84, stl_triangle = 50;

bool begins(std::string_view bytes, std::string_view mark) { return bytes.substr(0, mark.size()) == mark; }

std::string_view without_leading_space(std::string_view bytes) {
  const auto first = bytes.find_first_not_of(" \t\r\n");
  return first == std::string_view::npos ? std::string_view() : bytes.substr(first);
}

std::uint32_t read_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;  // little-endian, as the machines this program runs on
}

bool looks_like_ascii_stl(std::string_view bytes) {
  const std::string_view text = without_leading_space(bytes);
  return begins(text, "solid") &&
         (text.substr(0, 4096).find("facet") != std::string_view::npos || text.substr(0, 4096).find("endsolid") != std::string_view::npos);
}

// Binary STL has no mark: its count is believed when it matches the size, or when the bytes are not text and it is too large for it.
bool looks_like_binary_stl(std::string_view bytes) {
  if (bytes.size() < stl_header) return false;
  const std::size_t needed = stl_header + stl_triangle * std::size_t(read_u32(bytes, 80));
  if (needed == bytes.size()) return true;
  return std::any_of(bytes.begin(), bytes.begin() + stl_header, [](char c) { return c == 0; });
}

std::string_view first_line(std::string_view bytes) { return bytes.substr(0, bytes.find_first_of("\r\n")); }

[[noreturn]] void refuse_short(const std::string& claim, std::size_t size) {
  throw std::runtime_error("is truncated: its header claims " + claim + " but the file has only " + std::to_string(size) +
                           " bytes; export it again");
}

void check_stl(std::string_view bytes, std::size_t most_triangles) {
  if (looks_like_ascii_stl(bytes)) {
    const std::string_view tail = bytes.substr(bytes.size() > 400 ? bytes.size() - 400 : 0);
    if (tail.find("endsolid") == std::string_view::npos && tail.find("end solid") == std::string_view::npos)
      throw std::runtime_error("is truncated: an ASCII STL must end with \"endsolid\"; export it again");
    return;
  }
  if (bytes.size() < stl_header) throw std::runtime_error("is truncated: shorter than an STL header; export it again");
  const std::size_t triangles = read_u32(bytes, 80);
  if (stl_header + stl_triangle * triangles > bytes.size()) refuse_short(std::to_string(triangles) + " triangles", bytes.size());
  if (triangles > most_triangles)
    throw std::runtime_error("has " + std::to_string(triangles) + " triangles; simplify it below " + std::to_string(most_triangles));
}

struct PlyHeader {
  std::size_t vertices = 0, faces = 0, vertex_bytes = 0, end = 0;
  bool ascii = true;
};

std::size_t ply_type_size(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "double" || type == "float64") return 8;
  return 4;
}

PlyHeader read_ply_header(std::string_view bytes) {
  PlyHeader header;
  const auto end = bytes.substr(0, 1 << 16).find("end_header");
  if (end == std::string_view::npos) throw std::runtime_error("is truncated: its PLY header has no end_header; export it again");
  header.end = bytes.find('\n', end);
  header.end = header.end == std::string_view::npos ? bytes.size() : header.end + 1;
  std::istringstream lines{std::string(bytes.substr(0, end))};
  std::string line, element;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string word, name;
    words >> word >> name;
    if (word == "format") header.ascii = name == "ascii";
    if (word == "element") {
      element = name;
      double count = 0;
      words >> count;
      if (element == "vertex") header.vertices = std::size_t(std::max(0.0, count));
      if (element == "face") header.faces = std::size_t(std::max(0.0, count));
    }
    if (word == "property" && element == "vertex") header.vertex_bytes += ply_type_size(name);
  }
  return header;
}

void check_ply(std::string_view bytes, std::size_t most_triangles) {
  const PlyHeader header = read_ply_header(bytes);
  const std::string claim = std::to_string(header.vertices) + " vertices and " + std::to_string(header.faces) + " faces";
  if (header.faces > most_triangles || header.vertices > 3 * most_triangles)
    throw std::runtime_error("claims " + claim + "; simplify it below " + std::to_string(most_triangles));
  const std::string_view body = bytes.substr(header.end);
  if (header.ascii) {
    std::size_t lines = std::size_t(std::count(body.begin(), body.end(), '\n'));
    if (!body.empty() && body.back() != '\n') ++lines;
    if (lines < header.vertices + header.faces) refuse_short(claim, bytes.size());
  } else if (body.size() < header.vertices * header.vertex_bytes + header.faces * 7) {  // a face: a count byte and three shorts at least
    refuse_short(claim, bytes.size());
  }
}

std::array<double, 2> read_off_counts(std::string_view bytes) {
  std::istringstream lines{std::string(bytes.substr(0, 4096))};
  std::string line;
  bool named = false;
  while (std::getline(lines, line)) {
    line = line.substr(0, line.find('#'));
    std::istringstream words(line);
    std::string word;
    if (!named) {
      if (!(words >> word)) continue;
      named = true;  // "OFF", "COFF"...; the counts may follow on the same line
    }
    double vertices, faces;
    if (words >> vertices >> faces) return {vertices, faces};
  }
  throw std::runtime_error("is truncated: its OFF header has no counts; export it again");
}

void check_off(std::string_view bytes, std::size_t most_triangles) {
  const auto [vertices, faces] = read_off_counts(bytes);
  const std::string claim = std::to_string(std::size_t(std::max(0.0, vertices))) + " vertices and " +
                            std::to_string(std::size_t(std::max(0.0, faces))) + " faces";
  if (!(vertices >= 0 && faces >= 0) || faces > double(most_triangles) || vertices > 3.0 * double(most_triangles))
    throw std::runtime_error("claims " + claim + "; simplify it below " + std::to_string(most_triangles));
  if (double(bytes.size()) < 6 * vertices + 6 * faces) refuse_short(claim, bytes.size());  // at least "0 0 0\n" each
}

void check_glb(std::string_view bytes) {
  if (bytes.size() < 12 || read_u32(bytes, 8) > bytes.size())
    refuse_short(bytes.size() < 12 ? "a scene" : std::to_string(read_u32(bytes, 8)) + " bytes", bytes.size());
}

}  // namespace

std::string sniff_format(std::string_view bytes) {
  const std::string_view text = without_leading_space(bytes.substr(0, 8192));
  if (begins(bytes, "glTF")) return "glb";
  if (begins(bytes, "ply")) return "ply";
  if (begins(text, "# vtk DataFile")) return "vtk";
  if (begins(text, "<") && text.find("<VTKFile") != std::string_view::npos) return "vtp";
  if (looks_like_ascii_stl(bytes)) return "stl";
  const std::string_view line = first_line(text);
  if (line.find("OFF") != std::string_view::npos && line.find("OFF") <= 4 && line.find('#') == std::string_view::npos) return "off";
  if (begins(text, "{") && text.find("\"") != std::string_view::npos) return "gltf";
  if (looks_like_binary_stl(bytes)) return "stl";
  return "";
}

void check_claims(std::string_view bytes, const std::string& format, std::size_t most_triangles) {
  if (format == "stl") check_stl(bytes, most_triangles);
  if (format == "ply") check_ply(bytes, most_triangles);
  if (format == "off") check_off(bytes, most_triangles);
  if (format == "glb") check_glb(bytes);
}

void check_loaded(const LoadedMesh& loaded, std::string_view bytes) {
  const std::size_t triangles = loaded.mesh.triangles.size();
  if (triangles == 0) throw std::runtime_error("holds no triangle; export a surface, not points or lines");
  std::size_t promised = 0;
  if (loaded.format == "off") promised = std::size_t(read_off_counts(bytes)[1]);
  if (loaded.format == "ply") promised = read_ply_header(bytes).faces;
  if (triangles < promised)
    throw std::runtime_error("is truncated: its header claims " + std::to_string(promised) + " faces but only " +
                             std::to_string(triangles) + " could be read; export it again");
  for (const auto& corners : loaded.mesh.triangles)
    for (std::int32_t v : corners)
      if (v < 0 || std::size_t(v) >= loaded.mesh.vertices.size())
        throw std::runtime_error("is malformed: a face names a vertex that does not exist; export it again");
      else if (!loaded.mesh.vertices[std::size_t(v)].allFinite())
        throw std::runtime_error("vertex " + std::to_string(v) + " is not a finite number (NaN or infinity); export the mesh again");
}

}  // namespace geometry::detail
