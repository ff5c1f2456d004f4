// Names and texts that the run file's writer and reader share. Internal to sim/run_*.cpp.
#pragma once

#include <string>

#include "sim/hdf5_io.h"
#include "sim/run_file.h"

namespace sim {

inline constexpr int run_layout_version = 1;
std::string frame_name(std::size_t frame);
void write_header(hid_t file, const RunHeader& header);
RunHeader read_header(hid_t file);
std::string kind_name(Kind kind);

// Visits the scalars of a state by name: visit(name, double&) and visit(name, std::int64_t&).
template <class StateT, class Visit>
void for_each_scalar(StateT& state, Visit&& visit) {
  visit("time", state.time);
  visit("last_step", state.last_step);
  visit("step", state.step);
  visit("next_id", state.next_id);
  auto& ledger = state.ledger;
  visit("particles_in", ledger.particles_in);
  visit("particles_out", ledger.particles_out);
  visit("particles_lost", ledger.particles_lost);
  visit("penetrations", ledger.penetrations);
  visit("sheet_crossings", ledger.sheet_crossings);
  visit("deepest_penetration", ledger.deepest_penetration);
  visit("refused_steps", ledger.refused_steps);
  visit("limiter_hits", ledger.limiter_hits);
  visit("pressure_iterations", ledger.pressure_iterations);
  visit("elastic_substeps", ledger.elastic_substeps);
  visit("kinetic_energy", ledger.kinetic_energy);
  visit("elastic_energy", ledger.elastic_energy);
  visit("viscous_loss", ledger.viscous_loss);
  visit("port_work", ledger.port_work);
  visit("load_work", ledger.load_work);
  visit("density_error", ledger.density_error);
}

}  // namespace sim
