// The particles of a run: what changes from step to step and is saved.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace sim {

template <int D>
using Vector = Eigen::Matrix<double, D, 1>;
template <int D>
using Tensor = Eigen::Matrix<double, D, D>;
// A vector filled up with zeros to a whole register, so that sums over neighbours vectorise.
template <int D>
using Padded = Eigen::Matrix<double, D == 3 ? 4 : 2, 1>;
template <int D>
Padded<D> pad(const Vector<D>& v) {
  Padded<D> p = Padded<D>::Zero();
  p.template head<D>() = v;
  return p;
}

// A sum of dyads a b^T.
template <int D>
struct DyadSum {
  std::array<Padded<D>, D> column;
  DyadSum() { column.fill(Padded<D>::Zero()); }
  void add(const Padded<D>& a, const Padded<D>& b) {
    for (int k = 0; k < D; ++k) column[k] += b[k] * a;
  }
  Tensor<D> tensor() const {
    Tensor<D> t;
    for (int k = 0; k < D; ++k) t.col(k) = column[k].template head<D>();
    return t;
  }
};

// What a particle is made of. `shell` is an elastic particle of a one-layer sheet (a leaflet, in 2-D a beam), `port` a blood particle
// outside an open end whose motion is prescribed by the port.
enum class Kind : std::uint8_t { elastic = 0, shell = 1, wall = 2, fluid = 3, port = 4 };

// What went in and out, and what went wrong; cumulative over the run.
struct Ledger {
  std::int64_t particles_in = 0, particles_out = 0, particles_lost = 0;
  std::int64_t penetrations = 0;     // fluid particles found behind a leaflet or wall and put back
  std::int64_t sheet_crossings = 0;  // of these, through a leaflet
  double deepest_penetration = 0;    // m
  std::int64_t refused_steps = 0, limiter_hits = 0, pressure_iterations = 0, elastic_substeps = 0;
  double kinetic_energy = 0, elastic_energy = 0, viscous_loss = 0, port_work = 0, load_work = 0;  // J (2-D: J per metre of depth)
  double density_error = 0;  // rms of n/n0 - 1 over interior fluid, last step
};

// Structure of arrays; one row a particle. Rows are grouped: elastic bodies first (each body a contiguous range, in body order), then
// shells (likewise), then walls, then fluid and port particles. The first three groups keep their rows for the whole run; fluid rows
// come and go and may be reordered, `id` is what stays.
template <int D>
struct State {
  double time = 0;       // s (load factor in static mode)
  double last_step = 0;  // s, size of the step that led here; 0 at the start
  std::int64_t step = 0;
  std::int64_t next_id = 0;

  std::vector<std::int64_t> id;
  std::vector<Kind> kind;
  std::vector<std::int32_t> body;   // index into Scene::bodies
  std::vector<std::int32_t> port;   // index into Scene::ports for Kind::port, else -1
  std::vector<Vector<D>> position;  // m
  std::vector<Vector<D>> velocity;  // m/s
  std::vector<double> pressure;     // Pa; a shell particle: mean of its two sides

  // Rows [0, elastic_count + shell_count): what blood does to the solids.
  std::vector<Vector<D>> fluid_force;         // N, pressure force on the particle in the last step
  std::vector<Vector<D>> fluid_acceleration;  // m/s², acceleration of the particle in the last step (for the added-mass predictor)
  // Rows of shells only, relative to the first shell row: pressures on the side its normal points to, and on the other. Pa
  std::vector<double> pressure_plus, pressure_minus;

  std::vector<double> port_memory;  // per port: Windkessel pressure, Pa; with a given pressure the slow inflow speed, m/s
  std::vector<double> port_flow;    // per port: volume flow in the last step, m³/s, inward positive
  std::vector<double> port_volume;  // per port: volume that came in so far, m³
  Ledger ledger;

  std::size_t size() const { return position.size(); }
};

// Every saved array with its name, for writing and reading without listing the members twice. visit(name, vector&).
template <class StateT, class Visit>
void for_each_array(StateT& state, Visit&& visit) {
  visit("id", state.id);
  visit("kind", state.kind);
  visit("body", state.body);
  visit("port", state.port);
  visit("position", state.position);
  visit("velocity", state.velocity);
  visit("pressure", state.pressure);
  visit("fluid_force", state.fluid_force);
  visit("fluid_acceleration", state.fluid_acceleration);
  visit("pressure_plus", state.pressure_plus);
  visit("pressure_minus", state.pressure_minus);
  visit("port_memory", state.port_memory);
  visit("port_flow", state.port_flow);
  visit("port_volume", state.port_volume);
}

}  // namespace sim
