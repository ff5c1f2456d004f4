#include "geometry/place_particles.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <queue>
#include <sstream>
#include <stdexcept>

#include "geometry/cell_volumes.h"
#include "geometry/relax_particles.h"
#include "geometry/share_cells.h"
#include "geometry/wall_surface.h"

namespace geometry {
namespace {

using Eigen::Vector3d;
using Cell = std::array<int, 3>;
constexpr double standoff = 0.45;  // in l0: no centre is nearer to a curved surface

// The particles of the cells, their bodies, and ghosts: particles of empty space that keep the surface in place while relaxing.
struct Draft {
  std::vector<Vector3d> position;
  std::vector<double> volume;
  std::vector<std::int32_t> body;  // no_body: a ghost
  std::vector<std::uint8_t> mobile;
  std::vector<std::size_t> cell;
};

Draft draft_particles(const SharedCells& cells, const std::vector<std::uint8_t>& relax) {
  Draft draft;
  for (std::size_t c = 0; c < cells.owner.size(); ++c) {
    const bool ghost = cells.owner[c] == no_body;
    if (ghost && (relax[c] == 0 || cells.blocked[c])) continue;
    const Cell cell = cells.lattice.cell(c);
    draft.position.push_back(cells.lattice.center(cell));
    draft.volume.push_back(cells.lattice.volume(cell));
    draft.body.push_back(cells.owner[c]);
    draft.mobile.push_back(relax[c] == 1);
    draft.cell.push_back(c);
  }
  return draft;
}

// Fixed particles that push the moving ones: elastic bodies placed before, obstacles.
struct Fixed {
  std::vector<Vector3d> position;
  std::vector<double> volume;
};

// Obstacles swallow particles, blood or wall, until these make up their volume: one after the other the one that stands most crowded
// beside an obstacle, so that both sides of a sheet give alike.
void give_up_volume(Draft& draft, const PeriodicBox& box, const PlacementOptions& options) {
  if (options.obstacle_position.empty()) return;
  const double support = 2.4 * options.spacing;
  const PointGrid grid(draft.position, support, box), obstacles(options.obstacle_position, support, box);
  const std::size_t n = draft.position.size();
  std::vector<double> crowding(n, -1);  // sum of V W(r) over particles and obstacles; < 0: not beside an obstacle
  const auto kernel = [&](double d2) { return wendland(std::sqrt(d2), support, options.dimension); };
  double debt = 0;
  for (std::size_t o = 0; o < options.obstacle_position.size(); ++o) {
    bool inside = false;
    grid.for_each_near(options.obstacle_position[o], [&](std::size_t i, const Vector3d&, double d2) {
      if (draft.body[i] == no_body || d2 >= options.spacing * options.spacing) return;
      inside = true;
      crowding[i] = 0;
    });
    if (inside) debt += options.obstacle_volume[o];
  }
  using Candidate = std::pair<double, std::ptrdiff_t>;  // crowding, -row: of equals the first row goes first
  std::priority_queue<Candidate> most;
  const auto offer = [&](std::size_t i) { most.emplace(crowding[i], -std::ptrdiff_t(i)); };
  for (std::size_t i = 0; i < n; ++i) {
    if (crowding[i] < 0) continue;
    grid.for_each_near(draft.position[i], [&](std::size_t j, const Vector3d&, double d2) { crowding[i] += draft.volume[j] * kernel(d2); });
    obstacles.for_each_near(draft.position[i],
                            [&](std::size_t o, const Vector3d&, double d2) { crowding[i] += options.obstacle_volume[o] * kernel(d2); });
    offer(i);
  }
  std::vector<std::uint8_t> gone(n, 0);
  while (!most.empty()) {
    const auto [value, row] = most.top();
    const auto i = std::size_t(-row);
    most.pop();
    if (gone[i] || value != crowding[i]) continue;  // offered again since, less crowded
    if (debt < 0.5 * draft.volume[i]) break;
    gone[i] = 1;
    debt -= draft.volume[i];
    grid.for_each_near(draft.position[i], [&](std::size_t j, const Vector3d&, double d2) {
      if (gone[j] || crowding[j] < 0) return;
      crowding[j] -= draft.volume[i] * kernel(d2);
      offer(j);
    });
  }
  Draft kept;
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (gone[i]) continue;
    kept.position.push_back(draft.position[i]);
    kept.volume.push_back(draft.volume[i]);
    kept.body.push_back(draft.body[i]);
    kept.mobile.push_back(draft.mobile[i]);
    kept.cell.push_back(draft.cell[i]);
  }
  draft = std::move(kept);
}

// The room that a fluid leaves for a sheet placed before (an obstacle) is no room for the lattice: a sheet fills whole cells whatever its
// thickness, and cells fitted to so thin a slit would be narrower than the particles they stand for. It is filled, and given up again.
void fill_slits(Shape& shape, const PlacementOptions& options) {
  std::erase_if(shape.subtract, [&](const Shape& part) {
    if (!is_rectilinear(part, options.dimension)) return false;
    const BoundingBox box = bounding_box(part, options.dimension);
    double thickness = box.max.x() - box.min.x();
    for (int k = 1; k < options.dimension; ++k) thickness = std::min(thickness, box.max[k] - box.min[k]);
    if (thickness > 1.5 * options.spacing) return false;
    const auto holds = [&](const Vector3d& at) { return contains(part, at, options.dimension); };
    return std::any_of(options.obstacle_position.begin(), options.obstacle_position.end(), holds);
  });
}

// Keeps a particle on its side: a body's inside by `standoff` of its own surface, a ghost outside all bodies likewise.
void keep_inside(const Shape& shape, Vector3d& position, int dimension, double spacing, double sign) {
  const auto distance = [&](const Vector3d& at) { return sign * signed_distance(shape, at, dimension); };
  for (int i = 0; i < 2; ++i) {
    const double now = distance(position), excess = now + standoff * spacing;
    if (excess <= 1e-9 * spacing) return;
    const Vector3d way = sign * distance_gradient(shape, position, dimension, 0.05 * spacing);
    for (double part : {1.0, 0.5, 0.25}) {  // a body thinner than two standoffs: go where it is deepest
      const Vector3d there = position - part * excess * way;
      if (distance(there) >= now) continue;
      position = there;
      break;
    }
  }
}

void keep_clear(const PointGrid& obstacles, Vector3d& position, double clearance) {
  for (int i = 0; i < 4; ++i) {
    double best = clearance * clearance;
    Vector3d nearest;
    bool found = false;
    obstacles.for_each_near(position, [&](std::size_t, const Vector3d& arm, double d2) {
      if (d2 >= best) return;
      best = d2;
      nearest = arm;
      found = true;
    });
    if (!found) return;
    const double r = std::sqrt(best);
    if (r == 0) return;
    position -= nearest * ((clearance - r) / r + 1e-9);
  }
}

void relax(Draft& draft, const std::vector<PlacedBody>& bodies, const Fixed& fixed, const PlacementLattice& lattice,
           const PlacementOptions& options) {
  std::vector<Vector3d> position = draft.position;
  std::vector<double> volume = draft.volume;
  std::vector<std::uint8_t> mobile = draft.mobile;
  position.insert(position.end(), fixed.position.begin(), fixed.position.end());
  volume.insert(volume.end(), fixed.volume.begin(), fixed.volume.end());
  mobile.resize(position.size(), 0);
  const double clearance = options.obstacle_clearance * options.spacing;
  const PointGrid obstacles(options.obstacle_position, clearance, lattice.periodic);
  Relaxation relaxation;
  relaxation.dimension = options.dimension;
  relaxation.spacing = options.spacing;
  relaxation.sweeps = options.relaxation_sweeps;
  relaxation.periodic = lattice.periodic;
  relaxation.project = [&](std::size_t row, Vector3d& at) {
    at = lattice.periodic.wrap(at);
    if (!options.obstacle_position.empty()) keep_clear(obstacles, at, clearance);
    if (draft.body[row] == no_body) {
      for (const PlacedBody& body : bodies) keep_inside(body.shape, at, options.dimension, options.spacing, -1);
    } else {
      keep_inside(bodies[draft.body[row]].shape, at, options.dimension, options.spacing, 1);
    }
  };
  relax_particles(position, volume, mobile, relaxation);
  std::copy(position.begin(), position.begin() + std::ptrdiff_t(draft.position.size()), draft.position.begin());
}

void append(ParticleSet& set, const Vector3d& position, double volume) {
  set.position.push_back(position);
  set.volume.push_back(volume);
  set.normal.push_back(Vector3d::Zero());
  set.depth.push_back(0);
  set.surface_area.push_back(Vector3d::Zero());
}

// Uneven counts and snapped planes: the volumes add up to what the body holds.
void scale_volumes(ParticleSet& set, double volume) {
  double sum = 0;
  for (double v : set.volume) sum += v;
  for (double& v : set.volume) v *= volume / sum;
}

// Vector area that the cells' open faces give to their particles; exact for straight bodies.
void add_face_areas(ParticleSet& set, const Draft& draft, const SharedCells& cells, int dimension) {
  for (std::size_t i = 0; i < draft.cell.size(); ++i) {
    const Cell home = cells.lattice.cell(draft.cell[i]);
    const Vector3d pitch = cells.lattice.pitch(home);
    for (int k = 0; k < dimension; ++k)
      for (int step : {-1, 1}) {
        Cell offset{}, next;
        offset[k] = step;
        if (cells.lattice.neighbor(home, offset, next) && cells.owner[cells.lattice.index(next[0], next[1], next[2])] == draft.body[i])
          continue;
        set.surface_area[i][k] += step * pitch.prod() / pitch[k];
      }
  }
}

// Volumes of the cells of a curved body's particles, and the particles moved to their cells' centroids (Lloyd's method): there a sum of
// values at particles is right to second order, and a body of few layers keeps the same stiffness all round.
void fill_cells(ParticleSet& set, const std::vector<std::uint8_t>& mobile, const Shape& shape, const PeriodicBox& box,
                const PlacementOptions& options) {
  constexpr int sweeps = 4;
  for (int sweep = 0;; ++sweep) {
    Cells cells = cell_volumes(shape, set.position, set.depth, options.dimension, options.spacing, box);
    if (sweep == sweeps) {
      set.volume = std::move(cells.volume);
      return;
    }
    for (std::size_t i = 0; i < set.size(); ++i) {
      if (!mobile[i]) continue;
      set.position[i] = box.wrap(set.position[i] + cells.centroid[i]);
      set.depth[i] = std::max(0.0, -signed_distance(shape, set.position[i], options.dimension));
    }
  }
}

ParticleSet place_elastic(const std::vector<PlacedBody>& all, int which, const PlacementOptions& options, std::size_t& relaxed) {
  const std::vector<PlacedBody> bodies{all[which]};
  PlacementOptions alone = options;
  alone.obstacle_position.clear();
  SharedCells cells = share_cells(bodies, {0}, alone);
  const double volume = true_volume(bodies[0], cells.lattice, options);
  const bool straight = is_rectilinear(bodies[0].shape, options.dimension);
  if (!straight) balance_volume(cells, bodies, {0}, 0, volume, options);
  const std::vector<std::uint8_t> relax_flag = cells_to_relax(cells, bodies, alone);
  Draft draft = draft_particles(cells, relax_flag);
  const std::size_t moving = std::count(draft.mobile.begin(), draft.mobile.end(), 1);
  if (moving > 0) relax(draft, bodies, {}, cells.lattice, alone);
  ParticleSet set;
  Draft own;
  for (std::size_t i = 0; i < draft.position.size(); ++i) {
    if (draft.body[i] == no_body) continue;
    append(set, draft.position[i], draft.volume[i]);
    set.depth.back() = std::max(0.0, -signed_distance(bodies[0].shape, draft.position[i], options.dimension));
    own.cell.push_back(draft.cell[i]);
    own.body.push_back(0);
    own.mobile.push_back(draft.mobile[i]);
  }
  if (set.size() == 0) return set;
  if (moving > 0) fill_cells(set, own.mobile, bodies[0].shape, cells.lattice.periodic, options);
  scale_volumes(set, volume);
  if (moving > 0) {
    set.surface = surface_shares(bodies[0].shape, set.position, options.dimension, options.spacing, volume);
    for (const SurfaceShare& share : set.surface) set.surface_area[share.particle] += share.area;
  } else {
    add_face_areas(set, own, cells, options.dimension);
  }
  relaxed += moving;
  return set;
}

void add_wall_surfaces(std::vector<ParticleSet>& sets, const std::vector<PlacedBody>& bodies, const SharedCells& cells,
                       const PlacementOptions& options) {
  std::vector<const Shape*> solids;
  for (const PlacedBody& body : bodies)
    if (body.matter != Matter::fluid) solids.push_back(&body.shape);
  std::vector<std::uint8_t> solid(cells.owner.size()), fluid(cells.owner.size());
  for (std::size_t c = 0; c < solid.size(); ++c) {
    const bool owned = cells.owner[c] != no_body;
    const Vector3d center = cells.lattice.center(cells.lattice.cell(c));
    const bool outside =
        (center.array() < cells.lattice.bodies.min.array()).any() || (center.array() > cells.lattice.bodies.max.array()).any();
    solid[c] = outside || cells.blocked[c] || (owned && bodies[cells.owner[c]].matter == Matter::wall);
    fluid[c] = owned && bodies[cells.owner[c]].matter == Matter::fluid;
  }
  const std::vector<std::uint8_t> reachable = reachable_cells(cells.lattice, solid, fluid);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].matter != Matter::wall) continue;
    const auto feet =
        exposed_surface(sets[b].position, solids, bodies[b].shape, cells.lattice, fluid, reachable, 6 * options.spacing, options.spacing);
    ParticleSet kept;
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (feet[i].depth > options.wall_depth_limit) continue;
      append(kept, sets[b].position[i], sets[b].volume[i]);
      kept.normal.back() = feet[i].normal;
      kept.depth.back() = feet[i].depth;
    }
    sets[b] = std::move(kept);
  }
}

void place_fluid_and_walls(std::vector<PlacedBody> bodies, const PlacementOptions& options, Placement& placement) {
  for (PlacedBody& body : bodies)
    if (body.matter == Matter::fluid) fill_slits(body.shape, options);
  std::vector<int> members;
  for (Matter matter : {Matter::fluid, Matter::wall})
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (bodies[b].matter == matter) members.push_back(int(b));
  if (members.empty()) return;
  SharedCells cells = share_cells(bodies, members, options);
  std::vector<double> volume(bodies.size(), 0);
  for (int m : members) {
    volume[m] = true_volume(bodies[m], cells.lattice, options);
    // A wall's volume matters to nobody; a cell that it gave up would be a hole beside the fluid.
    if (bodies[m].matter == Matter::wall && options.obstacle_position.empty()) continue;
    if (!is_rectilinear(bodies[m].shape, options.dimension)) balance_volume(cells, bodies, members, m, volume[m], options);
  }
  Draft draft = draft_particles(cells, cells_to_relax(cells, bodies, options));
  give_up_volume(draft, cells.lattice.periodic, options);
  const std::size_t moving = std::count(draft.mobile.begin(), draft.mobile.end(), 1);
  if (moving > 0) {
    Fixed fixed{options.obstacle_position, options.obstacle_volume};
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].matter != Matter::elastic) continue;
      const ParticleSet& set = placement.bodies[b];
      fixed.position.insert(fixed.position.end(), set.position.begin(), set.position.end());
      fixed.volume.insert(fixed.volume.end(), set.volume.begin(), set.volume.end());
    }
    relax(draft, bodies, fixed, cells.lattice, options);
  }
  placement.relaxed += moving;
  for (std::size_t i = 0; i < draft.position.size(); ++i)
    if (draft.body[i] != no_body) append(placement.bodies[draft.body[i]], draft.position[i], draft.volume[i]);
  for (int m : members)
    if (placement.bodies[m].size() > 0 && options.obstacle_position.empty()) scale_volumes(placement.bodies[m], volume[m]);
  add_wall_surfaces(placement.bodies, bodies, cells, options);
}

void check_elastic_inside_others(const std::vector<PlacedBody>& bodies, const Placement& placement, const PlacementOptions& options) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].matter != Matter::elastic) continue;
    for (const Vector3d& at : placement.bodies[b].position)
      for (std::size_t o = 0; o < bodies.size(); ++o)
        if (o != b && signed_distance(bodies[o].shape, at, options.dimension) < -0.25 * options.spacing)
          refuse_overlap(bodies[b], bodies[o], at, options.dimension);
  }
}

}  // namespace

std::vector<std::int64_t> estimate_particle_counts(const std::vector<PlacedBody>& bodies, const PlacementOptions& options) {
  std::vector<std::int64_t> counts;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BoundingBox box = bounding_box(bodies[b].shape, options.dimension);
    const double extent = (box.max - box.min).maxCoeff();
    if (!std::isfinite(extent)) throw std::invalid_argument(bodies[b].name + ": shape has no end; give it bounds with `intersect`");
    PlacementOptions coarse = options;
    coarse.spacing = std::max(options.spacing, extent / 64);
    const PlacementLattice lattice = make_placement_lattice(bodies, {int(b)}, coarse);
    const double count = true_volume(bodies[b], lattice, options) / std::pow(options.spacing, options.dimension);
    counts.push_back(std::llround(std::min(count, 1e15)));  // beyond any limit, and sums of them still fit
  }
  return counts;
}

Placement place_particles(const std::vector<PlacedBody>& bodies, const PlacementOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  if (!(options.spacing > 0)) throw std::invalid_argument("spacing must be positive");
  for (const PlacedBody& body : bodies) check_shape(body.shape, options.dimension, "body \"" + body.name + "\"");
  std::int64_t total = 0;
  for (std::int64_t count : estimate_particle_counts(bodies, options)) total += count;
  if (total > options.particle_limit) {
    std::ostringstream out;
    out << "the scene would have about " << total << " particles, more than limits.particles = " << options.particle_limit
        << "; use a larger spacing than " << options.spacing << " or raise the limit";
    throw std::invalid_argument(out.str());
  }
  check_overlaps(bodies, options);
  Placement placement;
  placement.bodies.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].matter == Matter::elastic) placement.bodies[b] = place_elastic(bodies, int(b), options, placement.relaxed);
  check_elastic_inside_others(bodies, placement, options);
  place_fluid_and_walls(bodies, options, placement);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (placement.bodies[b].size() == 0) {
      std::ostringstream out;
      out << "body \"" << bodies[b].name << "\" gets no particle: it is thinner than the spacing " << options.spacing
          << " allows or hidden in others";
      throw std::invalid_argument(out.str());
    }
  placement.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return placement;
}

}  // namespace geometry
