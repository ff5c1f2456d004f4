// Scratch of a step: reused, never saved. One entry a row unless said otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/contact.h"
#include "sim/linear_solver.h"
#include "sim/neighbors.h"
#include "sim/particles.h"

namespace sim {

template <int D>
struct Workspace {
  // who is near whom
  Neighbors neighbors;
  CellGrid<D> grid;
  std::vector<Search> search;
  std::vector<std::uint8_t> is_fluid;
  std::vector<double> link_weight;  // per neighbour entry: w(|r_ij|) times the share of a cell that j fills; 0 = link cut

  // boundary particles as they are now (rows below first_fluid)
  std::vector<Vector<D>> boundary_normal;    // unit, into the fluid (shell: + side)
  std::vector<Vector<D>> boundary_velocity;  // m/s of the surface, dragging included

  // the fluid's state, operator by operator
  std::vector<double> number_density;      // n_i / n0
  std::vector<std::uint8_t> surface;       // 1 at the free surface, 2 next to it
  std::vector<Vector<D>> surface_outward;  // unit direction out of the fluid times -sum w r over fluid along it, m; 0 away from the surface
  std::vector<Tensor<D>> velocity_inverse;   // inverse moment matrix over fluid and surface points
  std::vector<Tensor<D>> pressure_inverse;   // inverse moment matrix over fluid alone
  std::vector<Tensor<D>> velocity_gradient;  // (grad v)_ab = d v_a / d x_b, 1/s
  std::vector<double> viscosity;             // Pa s
  std::vector<Vector<D>> acceleration;       // m/s², all but pressure
  std::vector<Vector<D>> pressure_gradient;  // Pa/m
  std::vector<Vector<D>> displacement;       // m, shifting
  std::vector<Vector<D>> velocity_old;       // m/s at the start of the step

  // the pressure problem
  std::vector<std::int32_t> unknown;      // row -> unknown, -1
  std::vector<std::int32_t> unknown_row;  // unknown -> row
  SymmetricMatrix matrix;
  std::vector<double> source, solution;
  Multigrid multigrid;
  ConjugateGradientScratch scratch;

  // the viscosity problem
  SymmetricMatrix viscous_matrix;
  std::vector<double> viscous_source, viscous_solution;

  // leaflets and solids
  Contact<D> contact;
  std::vector<double> stage_seconds;  // by Stage, of this run
};

}  // namespace sim
