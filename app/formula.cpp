#include "app/formula.h"

#include <muParser.h>
#include <omp.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace app {
namespace {

// One parser with its own variables: muParser evaluates through pointers, so each thread needs one.
struct Evaluator {
  std::array<double, 4> value{};
  mu::Parser parser;
  explicit Evaluator(const std::string& text) {
    const std::array<const char*, 4> names{"x", "y", "z", "t"};
    for (int i = 0; i < 4; ++i) parser.DefineVar(names[i], &value[i]);
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineConst("e", std::numbers::e);
    parser.SetExpr(text);
  }
  double evaluate(const Eigen::Vector3d& x, double t) {
    value = {x[0], x[1], x[2], t};
    return parser.Eval();
  }
};

bool plain_number(const std::string& text, double& value) {
  char* end = nullptr;
  value = std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size();
}

}  // namespace

std::function<double(const Eigen::Vector3d&, double)> compile_formula(const std::string& text) {
  double constant = 0;
  if (plain_number(text, constant)) return [constant](const Eigen::Vector3d&, double) { return constant; };
  try {
    auto pool = std::make_shared<std::vector<std::unique_ptr<Evaluator>>>();
    for (int thread = 0; thread < std::max(1, omp_get_max_threads()); ++thread) pool->push_back(std::make_unique<Evaluator>(text));
    pool->front()->evaluate({0.1, 0.2, 0.3}, 0.4);
    return [pool, text](const Eigen::Vector3d& x, double t) {
      const std::size_t thread = static_cast<std::size_t>(omp_get_thread_num());
      if (thread < pool->size()) return (*pool)[thread]->evaluate(x, t);
      return Evaluator(text).evaluate(x, t);  // more threads than when the scene was read
    };
  } catch (const mu::ParserError& error) {
    throw std::invalid_argument("\"" + text + "\" is no formula in x, y, z, t (" + error.GetMsg() + ")");
  }
}

bool VectorFormula::is_constant() const {
  double value = 0;
  return std::all_of(text.begin(), text.end(), [&](const std::string& one) { return plain_number(one, value); });
}

Eigen::Vector3d VectorFormula::constant() const {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) plain_number(text[axis], result[axis]);
  return result;
}

std::function<Eigen::Vector3d(const Eigen::Vector3d&, double)> VectorFormula::compile() const {
  std::array<std::function<double(const Eigen::Vector3d&, double)>, 3> part;
  for (int axis = 0; axis < 3; ++axis) part[axis] = compile_formula(text[axis]);
  return [part](const Eigen::Vector3d& x, double t) { return Eigen::Vector3d(part[0](x, t), part[1](x, t), part[2](x, t)); };
}

}  // namespace app
