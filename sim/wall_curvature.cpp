#include <Eigen/Dense>
#include <cmath>

#include "sim/walls.h"

namespace sim {
namespace {

using Index = std::ptrdiff_t;

// Least squares for the D (D - 1) / 2 components of a curvature in the tangent plane, `tangent` m long steps of which are its columns.
template <int D>
struct CurvatureFit {
  static constexpr int terms = D == 2 ? 1 : 3;
  using Terms = Eigen::Matrix<double, terms, 1>;
  Eigen::Matrix<double, D, D - 1> tangent;
  Eigen::Matrix<double, terms, terms> moment = Eigen::Matrix<double, terms, terms>::Zero();
  Terms right = Terms::Zero();
  double squares = 0, weights = 0;

  void add(const Terms& row, double value, double weight) {
    moment += weight * row * row.transpose();
    right += weight * value * row;
    squares += weight * value * value;
    weights += weight;
  }
  // s.K s / 2 at the place s of the tangent plane, and K s there, per component of K.
  void add_point(const Eigen::Matrix<double, D - 1, 1>& s, double height, const Eigen::Matrix<double, D - 1, 1>& slope, double weight) {
    const double length = s.squaredNorm();
    if constexpr (D == 2) {
      add(Terms(0.5 * s[0] * s[0]), height, weight);
      add(Terms(s[0] * std::sqrt(length)), slope[0] * std::sqrt(length), weight);
    } else {
      add(Terms(0.5 * s[0] * s[0], s[0] * s[1], 0.5 * s[1] * s[1]), height, weight);
      add(Terms(s[0], s[1], 0) * std::sqrt(length), slope[0] * std::sqrt(length), weight);
      add(Terms(0, s[0], s[1]) * std::sqrt(length), slope[1] * std::sqrt(length), weight);
    }
  }
  // Zero where the points don't tell, or lie on no smooth surface (what is left over is more than `rough`, m).
  Tensor<D> curvature(double rough, double spacing) const {
    const Eigen::LDLT<Eigen::Matrix<double, terms, terms>> factor(moment);
    if (!(weights > 0) || !(factor.vectorD().minCoeff() > 1e-3 * factor.vectorD().maxCoeff())) return Tensor<D>::Zero();
    const Terms k = factor.solve(right);
    const double left = std::sqrt(std::max(squares - k.dot(right), 0.0) / weights);
    if (left > rough || k.norm() * spacing > 1) return Tensor<D>::Zero();
    Eigen::Matrix<double, D - 1, D - 1> form;
    if constexpr (D == 2)
      form << k[0];
    else
      form << k[0], k[1], k[1], k[2];
    return tangent * form * tangent.transpose();
  }
};

template <int D>
Eigen::Matrix<double, D, D - 1> tangents(const Vector<D>& normal) {
  Eigen::Matrix<double, D, D - 1> t;
  if constexpr (D == 2)
    t << -normal[1], normal[0];
  else
    t.col(0) = normal.unitOrthogonal(), t.col(1) = normal.cross(t.col(0));
  return t;
}

}  // namespace

template <int D>
std::vector<Tensor<D>> wall_curvatures(const Scene<D>& scene) {
  const InitialParticles<D>& particles = scene.description.particles;
  const std::size_t n = static_cast<std::size_t>(scene.first_fluid);
  const double l0 = scene.description.spacing, reach = 2.5 * l0;
  if (scene.wall_count == 0) return {};
  std::vector<Search> search(n, Search::none);
  const std::vector<std::uint8_t> is_fluid(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    if (particles.kind[i] == Kind::wall && particles.normal[i].squaredNorm() > 0.5) search[i] = Search::all;
  Neighbors neighbors;
  CellGrid<D> grid;
  find_neighbors<D>(neighbors, grid, std::span(particles.position).first(n), search, is_fluid, scene.description.domain, reach);
  // Foot: the point of the surface nearest to a row, seen from row i's own.
  const auto foot_from = [&](std::size_t i, std::size_t j) {
    return Vector<D>(scene.space.difference(particles.position[i], particles.position[j]) + particles.depth[j] * particles.normal[j] -
                     particles.depth[i] * particles.normal[i]);
  };
  // Rows behind an edge share it as their foot, each with a normal of its own: no smooth surface there.
  std::vector<std::uint8_t> at_edge(n, 0);
#pragma omp parallel for schedule(dynamic, 256)
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    if (search[i] == Search::none) continue;
    for (const std::int32_t j : neighbors.of(static_cast<std::size_t>(i)))
      if (search[j] != Search::none && particles.normal[j].dot(particles.normal[i]) < 0.98 &&
          foot_from(static_cast<std::size_t>(i), static_cast<std::size_t>(j)).norm() < 0.3 * l0)
        at_edge[i] = 1;
  }
  std::vector<Tensor<D>> result(n, Tensor<D>::Zero());
  bool curved = false;
#pragma omp parallel for schedule(dynamic, 256) reduction(|| : curved)
  for (Index i = 0; i < static_cast<Index>(n); ++i) {
    if (search[i] == Search::none || at_edge[i]) continue;
    const Vector<D>& normal = particles.normal[i];
    CurvatureFit<D> fit;
    fit.tangent = tangents<D>(normal);
    for (const std::int32_t j : neighbors.of(static_cast<std::size_t>(i))) {
      if (search[j] == Search::none || at_edge[j] || particles.body[j] != particles.body[i] || particles.normal[j].dot(normal) < 0.8)
        continue;
      const Vector<D> foot = foot_from(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      const Eigen::Matrix<double, D - 1, 1> s = fit.tangent.transpose() * foot;
      const double distance = s.norm();
      if (distance < 0.3 * l0 || distance > reach) continue;
      fit.add_point(s, foot.dot(normal), -fit.tangent.transpose() * particles.normal[j] / particles.normal[j].dot(normal),
                    std::pow(l0 / distance, 4));
    }
    result[i] = fit.curvature(0.05 * l0, l0);
    curved = curved || result[i].norm() * l0 > 1e-6;
  }
  if (!curved) result.clear();
  return result;
}

template std::vector<Tensor<2>> wall_curvatures(const Scene<2>&);
template std::vector<Tensor<3>> wall_curvatures(const Scene<3>&);

}  // namespace sim
