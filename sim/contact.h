// Contact of shells with other shells and with walls: a penalty against the smooth signed distance to the other body's particles
//   f(x) = sum_j w_j n_j . (x - x_j) / sum_j w_j   (implicit moving least squares, Kolluri 2005; w_j compact and smooth),
// positive on the side of the other body where this one was at the start. It stays signed: a particle pushed through is pushed back.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/particles.h"
#include "sim/point_grid.h"
#include "sim/shell.h"

namespace sim {

struct ContactSettings {
  double distance = 0;     // m: gap at which leaflets start to push; 0 = 0.5 l0. Per particle at most 0.9 of its initial gap
  double stiffness = 5e7;  // Pa/m, sum of both directions
  double damping = 0;      // of critical, on the approach speed
  // Pa s/m: resistance of the film of blood between leaflets to being squeezed out or drawn in, full below the contact distance, none
  // beyond 1.5 of it. Reynolds: mu (length/gap)²/gap; 3000 is that of blood of 4 mPa s in a film 8 mm long and 0.44 mm high. 0 without
  // blood.
  double film = 0;
  double wall_distance = 0;  // m from the mid-surface to the wall's true surface; 0 = 0.5 l0
};

template <int D>
struct WallSurface {                // the wall's layer nearest to its true surface
  std::vector<Vector<D>> position;  // m
  std::vector<Vector<D>> normal;    // unit, out of the wall
  std::vector<double> depth;        // m, centre below the true surface
};

struct ContactReport {
  std::int64_t contacts = 0;   // (row, body) pairs that push
  std::int64_t crossed = 0;    // rows found behind another body's mid-surface
  double deepest_overlap = 0;  // m, contact distance minus gap
};

// Contact of all shell bodies with one another (not with themselves) and with the wall.
template <int D>
struct Contact {
  // One shell row near one other body (or the wall: other == bodies), with its candidates [first, last).
  struct Row {
    std::int32_t particle = 0, other = 0, first = 0, last = 0;
  };
  ContactSettings settings;
  double spacing = 0;     // m, of the leaflets' particles
  double reach = 0;       // m, support of w against leaflets
  double wall_reach = 0;  // m, against the wall
  double skin = 0;        // m, how far anything may move before the search is repeated
  WallSurface<D> wall;
  std::int32_t bodies = 0;
  std::vector<std::int8_t> side;  // bodies x bodies: +1 where the row's body starts on the + side of the column's, -1, 0 no contact
  std::vector<double> limit;      // shell rows x (bodies + 1): contact distance with a body (last: the wall), m; 0 = exempt
  // Search result; a row keeps it until something moved by more than half the skin.
  std::vector<Vector<D>> searched_position;
  std::shared_ptr<const PointGrid<D>> wall_grid;
  std::vector<Row> rows;
  std::vector<std::int32_t> row_start;                                      // per shell row: its own rows
  std::vector<std::int32_t> candidate;                                      // shell rows or wall indices
  std::vector<std::int32_t> reverse_start, reverse_candidate, reverse_row;  // per shell row: where it is a candidate
  // Scratch of one evaluation.
  std::vector<double> share;           // per candidate: w_j / sum w
  std::vector<Padded<D>> row_force;    // N on the row's particle
  std::vector<std::uint8_t> row_acts;  // whether the row has a force
  std::vector<double> row_overlap;     // m, contact distance minus gap; <= 0 no contact
};

// Sides and contact distances from the initial positions. The wall from the particles of Kind::wall no deeper than one spacing.
template <int D>
Contact<D> build_contact(const SceneDescription<D>& description, const ShellElasticity<D>& shells, const ContactSettings& settings = {});

// Repeats the search if something moved by more than half the skin (called by shell_substeps).
template <int D>
void update_contact_search(Contact<D>& contact, const ShellElasticity<D>& shells, std::span<const Vector<D>> position);

// What the last evaluation found.
template <int D>
ContactReport contact_report(const Contact<D>& contact);

// Adds contact forces, N (2-D: N/m), with the current normals of the shells.
template <int D>
ContactReport add_contact_forces(Contact<D>& contact, const ShellElasticity<D>& shells, std::span<const Vector<D>> position,
                                 std::span<const Vector<D>> velocity, std::span<const Vector<D>> normal, std::span<Vector<D>> force);

}  // namespace sim
