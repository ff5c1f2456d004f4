// Particle number density and what follows from it: link weights and the free surface (paper Eqs 14, 15).
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// w(|r_ij|) of every neighbour entry, times the share of a lattice cell that j fills. Cut links are set to 0 later.
template <int D>
void link_weights(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// n_i / n0 = sum_j w_ij / n0 over everything near, cut links included (Eq 15).
template <int D>
void particle_number_density(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Surface particles: n < 0.97 n0, |sum w r/|r|| > 0.12 n0 and nothing ahead within 1.8 l0 and 45 degrees (numerics-fluid 4(ii)2 with a cone
// test, so that only the outermost layer is surface for any kernel radius); or n < 0.8 n0 and |sum w r/|r|| > 0.2 n0 whatever lies ahead (a
// contact line has the wall there); or n < 0.5 n0. 2 = has a surface neighbour.
template <int D>
void find_free_surface(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Cuts the links (weight 0) between fluid particles on opposite sides of a wall thinner than the kernel radius.
template <int D>
void cut_links_through_walls(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// How many of the surface particles found look into open space: nothing within 0.7 l0 of the point 1.4 l0 ahead. Gaps that the placing of
// particles leaves at curved walls are narrower; they are no free surface.
template <int D>
std::int64_t count_open_surface(const Scene<D>& scene, const State<D>& state, const Workspace<D>& work);

}  // namespace sim
