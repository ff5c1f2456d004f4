#include "geometry/load_mesh.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "geometry/check_mesh.h"
#include "geometry/mesh_makers.h"

namespace {

using namespace geometry;
using test::error_of;
using test::TemporaryFile;

std::string refusal(const std::string& suffix, const std::string& bytes) {
  const TemporaryFile file(suffix, bytes);
  const std::string error = error_of([&] { load_mesh(file.path()); });
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  EXPECT_EQ(error.rfind(file.path(), 0), 0u) << "the line names the file: " << error;
  return error;
}

const char* tetrahedron_off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
const char* tetrahedron_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
const char* tetrahedron_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng floor\nf 1 3 2\ng walls\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

double welded_volume(LoadedMesh loaded) {
  weld_vertices(loaded.mesh);
  return signed_volume(loaded.mesh);
}

TEST(LoadMesh, ReadsBinaryStlUnwelded) {
  const TriangleMesh box = test::make_box({0, 0, 0}, {1, 2, 3});
  const TemporaryFile file(".stl", test::stl_bytes(box, 1));
  LoadedMesh loaded = load_mesh(file.path());
  EXPECT_EQ(loaded.format, "stl");
  EXPECT_EQ(loaded.mesh.triangles.size(), 12u);
  EXPECT_EQ(loaded.mesh.vertices.size(), 36u);
  EXPECT_EQ(loaded.metres_per_unit, 0);
  EXPECT_NEAR(welded_volume(loaded), 6, 1e-6);
}

TEST(LoadMesh, ReadsOffPlyAndObj) {
  for (const auto& [suffix, text] : {std::pair{".off", tetrahedron_off}, {".ply", tetrahedron_ply}, {".obj", tetrahedron_obj}}) {
    const TemporaryFile file(suffix, text);
    EXPECT_NEAR(welded_volume(load_mesh(file.path())), 1.0 / 6, 1e-6) << suffix;
  }
}

TEST(LoadMesh, KeepsObjGroups) {
  const TemporaryFile file(".obj", tetrahedron_obj);
  const LoadedMesh loaded = load_mesh(file.path());
  ASSERT_EQ(loaded.group_names.size(), 2u);
  EXPECT_EQ(loaded.group_names[0], "floor");
  EXPECT_EQ(loaded.group_names[1], "walls");
  EXPECT_EQ(std::count(loaded.group_of_triangle.begin(), loaded.group_of_triangle.end(), 1), 3);
}

TEST(LoadMesh, AppliesGltfNodeTransforms) {
  // One triangle of leg 1 in a node scaled by 3 and moved by 10 along x; the buffer is inline base64: 9 floats, 3 shorts.
  const std::string text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"name":"lumen","mesh":0,"translation":[10,0,0],"scale":[3,3,3]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
  const TemporaryFile file(".gltf", text);
  const LoadedMesh loaded = load_mesh(file.path());
  EXPECT_EQ(loaded.metres_per_unit, 1);
  ASSERT_EQ(loaded.mesh.triangles.size(), 1u);
  EXPECT_EQ(loaded.group_names[0], "lumen");
  Eigen::Vector3d low, high;
  bounding_box(loaded.mesh, low, high);
  EXPECT_NEAR((low - Eigen::Vector3d(10, 0, 0)).norm(), 0, 1e-6);
  EXPECT_NEAR((high - Eigen::Vector3d(13, 3, 0)).norm(), 0, 1e-6);
}

TEST(LoadMesh, RefusesWhatIsNoFile) {
  EXPECT_NE(error_of([] { load_mesh("/nowhere/aorta.stl"); }).find("no such file"), std::string::npos);
  EXPECT_NE(error_of([] { load_mesh("/tmp"); }).find("is not a file"), std::string::npos);
  EXPECT_NE(refusal(".stl", "").find("is empty"), std::string::npos);
}

TEST(LoadMesh, RefusesAClaimOfTenMillionTriangles) {
  std::string bytes(84, '\0');
  const std::uint32_t count = 10'000'000;
  std::memcpy(bytes.data() + 80, &count, 4);
  bytes.append(50, '\0');
  const std::string error = refusal(".stl", bytes);
  EXPECT_NE(error.find("truncated"), std::string::npos) << error;
  EXPECT_NE(error.find("10000000"), std::string::npos) << error;
}

TEST(LoadMesh, RefusesTruncatedFiles) {
  const std::string stl = test::stl_bytes(test::make_box({0, 0, 0}, {1, 1, 1}), 1);
  EXPECT_NE(refusal(".stl", stl.substr(0, 300)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(".stl", "solid a\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0").find("truncated"), std::string::npos);
  const std::string ply(tetrahedron_ply), off(tetrahedron_off);
  EXPECT_NE(refusal(".ply", ply.substr(0, ply.size() - 20)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(".off", off.substr(0, off.size() - 20)).find("truncated"), std::string::npos);
  EXPECT_NE(refusal(".off", "OFF\n4000000000 4 0\n0 0 0\n").find("claims"), std::string::npos);
  EXPECT_NE(refusal(".glb", std::string("glTF\2\0\0\0\xff\xff\0\0", 12)).find("truncated"), std::string::npos);
}

TEST(LoadMesh, RefusesAWrongSuffix) {
  const std::string stl = test::stl_bytes(test::make_box({0, 0, 0}, {1, 1, 1}), 1);
  EXPECT_NE(refusal(".obj", stl).find("holds stl data"), std::string::npos);
  EXPECT_NE(refusal(".stl", tetrahedron_ply).find("holds ply data"), std::string::npos);
  EXPECT_NE(refusal(".txt", stl).find("unknown suffix"), std::string::npos);
  EXPECT_NE(refusal(".ply", "just some words\n").find("does not hold ply data"), std::string::npos);
}

TEST(LoadMesh, RefusesVerticesThatAreNoNumbers) {
  TriangleMesh box = test::make_box({0, 0, 0}, {1, 1, 1});
  box.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(".stl", test::stl_bytes(box, 1)).find("not a finite number"), std::string::npos);
  box.vertices[3].y() = std::numeric_limits<double>::infinity();
  EXPECT_NE(refusal(".stl", test::stl_bytes(box, 1)).find("not a finite number"), std::string::npos);
}

TEST(LoadMesh, RefusesPointsWithoutASurface) { EXPECT_NE(refusal(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n"), ""); }

// Bytes flipped here and there in a binary file: whatever a parser makes of them, the caller gets a mesh or one line.
TEST(LoadMesh, SurvivesGarbage) {
  std::uint32_t state = 1;
  auto random = [&] { return state = state * 1664525u + 1013904223u; };
  for (int round = 0; round < 40; ++round) {
    std::string bytes = round % 2 ? std::string(tetrahedron_obj) : std::string(tetrahedron_ply);
    for (int n = 0; n < 6; ++n) bytes[random() % bytes.size()] = char(random() >> 24);
    const TemporaryFile file(round % 2 ? ".obj" : ".ply", bytes);
    const std::string error = error_of([&] { load_mesh(file.path()); });
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(LoadMesh, StopsAReaderThatNeedsTooMuchMemory) {
  const TemporaryFile file(".stl", test::stl_bytes(test::make_sphere(1, 700, 350), 1));
  LoadLimits limits;
  limits.memory = 8 << 20;
  const std::string error = error_of([&] { load_mesh(file.path(), limits); });
  EXPECT_NE(error, "");
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

TEST(LoadMesh, StopsAReaderThatTakesTooLong) {
  std::string text;  // half a million faces as text
  for (int n = 0; n < 400'000; ++n) text += "v " + std::to_string(n) + " 0.123456 1\n";
  for (int n = 3; n < 400'000; ++n) text += "f " + std::to_string(n - 2) + " " + std::to_string(n - 1) + " " + std::to_string(n) + "\n";
  const TemporaryFile file(".obj", text);
  LoadLimits limits;
  limits.seconds = 0.02;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_NE(error_of([&] { load_mesh(file.path(), limits); }).find("longer than"), std::string::npos);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10);
}

TEST(MetresPerUnit, KnowsUnitsAndMultiples) {
  EXPECT_DOUBLE_EQ(metres_per_unit("mm"), 1e-3);
  EXPECT_DOUBLE_EQ(metres_per_unit("cm"), 1e-2);
  EXPECT_DOUBLE_EQ(metres_per_unit("120 mm"), 0.12);
  EXPECT_DOUBLE_EQ(metres_per_unit("m"), 1);
  EXPECT_NE(error_of([] { metres_per_unit("furlong"); }).find("unknown units"), std::string::npos);
  EXPECT_NE(error_of([] { metres_per_unit("-3 mm"); }), "");
}

}  // namespace
