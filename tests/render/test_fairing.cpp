#include "render/fairing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace render {
namespace {

struct Mesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// A flat strip of uneven cells, n x n.
Mesh uneven(int n) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      mesh.positions.emplace_back(static_cast<float>(x) + 0.3f * std::sin(1.7f * static_cast<float>(x * y)), 1.5f * static_cast<float>(y),
                                  0.0f);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return mesh;
}

// Integral of the linear interpolation over the mesh.
double integral(const Mesh& mesh, const std::vector<float>& values) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm() *
           (values[a] + values[b] + values[c]) / 3;
  return sum;
}

TEST(Fairing, recovery_keeps_the_integral_over_the_area_and_the_range) {
  const Mesh mesh = uneven(9);
  std::vector<float> noisy;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) noisy.push_back(100 + 80 * std::sin(12.9898f * static_cast<float>(i)));
  const std::vector<float> smooth = recovered(noisy, mesh.positions, mesh.triangles, 2);
  EXPECT_NEAR(integral(mesh, smooth) / integral(mesh, noisy), 1, 1e-5);
  const auto [low, high] = std::minmax_element(noisy.begin(), noisy.end());
  double before = 0, after = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    EXPECT_GE(smooth[i], *low);
    EXPECT_LE(smooth[i], *high);
    before += (noisy[i] - 100) * (noisy[i] - 100);
    after += (smooth[i] - 100) * (smooth[i] - 100);
  }
  EXPECT_LT(after, 0.15 * before);  // noise dies out
  EXPECT_EQ(recovered(noisy, mesh.positions, mesh.triangles, 0), noisy);
}

TEST(Fairing, recovery_leaves_a_constant_and_a_lone_vertex_alone) {
  Mesh mesh = uneven(3);
  mesh.positions.emplace_back(50.0f, 0.0f, 0.0f);
  std::vector<float> values(mesh.positions.size(), 7);
  values.back() = 3;
  const std::vector<float> smooth = recovered(values, mesh.positions, mesh.triangles, 3);
  for (std::size_t i = 0; i + 1 < smooth.size(); ++i) EXPECT_NEAR(smooth[i], 7, 1e-5);
  EXPECT_EQ(smooth.back(), 3);
}

// Inside a regular mesh a wave z = cos(2 pi x / w) is an eigenvector: the mean of the six neighbours is (4 cos(2 pi / w) + 2) / 6 of it, so
// each round scales it by (1 - K/2)(1 + 0.53 K), K = 1 - that. w = 2 (a zigzag): 0.57; w = 20: 1.0007.
TEST(Fairing, short_waves_die_out_and_long_ones_stay) {
  constexpr int n = 40;
  for (const double wave : {2.0, 20.0}) {
    Mesh mesh;
    for (int y = 0; y <= 4; ++y)
      for (int x = 0; x <= n; ++x)
        mesh.positions.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(0.2 * std::cos(2 * M_PI * x / wave)));
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < n; ++x) {
        const int a = y * (n + 1) + x;
        mesh.triangles.push_back({a, a + 1, a + n + 2});
        mesh.triangles.push_back({a, a + n + 2, a + n + 1});
      }
    const auto fair = faired(mesh.positions, followed(mesh.positions.size(), make_topology(mesh.triangles)), 2);
    double before = 0, after = 0;
    for (int i = 2 * (n + 1) + 8; i < 2 * (n + 1) + n - 8; ++i) {
      before += mesh.positions[i].z() * mesh.positions[i].z();
      after += fair[i].z() * fair[i].z();
      EXPECT_NEAR(fair[i].y(), 2, 1e-4);
    }
    const double k = 1 - (4 * std::cos(2 * M_PI / wave) + 2) / 6, round = (1 - 0.5 * k) * (1 + 0.53 * k);
    EXPECT_NEAR(std::sqrt(after / before), round * round, 0.01) << "wave of " << wave;
  }
}

}  // namespace
}  // namespace render
