// Meshes made for tests, and the way to the shared real ones.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "geometry/triangle_mesh.h"

namespace test {

using Eigen::Vector3d;
using geometry::TriangleMesh;

// Surface of revolution-like tube r(theta, z) about the z axis, outward; `capped` closes both ends by a fan.
inline TriangleMesh make_tube(const std::function<double(double, double)>& radius, double low, double high, int around, int along,
                              bool capped) {
  TriangleMesh mesh;
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double theta = 2 * std::numbers::pi * i / around, z = low + (high - low) * k / along, r = radius(theta, z);
      mesh.vertices.emplace_back(r * std::cos(theta), r * std::sin(theta), z);
    }
  auto at = [&](int i, int k) { return std::int32_t(k * around + i % around); };
  for (int k = 0; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  if (capped)
    for (int end = 0; end < 2; ++end) {
      const auto middle = std::int32_t(mesh.vertices.size());
      mesh.vertices.emplace_back(0, 0, end ? high : low);
      for (int i = 0; i < around; ++i) {
        const std::int32_t a = at(i, end ? along : 0), b = at(i + 1, end ? along : 0);
        if (end)
          mesh.triangles.push_back({middle, a, b});
        else
          mesh.triangles.push_back({middle, b, a});
      }
    }
  return mesh;
}

inline TriangleMesh make_cylinder(double radius, double length, int around = 48, int along = 40, bool capped = false) {
  return make_tube([radius](double, double) { return radius; }, 0, length, around, along, capped);
}

inline TriangleMesh make_sphere(double radius, int around = 48, int along = 24) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, -radius);
  for (int k = 1; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      const double theta = 2 * std::numbers::pi * i / around, phi = std::numbers::pi * k / along;
      mesh.vertices.emplace_back(radius * std::sin(phi) * std::cos(theta), radius * std::sin(phi) * std::sin(theta),
                                 -radius * std::cos(phi));
    }
  mesh.vertices.emplace_back(0, 0, radius);
  const auto last = std::int32_t(mesh.vertices.size()) - 1;
  auto at = [&](int i, int k) { return std::int32_t(1 + (k - 1) * around + i % around); };
  for (int i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, at(i + 1, 1), at(i, 1)});
    mesh.triangles.push_back({last, at(i, along - 1), at(i + 1, along - 1)});
    for (int k = 1; k + 1 < along; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return mesh;
}

inline TriangleMesh make_box(const Vector3d& low, const Vector3d& high) {
  TriangleMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.emplace_back(n & 1 ? high.x() : low.x(), n & 2 ? high.y() : low.y(), n & 4 ? high.z() : low.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other, const Vector3d& shift = Vector3d::Zero()) {
  const auto first = std::int32_t(mesh.vertices.size());
  for (const Vector3d& v : other.vertices) mesh.vertices.push_back(v + shift);
  for (const auto& t : other.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// A file of this test's own, removed with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& suffix, const std::string& bytes = "") {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = (std::filesystem::temp_directory_path() /
             ("cusp_" + std::string(info->test_suite_name()) + "_" + info->name() + std::to_string(count_++) + suffix))
                .string();
    write(bytes);
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  const std::string& path() const { return path_; }

 private:
  static inline int count_ = 0;
  std::string path_;
};

// Binary STL, corners split as the format has them; `scale` file units a metre.
inline std::string stl_bytes(const TriangleMesh& mesh, double scale) {
  std::string bytes(80, '\0');
  const auto count = std::uint32_t(mesh.triangles.size());
  bytes.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& t : mesh.triangles) {
    float values[12] = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) values[3 + 3 * c + std::size_t(k)] = float(mesh.vertices[std::size_t(t[c])][k] * scale);
    bytes.append(reinterpret_cast<const char*>(values), sizeof values);
    bytes.append(2, '\0');
  }
  return bytes;
}

// The shared real meshes: $CUSP_SHARED/geometry, else ../shared/geometry beside the source; "" where absent.
inline std::string shared_mesh(const std::string& name) {
  const char* root = std::getenv("CUSP_SHARED");
  const std::filesystem::path path = std::filesystem::path(root ? root : CUSP_SOURCE_DIR "/../shared") / "geometry" / name;
  return std::filesystem::exists(path) ? path.string() : "";
}

// The message of the std::runtime_error that `call` throws; "" where it throws none.
inline std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

}  // namespace test
