// Static mode: elastic bodies and shells brought to equilibrium, load factor by load factor.
#pragma once

#include <memory>
#include <stdexcept>

#include "sim/scene.h"

namespace sim {

// The loads can't be carried, or the solver can't follow them: one line with the load factor reached.
struct NoEquilibrium : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <int D>
class StaticSolution {
 public:
  explicit StaticSolution(const Scene<D>& scene);
  ~StaticSolution();
  // From equilibrium at state.time to equilibrium at `factor`; velocities are 0. Throws NoEquilibrium, the state being the last
  // equilibrium.
  void advance(State<D>& state, double factor);

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace sim
