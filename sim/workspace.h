// Scratch of a step: reused, never saved. One entry a row unless said otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/contact.h"
#include "sim/gap_film.h"
#include "sim/linear_solver.h"
#include "sim/multigrid.h"
#include "sim/neighbors.h"
#include "sim/particles.h"
#include "sim/solid_dynamics.h"
#include "sim/stage.h"

namespace sim {

// An element of a leaflet as it lies now.
template <int D>
struct SheetElement {
  Vector<D> origin, normal, center;       // m; the normal is not unit
  Eigen::Matrix<double, D, D - 1> edges;  // 3-D: e1, e2; 2-D: the segment
  double offset = 0, reach = 0;           // normal . origin; largest distance of a corner from the centre, m
};

// A padded vector in single precision.
template <int D>
using ShortVector = Eigen::Matrix<float, Padded<D>::RowsAtCompileTime, 1>;

// Density errors and their derivatives (density_projection.h). Rows are fluid rows, counted from the first; links lie where the row's
// neighbours do, [neighbors.start, last).
template <int D>
struct DensityProblem {
  std::vector<Padded<D>> position;           // m, of all rows, after the step's motion
  std::vector<ShortVector<D>> place;         // m, of the fluid rows, from the first of them
  std::vector<std::uint8_t> active;          // whether the row's error is to be mended
  std::vector<float> error;                  // C = n/n0 - 1, then what is left of it, -
  std::vector<ShortVector<D>> own;           // dC_i/dx_i, 1/m
  std::vector<float> steepness;              // per link: dC_i/dx_i by it over the way to the neighbour, 1/m²
  std::vector<std::int32_t> column;          // per link: row of the neighbour
  std::vector<std::int64_t> last;            // per row: end of its links
  std::vector<float> inverse_diagonal;       // m²
  std::vector<float> multiplier, direction;  // m²
  std::vector<float> product;                // -
  std::vector<ShortVector<D>> displacement;  // m
};

template <int D>
struct Workspace {
  // who is near whom
  Neighbors neighbors;
  CellGrid<D> grid;
  std::vector<Search> search;
  std::vector<std::uint8_t> is_fluid;
  std::vector<double> link_weight;  // per neighbour entry: w(|r_ij|) times the share of a cell that j fills; 0 = link cut

  std::vector<Padded<D>> position;  // m, of the step's start; filled by link_weights
  std::vector<Padded<D>> velocity;  // m/s, of the step's start; filled by velocity_gradients

  // boundary particles as they are now (rows below first_fluid)
  std::vector<Vector<D>> boundary_normal;     // unit, into the fluid (shell: + side)
  std::vector<Vector<D>> boundary_velocity;   // m/s of the surface, dragging included
  std::vector<Tensor<D>> boundary_curvature;  // 1/m, see wall_curvatures; empty where no wall is curved

  // the fluid's state, operator by operator
  std::vector<double> number_density;      // n_i / n0
  std::vector<std::uint8_t> surface;       // 1 at the free surface, 2 next to it
  std::vector<Vector<D>> surface_outward;  // unit direction out of the fluid times -sum w r over fluid along it, m; 0 away from the surface
  std::vector<double> surface_sample;  // 1/m, weight of the surface as a sample of the pressure (operators.cpp); 0 away from the surface
  std::vector<Tensor<D>> velocity_inverse;   // inverse moment matrix over fluid and surface points
  std::vector<Tensor<D>> pressure_inverse;   // inverse moment matrix over fluid alone
  std::vector<Tensor<D>> velocity_gradient;  // (grad v)_ab = d v_a / d x_b, 1/s
  std::vector<DyadSum<D>> gradient_columns;  // the same in padded columns
  std::vector<double> viscosity;             // Pa s
  std::vector<double> pair_viscosity;        // Pa s, per link of fluid rows; empty: the harmonic mean of the ends'
  std::vector<float> grip;                   // 1, or less beside a port whose profile is not resolved: share of the wall's drag
  std::vector<Vector<D>> acceleration;       // m/s², all but pressure
  std::vector<Vector<D>> pressure_gradient;  // Pa/m
  std::vector<Vector<D>> displacement;       // m, shifting
  std::vector<Vector<D>> velocity_old;       // m/s at the start of the step

  // the pressure problem
  std::vector<std::int32_t> unknown;      // row -> unknown, -1
  std::vector<std::int32_t> unknown_row;  // unknown -> row
  SymmetricMatrix matrix;
  SymmetricMatrix side_links;  // what the leaflets add to the multigrid's matrix (leaflet_coupling.h)
  std::vector<double> source, solution;
  Multigrid multigrid;
  ConjugateGradientScratch scratch;

  DensityProblem<D> density;

  // the viscosity problem
  SymmetricMatrix viscous_matrix;
  std::vector<Vector<D>> viscous_source, viscous_solution;  // Pa/m, m/s
  VectorScratch<D> viscous_scratch;

  // solids
  SolidMotion<D> solid_motion;
  SolidOperator<D> solid_operator;  // M + dt² K
  double solid_factor_step = 0;     // s, the dt it was factorised for
  int solid_factor_age = 0;         // steps since
  std::vector<Vector<D>> solid_position, solid_velocity;
  struct SolidLink {
    std::int32_t unknown;
    Vector<D> area;  // m² (2-D: m): volume flux of the unknown per unit velocity, and force per unit pressure
  };
  std::vector<std::int64_t> solid_link_start;
  std::vector<SolidLink> solid_links;

  // leaflets
  std::optional<Contact<D>> contact;  // a copy of the scene's: it keeps its search between steps
  std::vector<SheetElement<D>> sheet_elements;
  std::vector<std::int32_t> near_sheet;  // fluid rows with a shell particle within the radius
  struct WetLink {
    std::int32_t unknown;
    double weight;
  };
  // Blood that wets face f = 2 s + side of shell row s, side 0 where its normal points, 1 the other: wetting[wet_start[f]] …
  // wetting[wet_start[f + 1] - 1], weights sum to 1.
  std::vector<std::int32_t> wet_start;
  std::vector<WetLink> wetting;
  // The same by unknown: those that wet any face, ascending, and each one's faces.
  struct WetFace {
    std::int32_t face;
    double weight;
  };
  std::vector<std::int32_t> wet_unknown, wet_unknown_start;
  std::vector<WetFace> wet_faces;
  std::vector<double> support;    // fluid rows: 1, or less where leaflets hide so much of the blood around that its volume
                                  // balance cannot be told (0 below 0.25 n0 of visible blood, 1 above 0.5 n0)
  std::vector<double> wet_share;  // face: 1 wet, 0 dry
  GapFilm film;                   // pressure on the faces that are not fully wet
  struct Coupling {
    std::int32_t shell;  // shell row
    double strength;     // A²/m, m⁴/kg
  };
  std::vector<Coupling> coupling;  // rows that are free to move
  struct SideMemory {
    std::int32_t element = -1;
    std::int8_t side = 0;
  };
  std::vector<SideMemory> side_memory;  // per entry of near_sheet
  std::vector<Vector<D>> shell_position, shell_velocity, shell_normal, shell_mean_force, shell_outer_force, shell_free_velocity;
  std::vector<double> shell_area, shell_normal_mass;  // m², kg: that moves along the normal, with the blood that follows
  std::vector<Vector<D>> boundary_force;              // rows of solids and shells: the blood's drag, N

  State<D> before;         // the step's start, to which a refused step goes back
  StageTimes stage_times;  // of this run
};

}  // namespace sim
