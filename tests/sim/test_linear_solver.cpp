#include "sim/linear_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "sim/multigrid.h"

namespace sim {
namespace {

// Five-point Laplacian on an n x n grid with links of random strength, `ground` on every diagonal.
SymmetricMatrix grid_laplacian(int n, double ground) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> strength(0.5, 1.5);
  std::vector<double> right(n * n), up(n * n);
  for (int i = 0; i < n * n; ++i) right[i] = strength(random), up[i] = strength(random);
  SymmetricMatrix a;
  a.start.push_back(0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      double diagonal = ground;
      auto link = [&](int k, double c) {
        a.column.push_back(k);
        a.value.push_back(-c);
        diagonal += c;
      };
      const int me = j * n + i;
      if (i > 0) link(me - 1, right[me - 1]);
      if (i + 1 < n) link(me + 1, right[me]);
      if (j > 0) link(me - n, up[me - n]);
      if (j + 1 < n) link(me + n, up[me]);
      a.diagonal.push_back(diagonal);
      a.start.push_back(static_cast<std::int64_t>(a.column.size()));
    }
  return a;
}

std::vector<double> random_vector(std::size_t n) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> x(n);
  for (double& v : x) v = uniform(random);
  return x;
}

TEST(LinearSolver, MatchesADenseSolve) {
  const SymmetricMatrix a = grid_laplacian(9, 0.01);
  const auto n = static_cast<Eigen::Index>(a.rows());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    dense(i, i) = a.diagonal[i];
    for (std::int64_t k = a.start[i]; k < a.start[i + 1]; ++k) dense(i, a.column[k]) = a.value[k];
  }
  std::vector<double> b = random_vector(a.rows()), x(a.rows(), 0);
  ConjugateGradientScratch scratch;
  ASSERT_TRUE(conjugate_gradient(a, b, x, 1e-12, 500, nullptr, scratch).converged);
  const Eigen::VectorXd exact = dense.ldlt().solve(Eigen::Map<Eigen::VectorXd>(b.data(), n));
  EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), n) - exact).norm(), 1e-9 * exact.norm());
}

TEST(LinearSolver, MultigridFindsTheSameSolutionInFarFewerIterations) {
  const SymmetricMatrix a = grid_laplacian(64, 1e-4);
  const std::vector<double> b = random_vector(a.rows());
  std::vector<double> plain(a.rows(), 0), fast(a.rows(), 0);
  ConjugateGradientScratch scratch;
  const SolveReport jacobi = conjugate_gradient(a, b, plain, 1e-8, 2000, nullptr, scratch);
  Multigrid multigrid;
  build_multigrid(multigrid, a);
  const SolveReport mg = conjugate_gradient(a, b, fast, 1e-8, 2000, &multigrid, scratch);
  ASSERT_TRUE(jacobi.converged && mg.converged);
  EXPECT_LT(mg.iterations * 4, jacobi.iterations);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.rows(); ++i) difference += std::pow(plain[i] - fast[i], 2), size += plain[i] * plain[i];
  EXPECT_LT(std::sqrt(difference / size), 1e-4);
}

TEST(LinearSolver, MultigridCycleIsSymmetric) {
  const SymmetricMatrix a = grid_laplacian(30, 0.01);
  Multigrid multigrid;
  build_multigrid(multigrid, a);
  std::vector<double> u = random_vector(a.rows()), v(a.rows()), mu(a.rows()), mv(a.rows());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = std::cos(0.37 * static_cast<double>(i));
  apply_multigrid(multigrid, u, mu);
  apply_multigrid(multigrid, v, mv);
  double left = 0, right = 0;
  for (std::size_t i = 0; i < u.size(); ++i) left += u[i] * mv[i], right += v[i] * mu[i];
  EXPECT_NEAR(left, right, 1e-4 * std::abs(left));
}

TEST(LinearSolver, SolvesASingularSystemWithABalancedSource) {
  const SymmetricMatrix a = grid_laplacian(30, 0);
  std::vector<double> b = random_vector(a.rows()), x(a.rows(), 0), ax(a.rows());
  double mean = 0;
  for (double v : b) mean += v / static_cast<double>(b.size());
  for (double& v : b) v -= mean;
  Multigrid multigrid;
  build_multigrid(multigrid, a);
  ConjugateGradientScratch scratch;
  ASSERT_TRUE(conjugate_gradient(a, b, x, 1e-6, 300, &multigrid, scratch).converged);
  multiply(a, x, ax);
  for (std::size_t i = 0; i < b.size(); ++i) EXPECT_NEAR(ax[i], b[i], 1e-4);
}

TEST(LinearSolver, SolvesSingularSystemsOfAnyScaleAndSize) {
  for (const double scale : {1e-20, 1e-7, 3e-3, 1.0, 1e9})
    for (const int n : {21, 22, 23, 24, 25, 26, 40}) {
      SymmetricMatrix a = grid_laplacian(n, 0);
      for (double& v : a.diagonal) v *= scale;
      for (double& v : a.value) v *= scale;
      std::vector<double> b = random_vector(a.rows()), x(a.rows(), 0);
      double mean = 0;
      for (double v : b) mean += v / static_cast<double>(b.size());
      for (double& v : b) v -= mean;
      Multigrid multigrid;
      build_multigrid(multigrid, a);
      ConjugateGradientScratch scratch;
      const SolveReport report = conjugate_gradient(a, b, x, 1e-8, 100, &multigrid, scratch);
      EXPECT_TRUE(report.converged) << "scale " << scale << ", " << n << " x " << n;
      EXPECT_LT(report.iterations, 40) << "scale " << scale << ", " << n << " x " << n;
    }
}

}  // namespace
}  // namespace sim
