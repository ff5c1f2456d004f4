// Formulas of a scene file: text in x, y, z (m) and t (s) to a number; pi is known.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>

namespace app {

// Thread-safe evaluator. Throws std::invalid_argument (one line) where the text is no formula in x, y, z, t.
std::function<double(const Eigen::Vector3d&, double)> compile_formula(const std::string& text);

// A vector whose components are formulas; a plain number is the simplest formula.
struct VectorFormula {
  std::array<std::string, 3> text{"0", "0", "0"};
  bool is_constant() const;
  Eigen::Vector3d constant() const;  // where is_constant()
  std::function<Eigen::Vector3d(const Eigen::Vector3d&, double)> compile() const;
};

}  // namespace app
