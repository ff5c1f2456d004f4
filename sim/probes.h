// Probes: what the user asked to see at points, along lines, of whole bodies. Evaluated only when a row is written.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/scene.h"
#include "sim/solid_stress.h"
#include "sim/workspace.h"

namespace sim {

// The components of a quantity as column endings: {""} for a scalar, {".x", ".y"}, {".xx", ...}.
template <int D>
std::vector<std::string> probe_components(Quantity quantity);
std::string quantity_units(Quantity quantity, int dimension);

// What a probe remembers from the start: where a material point sits among its particles.
template <int D>
struct ProbePoint {
  Vector<D> place;        // m, as asked
  bool material = false;  // of an elastic body, in the initial configuration; else in space
  bool solid = false;     // material: of a solid, which knows its own points; else of a shell:
  SolidPoint<D> in_solid;
  std::vector<std::int32_t> row;              // State rows and weights, for displacements
  std::vector<double> weight, linear_weight;  // linear: for stresses
  double face = 0;                            // -1 on the minus face … +1 on the plus face
  std::int32_t body = -1;                     // material: whose
  std::int64_t followed = -1;                 // id of the fluid particle nearest at the start, for position and displacement
};

template <int D>
class Probes {
 public:
  Probes() = default;
  // `initial`: the state at time 0 (from initial_state, also when a run is continued).
  Probes(const Scene<D>& scene, const State<D>& initial);

  // Per probe: points x components, flat. Every entry finite.
  std::vector<std::vector<double>> evaluate(const Scene<D>& scene, const State<D>& state);

 private:
  std::vector<std::vector<ProbePoint<D>>> points_;  // per probe
  Workspace<D> work_;
};

}  // namespace sim
