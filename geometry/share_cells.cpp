#include "geometry/share_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace geometry {
namespace {

using Eigen::Vector3d;
using Cell = std::array<int, 3>;

std::vector<Cell> ball(int cells, int dimension) {
  std::vector<Cell> offsets;
  const int deep = dimension == 3 ? cells : 0;
  for (int c = -deep; c <= deep; ++c)
    for (int b = -cells; b <= cells; ++b)
      for (int a = -cells; a <= cells; ++a)
        if (a * a + b * b + c * c <= cells * cells) offsets.push_back({a, b, c});
  return offsets;
}

// A cell is cut when the surface is nearer to its centre than half the cell, or is at no half pitch at all.
bool cut_by_surface(double distance, const PlacementLattice& lattice, const Cell& cell) {
  const Vector3d pitch = lattice.pitch(cell);
  const double size = std::abs(distance);
  for (int k = 0; k < lattice.dimension; ++k)
    if (std::abs(size - 0.5 * pitch[k]) < 0.02 * pitch[k]) return false;
  return size < 0.48 * lattice.smallest_pitch(cell);
}

// Two rectilinear bodies overlap where a cell between any of their planes lies in both.
void check_rectilinear_pair(const PlacedBody& one, const PlacedBody& other, const PlacementOptions& options) {
  PlacementLattice cells;
  cells.dimension = options.dimension;
  cells.edge[2] = {-0.5, 0.5};
  for (int axis = 0; axis < options.dimension; ++axis) {
    std::vector<double> planes = face_planes(one.shape, options.dimension, axis);
    for (double p : face_planes(other.shape, options.dimension, axis)) planes.push_back(p);
    std::sort(planes.begin(), planes.end());
    cells.edge[axis] = planes;
    if (planes.size() < 2) return;
  }
  const double touch = 1e-3 * options.spacing;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const Cell cell = cells.cell(c);
    if (cells.smallest_pitch(cell) <= touch) continue;
    const Vector3d center = cells.center(cell);
    if (signed_distance(one.shape, center, options.dimension) < 0 && signed_distance(other.shape, center, options.dimension) < 0)
      refuse_overlap(one, other, center, options.dimension);
  }
}

}  // namespace

void refuse_overlap(const PlacedBody& one, const PlacedBody& other, const Vector3d& at, int dimension) {
  std::ostringstream out;
  out << "bodies \"" << one.name << "\" and \"" << other.name << "\" overlap, for example at (" << at.x() << ", " << at.y();
  if (dimension == 3) out << ", " << at.z();
  out << "); take one out of the other with `subtract`";
  throw std::invalid_argument(out.str());
}

void check_overlaps(const std::vector<PlacedBody>& bodies, const PlacementOptions& options) {
  std::vector<std::uint8_t> straight;
  std::vector<BoundingBox> boxes;
  for (const PlacedBody& body : bodies) {
    straight.push_back(is_rectilinear(body.shape, options.dimension));
    boxes.push_back(bounding_box(body.shape, options.dimension));
  }
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a + 1; b < bodies.size(); ++b)
      if (straight[a] && straight[b] && !(boxes[a].min.array() > boxes[b].max.array()).any() &&
          !(boxes[b].min.array() > boxes[a].max.array()).any())
        check_rectilinear_pair(bodies[a], bodies[b], options);
}

SharedCells share_cells(const std::vector<PlacedBody>& bodies, const std::vector<int>& members, const PlacementOptions& options) {
  SharedCells cells;
  cells.lattice = make_placement_lattice(bodies, members, options);
  const PlacementLattice& lattice = cells.lattice;
  if (double(lattice.count(0)) * lattice.count(1) * lattice.count(2) > 5e8)
    throw std::invalid_argument("the bodies span more than 500 million particle spacings; use a coarser spacing");
  cells.owner.assign(lattice.size(), no_body);
  cells.distance.assign(lattice.size(), 0);
  cells.blocked.assign(lattice.size(), 0);
  std::vector<std::uint8_t> is_member(bodies.size(), 0);
  for (int m : members) is_member[m] = 1;
  std::size_t overlap = std::numeric_limits<std::size_t>::max();
#pragma omp parallel for schedule(dynamic, 4096) reduction(min : overlap)
  for (std::ptrdiff_t c = 0; c < std::ptrdiff_t(lattice.size()); ++c) {
    const Cell cell = lattice.cell(c);
    const Vector3d center = lattice.center(cell);
    const double touch = 0.25 * lattice.smallest_pitch(cell);
    double least = std::numeric_limits<double>::infinity();
    int deep = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const double distance = signed_distance(bodies[b].shape, center, options.dimension);
      deep += distance < -touch;
      if (!is_member[b]) {
        cells.blocked[c] |= distance <= 0;
        continue;
      }
      if (distance < least) {
        least = distance;
        if (distance <= 0) cells.owner[c] = std::int32_t(b);
      }
    }
    if (cells.blocked[c]) cells.owner[c] = no_body;
    cells.distance[c] = float(least);
    if (deep > 1) overlap = std::min(overlap, std::size_t(c));
  }
  if (overlap < lattice.size()) {
    const Vector3d at = lattice.center(lattice.cell(overlap));
    std::vector<std::size_t> in;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (signed_distance(bodies[b].shape, at, options.dimension) < 0) in.push_back(b);
    refuse_overlap(bodies[in[0]], bodies[in[1]], at, options.dimension);
  }
  return cells;
}

double true_volume(const PlacedBody& body, const PlacementLattice& lattice, const PlacementOptions& options) {
  Shape shape = body.shape;
  for (int k = 0; k < options.dimension; ++k)
    if (options.periodic[k])
      for (double sign : {-1.0, 1.0}) {
        Shape half;
        half.base = HalfSpace{sign < 0 ? options.domain_min : options.domain_max, sign * Vector3d::Unit(k)};
        shape.intersect.push_back(half);
      }
  if (is_rectilinear(shape, options.dimension)) return rectilinear_volume(shape, options.dimension);
  return cut_cell_volume(shape, lattice);
}

void balance_volume(SharedCells& cells, const std::vector<PlacedBody>& bodies, const std::vector<int>& members, int body, double volume,
                    const PlacementOptions& options) {
  const PlacementLattice& lattice = cells.lattice;
  struct Candidate {
    double distance, volume;
    std::size_t cell;
  };
  std::vector<Candidate> candidates;
  const double most = 0.25 * options.spacing;
  double sure = 0;
  for (std::size_t c = 0; c < lattice.size(); ++c) {
    const bool own = cells.owner[c] == body;
    if (own && cells.distance[c] < -most) {
      sure += lattice.volume(lattice.cell(c));
      continue;
    }
    const bool free = cells.owner[c] == no_body || (bodies[body].matter == Matter::fluid && bodies[cells.owner[c]].matter == Matter::wall);
    if ((!own && (!free || cells.blocked[c])) || std::abs(cells.distance[c]) > most) continue;
    const Cell cell = lattice.cell(c);
    const double distance = own ? cells.distance[c] : signed_distance(bodies[body].shape, lattice.center(cell), options.dimension);
    if (distance <= most) candidates.push_back({distance, lattice.volume(cell), c});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  // Cells equally far from the surface (all along a straight pipe, say) are taken evenly spaced: dropping the last ones would leave a hole.
  std::vector<std::uint8_t> taken(candidates.size(), 0);
  for (std::size_t first = 0, last = 0; first < candidates.size(); first = last) {
    while (last < candidates.size() && candidates[last].distance - candidates[first].distance < 1e-6 * options.spacing) ++last;
    const std::size_t count = last - first;
    const auto wanted = std::llround((volume - sure) / candidates[first].volume);
    const std::size_t takes = std::size_t(std::clamp<long long>(wanted, 0, (long long)(count)));
    for (std::size_t k = 0; k < count; ++k) taken[first + k] = (k + 1) * takes / count > k * takes / count;
    for (std::size_t k = first; k < last; ++k)
      if (taken[k]) sure += candidates[k].volume;
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& candidate = candidates[k];
    const bool take = taken[k] != 0;
    if (take == (cells.owner[candidate.cell] == body)) continue;
    cells.owner[candidate.cell] = take ? body : no_body;
    cells.distance[candidate.cell] = float(candidate.distance);
    if (take || bodies[body].matter == Matter::wall) continue;
    const Vector3d center = lattice.center(lattice.cell(candidate.cell));
    for (int m : members)  // what the fluid gives up falls to the wall behind it
      if (bodies[m].matter == Matter::wall && signed_distance(bodies[m].shape, center, options.dimension) <= most)
        cells.owner[candidate.cell] = m;
  }
}

std::vector<std::uint8_t> cells_to_relax(const SharedCells& cells, const std::vector<PlacedBody>& bodies, const PlacementOptions& options) {
  const PlacementLattice& lattice = cells.lattice;
  std::vector<std::uint8_t> straight, flag(lattice.size(), 0);
  for (const PlacedBody& body : bodies) straight.push_back(is_rectilinear(body.shape, options.dimension));
  std::vector<std::size_t> cut;
  for (std::size_t c = 0; c < lattice.size(); ++c)
    if (cells.owner[c] != no_body && !straight[cells.owner[c]] && cut_by_surface(cells.distance[c], lattice, lattice.cell(c)))
      cut.push_back(c);
  const PointGrid* obstacles = nullptr;
  const PointGrid near_obstacle(options.obstacle_position, 1.5 * options.spacing);
  if (!options.obstacle_position.empty()) obstacles = &near_obstacle;
  if (obstacles)
    for (std::size_t c = 0; c < lattice.size(); ++c) {
      if (cells.owner[c] == no_body) continue;
      bool near = false;
      obstacles->for_each_near(lattice.center(lattice.cell(c)), [&](std::size_t, const Vector3d&, double) { near = true; });
      if (near) cut.push_back(c);
    }
  const auto spread = [&](int reach, std::uint8_t value) {
    const std::vector<Cell> offsets = ball(reach, options.dimension);
    for (std::size_t c : cut) {
      const Cell home = lattice.cell(c);
      Cell cell;
      for (const Cell& offset : offsets)
        if (lattice.neighbor(home, offset, cell)) {
          std::uint8_t& f = flag[lattice.index(cell[0], cell[1], cell[2])];
          if (f == 0) f = value;
        }
    }
  };
  spread(3, 1);
  spread(6, 2);
  return flag;
}

}  // namespace geometry
