// Elastic solids of two or more particle layers: total-Lagrangian particles with a quadratic least-squares fit of the displacement
// ("TL2", numerics-elastic.md 3(ii)). Everything that is fixed by the rest configuration is built once; forces are pure functions of
// positions. Rows are those of State: [0, n), bodies contiguous; a particle has neighbours within its own body only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/elastic_law.h"
#include "sim/particles.h"
#include "sim/scene_description.h"

namespace sim {

// Number of coefficients of the fit: D first derivatives, then D (D+1)/2 second ones (xx, yy[, zz], then xy[, xz, yz]).
template <int D>
inline constexpr int fit_size = D + D*(D + 1) / 2;
template <int D>
using FitRow = Eigen::Matrix<double, fit_size<D>, 1>;
// Derivatives of the displacement at a particle: row k holds those of u_k. Columns 0..D-1 are grad u (1), the rest second derivatives
// (1/m).
template <int D>
using Derivatives = Eigen::Matrix<double, D, fit_size<D>>;

// The monomials [R; R_a^2/2; R_a R_b] that a fit's coefficients multiply.
template <int D>
FitRow<D> monomials(const Vector<D>& offset);

// A fit of some displacement components of one particle over a list of links. Particles away from clamps have one fit for all components.
struct SolidFit {
  std::int32_t row = 0;
  std::uint8_t components = 0;        // bit k: the fit serves u_k
  std::int64_t first = 0, count = 0;  // its links
  double residual_stiffness = 0;      // c, N/m per unit weight: energy c/2 sum w |e|^2 of what the fit does not represent
};

template <int D>
struct SolidElasticity {
  double spacing = 0;                // l0, m
  std::vector<Vector<D>> rest;       // m
  std::vector<double> volume, mass;  // m^3 (2-D: m^2), kg (2-D: kg/m)
  std::vector<double> cell_moment;   // m^2: second moment l^2/12 of the particle's cell along each axis
  std::vector<double> damping;       // 1/s, mass-proportional
  std::vector<double> wave_speed;    // m/s
  std::vector<std::uint8_t> fixed;   // bit k: u_k is held at 0
  std::vector<std::int32_t> body;
  std::vector<ElasticLawPoint<D>> law;
  std::vector<Vector<D>> surface_area;      // m^2, outward
  std::vector<double> depth;                // m below the surface
  std::vector<std::int64_t> surface_begin;  // as in InitialParticles; empty: of lattice cells
  std::vector<Vector<D>> piece_area, piece_offset;

  std::vector<SolidFit> fits;           // grouped by row
  std::vector<std::int64_t> fit_begin;  // n + 1: fits of row i are [fit_begin[i], fit_begin[i+1])
  // Links, grouped by fit. neighbor -1: a point of a clamp's face, whose displacement is 0.
  std::vector<std::int32_t> neighbor;
  std::vector<Vector<D>> offset;  // m, to the neighbour at rest
  std::vector<double> weight;
  std::vector<FitRow<D>> shape;                        // derivatives per unit displacement difference: 1/m and 1/m^2
  std::vector<std::int64_t> incoming_begin, incoming;  // links that end at a row, for a sum in fixed order

  // Where the body is two layers thick (or nearly incompressible and thin) the volumetric strain is averaged over the column.
  std::vector<std::int32_t> partner;  // row across the thickness, or -1

  double rest_step_limit = 0;  // s: 2 / (highest angular frequency) at rest, from a power iteration

  std::size_t size() const { return rest.size(); }
};

// Rest data for all Kind::elastic rows; an empty structure where the scene has none. Throws std::invalid_argument with one line naming the
// body on impossible material constants, on a body one particle thick, and on particles without neighbours.
template <int D>
SolidElasticity<D> build_solids(const SceneDescription<D>& scene);

// Scratch of solid_forces, reused between calls.
template <int D>
struct SolidWork {
  std::vector<Derivatives<D>> derivatives, stress;  // per row; stress = V dW/dY
  std::vector<double> volumetric, volumetric_stress;
  std::vector<Vector<D>> link_force;
};

// Internal elastic forces, N (2-D: N/m): force is overwritten on rows [0, n). position in m, first n rows read.
template <int D>
void solid_forces(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work, std::span<Vector<D>> force);
// Adds the mass-proportional damping -damping m v.
template <int D>
void solid_damping(const SolidElasticity<D>& solid, std::span<const Vector<D>> velocity, std::span<Vector<D>> force);

// Stored energy, J (2-D: J/m).
template <int D>
double solid_energy(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work);

// Largest stable explicit step, s: factor * l0/c over the rows, never more than 0.9 of the limit measured at rest; shrinks with compression
// and with the stiffening of stretched fibres. factor = SchemeSettings::elastic_substep, refused (std::invalid_argument) above 0.5.
template <int D>
double solid_time_step_limit(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, double factor);

// Derivatives of the displacement at every row into work.derivatives.
template <int D>
void solid_derivatives(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work);

// The stress of the mean volumetric strain: true where the row shares its volumetric strain with a partner.
template <int D>
bool shares_volume(const SolidElasticity<D>& solid, std::size_t row) {
  return solid.partner[row] >= 0;
}

}  // namespace sim
