// .vtp and .vtk through load_mesh: every encoding of the same tetrahedron.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <vector>

#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"
#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using test::TemporaryFile;

const std::vector<float> points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<std::int32_t> connectivity{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, offsets{3, 6, 9, 12}, faces{7, 8, 8, 8};

template <class Number>
std::string raw(const std::vector<Number>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)};
}

template <class Number>
std::string text(const std::vector<Number>& values) {
  std::string out;
  for (Number v : values) out += std::to_string(v) + " ";
  return out;
}

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t b = 0; b < 3; ++b) word = word << 8 | (b < left ? static_cast<unsigned char>(bytes[i + b]) : 0u);
    for (std::size_t d = 0; d < 4; ++d) out += d <= left ? digits[word >> (18 - 6 * d) & 63] : '=';
  }
  return out;
}

std::string length_word(std::size_t size) { return raw(std::vector<std::uint32_t>{std::uint32_t(size)}); }

std::string compressed(const std::string& bytes, std::size_t block) {
  std::vector<std::uint32_t> header{0, std::uint32_t(block), std::uint32_t(bytes.size() % block)};
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += block, ++header[0]) {
    const std::string part = bytes.substr(at, block);
    std::string out(compressBound(uLong(part.size())), '\0');
    uLongf size = uLongf(out.size());
    compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(part.data()), uLong(part.size()));
    header.push_back(std::uint32_t(size));
    packed += out.substr(0, size);
  }
  return base64(raw(header)) + base64(packed);
}

std::string array(const std::string& type, const std::string& name, const std::string& attributes, const std::string& content) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" " + attributes + ">" + content + "</DataArray>\n";
}

std::string vtp(const std::string& file_attributes, const std::string& p, const std::string& c, const std::string& o, const std::string& f,
                const std::string& tail = "") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\" " + file_attributes +
         ">\n<PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
         "NumberOfPolys=\"4\">\n<CellData>" +
         f + "</CellData><Points>" + p + "</Points><Polys>" + c + o + "</Polys></Piece></PolyData>\n" + tail + "</VTKFile>\n";
}

void expect_tetrahedron(const std::string& suffix, const std::string& bytes, bool with_faces = true) {
  const TemporaryFile file(suffix, bytes);
  LoadedMesh loaded = load_mesh(file.path());
  EXPECT_EQ(loaded.mesh.triangles.size(), 4u);
  EXPECT_NEAR(signed_volume(loaded.mesh), 1.0 / 6, 1e-9);
  if (!with_faces) return;
  ASSERT_EQ(loaded.group_names.size(), 2u);
  EXPECT_EQ(loaded.group_names[1], "ModelFaceID 8");
  EXPECT_EQ(std::count(loaded.group_of_triangle.begin(), loaded.group_of_triangle.end(), 1), 3);
}

TEST(ReadVtp, Ascii) {
  expect_tetrahedron(".vtp", vtp("", array("Float32", "Points", "NumberOfComponents=\"3\" format=\"ascii\"", text(points)),
                                 array("Int32", "connectivity", "format=\"ascii\"", text(connectivity)),
                                 array("Int32", "offsets", "format=\"ascii\"", text(offsets)),
                                 array("Int32", "ModelFaceID", "format=\"ascii\"", text(faces))));
}

TEST(ReadVtp, InlineBase64WithTheLengthInOneStreamOrItsOwn) {
  for (const bool together : {true, false}) {
    auto encode = [&](const std::string& bytes) {
      return together ? base64(length_word(bytes.size()) + bytes) : base64(length_word(bytes.size())) + base64(bytes);
    };
    expect_tetrahedron(".vtp",
                       vtp("header_type=\"UInt32\"", array("Float32", "Points", "format=\"binary\"", "\n  " + encode(raw(points)) + "\n"),
                           array("Int32", "connectivity", "format=\"binary\"", encode(raw(connectivity))),
                           array("Int32", "offsets", "format=\"binary\"", encode(raw(offsets))),
                           array("Int32", "ModelFaceID", "format=\"binary\"", encode(raw(faces)))));
  }
}

TEST(ReadVtp, InlineZlibInSeveralBlocks) {
  expect_tetrahedron(
      ".vtp", vtp("compressor=\"vtkZLibDataCompressor\"", array("Float32", "Points", "format=\"binary\"", compressed(raw(points), 20)),
                  array("Int32", "connectivity", "format=\"binary\"", compressed(raw(connectivity), 16)),
                  array("Int32", "offsets", "format=\"binary\"", compressed(raw(offsets), 64)),
                  array("Int32", "ModelFaceID", "format=\"binary\"", compressed(raw(faces), 64))));
}

TEST(ReadVtp, AppendedRawAndBase64) {
  for (const bool as_text : {false, true}) {
    std::string data;
    std::vector<std::size_t> at;
    for (const std::string& bytes : {raw(points), raw(connectivity), raw(offsets), raw(faces)}) {
      at.push_back(data.size());
      data += as_text ? base64(length_word(bytes.size()) + bytes) : length_word(bytes.size()) + bytes;
    }
    auto place = [&](std::size_t n) { return "format=\"appended\" offset=\"" + std::to_string(at[n]) + "\""; };
    const std::string tail =
        std::string("<AppendedData encoding=\"") + (as_text ? "base64" : "raw") + "\">\n_" + data + "\n</AppendedData>\n";
    expect_tetrahedron(".vtp",
                       vtp("header_type=\"UInt32\"", array("Float32", "Points", place(0), ""), array("Int32", "connectivity", place(1), ""),
                           array("Int32", "offsets", place(2), ""), array("Int32", "ModelFaceID", place(3), ""), tail));
  }
}

TEST(ReadVtk, LegacyAsciiAndBinaryAndVersion5) {
  const std::string head = "# vtk DataFile Version 3.0\nany title\n";
  expect_tetrahedron(".vtk",
                     head + "ASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + text(points) +
                         "\nPOLYGONS 4 16\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\nCELL_DATA 4\n",
                     false);
  auto big_endian = [](std::string bytes) {
    for (std::size_t i = 0; i + 3 < bytes.size(); i += 4)
      std::reverse(bytes.begin() + std::ptrdiff_t(i), bytes.begin() + std::ptrdiff_t(i) + 4);
    return bytes;
  };
  const std::vector<std::int32_t> cells{3, 0, 2, 1, 3, 0, 1, 3, 3, 1, 2, 3, 3, 2, 0, 3};
  expect_tetrahedron(
      ".vtk",
      head + "BINARY\nDATASET POLYDATA\nPOINTS 4 float\n" + big_endian(raw(points)) + "\nPOLYGONS 4 16\n" + big_endian(raw(cells)) + "\n",
      false);
  expect_tetrahedron(".vtk",
                     "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n" + text(points) +
                         "\nPOLYGONS 5 12\nOFFSETS vtktypeint64\n0 3 6 9 12\nCONNECTIVITY vtktypeint64\n" + text(connectivity) + "\n",
                     false);
}

TEST(ReadVtk, SplitsPolygonsAndStripsKeepingTheirSide) {
  // A unit cube's top as one quad, its mirror image as a strip: both 1 in area, both normals along +z.
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 1 1 0 0 1 0\n";
  for (const std::string cells : {"POLYGONS 1 5\n4 0 1 2 3\n", "TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"}) {
    const TemporaryFile file(".vtk", head + cells);
    const LoadedMesh loaded = load_mesh(file.path());
    ASSERT_EQ(loaded.mesh.triangles.size(), 2u);
    for (const auto& t : loaded.mesh.triangles) {
      const Eigen::Vector3d a = loaded.mesh.vertices[std::size_t(t[0])], b = loaded.mesh.vertices[std::size_t(t[1])],
                            c = loaded.mesh.vertices[std::size_t(t[2])];
      EXPECT_NEAR((b - a).cross(c - a).z(), 1, 1e-12) << cells;
    }
  }
}

TEST(ReadVtk, RefusesWhatItCannotUse) {
  auto refusal = [](const std::string& suffix, const std::string& bytes) {
    const TemporaryFile file(suffix, bytes);
    return test::error_of([&] { load_mesh(file.path()); });
  };
  const std::string good = vtp("", array("Float32", "Points", "format=\"ascii\"", text(points)),
                               array("Int32", "connectivity", "format=\"ascii\"", text(connectivity)),
                               array("Int32", "offsets", "format=\"ascii\"", text(offsets)), "");
  EXPECT_EQ(refusal(".vtp", good), "");
  EXPECT_NE(refusal(".vtp", good.substr(0, good.size() - 30)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(".vtp", "<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\"></VTKFile>").find("not PolyData"),
            std::string::npos);
  std::string wrong = good;
  wrong.replace(wrong.find("0 2 1 "), 6, "0 9 1 ");
  EXPECT_NE(refusal(".vtp", wrong).find("does not exist"), std::string::npos);
  EXPECT_NE(refusal(".vtp", vtp("compressor=\"vtkLZ4DataCompressor\"", "", "", "", "")).find("vtkLZ4DataCompressor"), std::string::npos);
  EXPECT_NE(refusal(".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0").find("truncated"),
            std::string::npos);
  EXPECT_NE(refusal(".vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n").find("not POLYDATA"), std::string::npos);
}

}  // namespace
