#include "geometry/valve_template.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "geometry/leaflet_membrane.h"

namespace geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double turn = 2 * std::numbers::pi;

// All in the root's frame: (x, y, z) with z along the axis.
struct Sector {
  double from = 0, to = 0;                // angles of the commissures, rad
  double from_height = 0, to_height = 0;  // m
  double nadir_height = 0;
  double middle() const { return 0.5 * (from + to); }
};

Vector3d on_wall(double theta, double z, const WallRadiusFunction& radius_at, double inset) {
  const double r = radius_at(theta, z) + inset;
  return {r * std::cos(theta), r * std::sin(theta), z};
}

// `count` points evenly spaced by arc length along a polyline.
std::vector<Vector3d> even_points(const std::vector<Vector3d>& line, int count) {
  std::vector<double> arc(line.size(), 0);
  for (std::size_t i = 1; i < line.size(); ++i) arc[i] = arc[i - 1] + (line[i] - line[i - 1]).norm();
  std::vector<Vector3d> points;
  std::size_t s = 1;
  for (int k = 0; k < count; ++k) {
    const double at = arc.back() * k / (count - 1);
    while (s + 1 < line.size() && arc[s] < at) ++s;
    const double t = arc[s] > arc[s - 1] ? (at - arc[s - 1]) / (arc[s] - arc[s - 1]) : 0;
    points.push_back(line[s - 1] + std::clamp(t, 0.0, 1.0) * (line[s] - line[s - 1]));
  }
  return points;
}

// The line on the wall from commissure to nadir to commissure; its ends stand off the sector's planes.
std::vector<Vector3d> attachment_line(const Sector& sector, double standoff, const WallRadiusFunction& radius_at,
                                      const ValveOptions& options) {
  constexpr int steps = 600;
  std::vector<Vector3d> line;
  const double half = 0.5 * (sector.to - sector.from) - standoff;
  for (int i = 0; i <= steps; ++i) {
    // Denser towards the ends, where the curve is steep.
    const double t = std::sin(0.25 * turn * (2.0 * i / steps - 1));
    const double top = t < 0 ? sector.from_height : sector.to_height;
    const double z =
        sector.nadir_height + (top - sector.nadir_height) * (1 - std::pow(std::max(0.0, 1 - t * t), options.attachment_exponent));
    line.push_back(on_wall(sector.middle() + t * half, z, radius_at, options.wall_inset));
  }
  return even_points(line, options.columns);
}

double bezier_length(const Vector3d& a, const Vector3d& control, const Vector3d& b) {
  double length = 0;
  Vector3d before = a;
  for (int i = 1; i <= 40; ++i) {
    const double t = i / 40.0;
    const Vector3d point = (1 - t) * (1 - t) * a + 2 * t * (1 - t) * control + t * t * b;
    length += (point - before).norm();
    before = point;
  }
  return length;
}

// From attachment to free edge, hanging low enough to have the wanted length.
std::vector<Vector3d> profile(const Vector3d& attachment, const Vector3d& edge, double coaptation, const ValveOptions& options) {
  const Vector3d middle = 0.5 * (attachment + edge), corner(edge.x(), edge.y(), attachment.z());
  const double wanted = options.surplus * (attachment - (edge - coaptation * Vector3d::UnitZ())).norm() + coaptation;
  double low = 0, high = 2;
  for (int i = 0; i < 60; ++i) {
    const double share = 0.5 * (low + high);
    (bezier_length(attachment, middle + share * (corner - middle), edge) < wanted ? low : high) = share;
  }
  const Vector3d control = middle + low * (corner - middle);
  std::vector<Vector3d> curve;
  for (int i = 0; i <= 200; ++i) {
    const double t = i / 200.0;
    curve.push_back((1 - t) * (1 - t) * attachment + 2 * t * (1 - t) * control + t * t * edge);
  }
  return even_points(curve, options.rows);
}

// The closed design: lengths for the material, reaching `over_closure` past the axis.
std::vector<Vector3d> closed_design(const Sector& sector, const std::vector<Vector3d>& attachment, const LeafletMeasures& measures,
                                    const ValveOptions& options) {
  const double middle = sector.middle();
  const Vector3d tip(-options.over_closure * std::cos(middle), -options.over_closure * std::sin(middle), measures.edge_center_height);
  const Vector3d& first = attachment.front();
  const Vector3d& last = attachment.back();
  std::vector<Vector3d> points(std::size_t(options.columns) * options.rows);
  for (int c = 0; c < options.columns; ++c) {
    const double w = 2.0 * c / (options.columns - 1) - 1;
    const Vector3d edge = w < 0 ? Vector3d(tip - w * (first - tip)) : Vector3d(tip + w * (last - tip));
    const double coaptation = measures.coaptation_height * (1 - std::abs(w));
    const bool end = c == 0 || c == options.columns - 1;
    const std::vector<Vector3d> line =
        end ? std::vector<Vector3d>(options.rows, attachment[c]) : profile(attachment[c], edge, coaptation, options);
    for (int r = 0; r < options.rows; ++r) points[std::size_t(r) * options.columns + c] = line[r];
  }
  return points;
}

// Wall radius over a sector, tabled: asked for every node in every iteration.
class WallTable {
 public:
  WallTable(const Sector& sector, double low, double high, const WallRadiusFunction& radius_at)
      : from_(sector.from - 0.3), to_(sector.to + 0.3), low_(low), high_(high), radius_(std::size_t(around + 1) * (up + 1)) {
    for (int j = 0; j <= up; ++j)
      for (int i = 0; i <= around; ++i)
        radius_[std::size_t(j) * (around + 1) + i] = radius_at(from_ + (to_ - from_) * i / around, low_ + (high_ - low_) * j / up);
  }
  double at(double theta, double z) const {
    if (!std::isfinite(theta) || !std::isfinite(z)) return 0;  // relaxed_reference refuses what did not settle
    while (theta < from_ - 0.5 * (turn - (to_ - from_))) theta += turn;
    while (theta > to_ + 0.5 * (turn - (to_ - from_))) theta -= turn;
    const double x = std::clamp((theta - from_) / (to_ - from_), 0.0, 1.0) * around,
                 y = std::clamp((z - low_) / (high_ - low_), 0.0, 1.0) * up;
    const int i = std::min(int(x), around - 1), j = std::min(int(y), up - 1);
    const double* row = radius_.data() + std::size_t(j) * (around + 1) + i;
    const double below = row[0] + (x - i) * (row[1] - row[0]), above = row[around + 1] + (x - i) * (row[around + 2] - row[around + 1]);
    return below + (y - j) * (above - below);
  }

 private:
  static constexpr int around = 96, up = 64;
  double from_, to_, low_, high_;
  std::vector<double> radius_;
};

// Keeps a point in its sector, `offset` off both planes through the axis, and within the wall.
void confine_to_sector(const Sector& sector, double offset, const WallTable& wall, Vector3d& p) {
  const Vector2d from(-std::sin(sector.from), std::cos(sector.from)), to(std::sin(sector.to), -std::cos(sector.to));  // inward normals
  Vector2d xy = p.head<2>();
  for (int i = 0; i < 2; ++i) {
    xy += std::max(0.0, offset - from.dot(xy)) * from;
    xy += std::max(0.0, offset - to.dot(xy)) * to;
  }
  // Nearest point of the wedge when both planes bind: its edge.
  const double both = 1 - std::pow(from.dot(to), 2);
  if (both > 1e-6 && from.dot(xy) < offset - 1e-12) {
    Eigen::Matrix2d planes;
    planes << from.transpose(), to.transpose();
    xy = planes.inverse() * Vector2d(offset, offset);
  }
  const double r = xy.norm(), most = wall.at(std::atan2(xy.y(), xy.x()), p.z());
  if (r > most) xy *= most / r;
  p.head<2>() = xy;
}

// Moves a point straight away from the axis, along the sector's middle, until it is off both planes: a start without folds, since
// neighbours stay beside each other.
void draw_into_sector(const Sector& sector, double offset, Vector3d& p) {
  const Vector2d from(-std::sin(sector.from), std::cos(sector.from)), to(std::sin(sector.to), -std::cos(sector.to));
  const Vector2d away(std::cos(sector.middle()), std::sin(sector.middle()));
  const double lack = std::max({0.0, (offset - from.dot(p.head<2>())) / from.dot(away), (offset - to.dot(p.head<2>())) / to.dot(away)});
  p.head<2>() += lack * away;
}

std::vector<std::array<std::int32_t, 3>> grid_triangles(int columns, int rows) {
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (int r = 0; r + 1 < rows; ++r)
    for (int c = 0; c + 1 < columns; ++c) {
      const std::int32_t a = r * columns + c, b = a + 1, d = a + columns, e = d + 1;
      // Diagonals mirrored about the middle, so that a leaflet is symmetric; the two end columns are one point each.
      const bool left = c < columns / 2;
      const std::array<std::int32_t, 3> one = left ? std::array{a, b, e} : std::array{a, b, d};
      const std::array<std::int32_t, 3> two = left ? std::array{a, e, d} : std::array{b, e, d};
      const auto degenerate = [&](const std::array<std::int32_t, 3>& t) {
        int at_first = 0, at_last = 0;
        for (auto v : t) at_first += v % columns == 0, at_last += v % columns == columns - 1;
        return at_first > 1 || at_last > 1;
      };
      if (!degenerate(one)) triangles.push_back(one);
      if (!degenerate(two)) triangles.push_back(two);
    }
  return triangles;
}

std::vector<Vector3d> relaxed_reference(const Sector& sector, const std::vector<Vector3d>& design, const WallTable& wall,
                                        const ValveOptions& options) {
  MembraneProblem problem;
  problem.rest = design;
  problem.triangles = grid_triangles(options.columns, options.rows);
  problem.tension_modulus = options.reference_modulus * options.thickness;
  problem.pressure = options.reference_pressure;
  // A third of the stiffness under compression and a trace of bending: enough that the surplus length hangs in one wave, not in creases,
  // and rows keep their length (measured: less of the one crumples, more of the other shrinks rows by 7 %).
  problem.compression_share = 0.3;
  problem.fixed.assign(design.size(), 0);
  for (int c = 0; c < options.columns; ++c) problem.fixed[c] = 1;
  for (int r = 0; r < options.rows; ++r) problem.fixed[r * options.columns] = problem.fixed[(r + 1) * options.columns - 1] = 1;
  problem.bending = 2e-4 * problem.tension_modulus;
  for (int r = 1; r < options.rows; ++r)
    for (int c = 1; c + 1 < options.columns; ++c) {
      const std::int32_t node = r * options.columns + c;
      problem.lines.push_back({node - 1, node, node + 1});
      if (r + 1 < options.rows) problem.lines.push_back({node - options.columns, node, node + options.columns});
    }
  problem.confine = [&](Vector3d& p) { confine_to_sector(sector, options.sector_offset, wall, p); };
  std::vector<Vector3d> position = design;
  for (std::size_t i = 0; i < position.size(); ++i)
    if (!problem.fixed[i]) draw_into_sector(sector, options.sector_offset, position[i]);
  relax_membrane(problem, position);
  // With compression resisted in full and more bending, creases open into smooth waves of the same length.
  problem.compression_share = 1;
  problem.bending = options.reference_bending * problem.tension_modulus;
  problem.iterations = options.reference_iterations;
  relax_membrane(problem, position);
  for (const Vector3d& p : position)
    if (!p.allFinite()) throw std::runtime_error("no leaflet settles between the found annulus and commissures; give patient.root's planes");
  return position;
}

double row_length(const std::vector<Vector3d>& points, int columns, int row) {
  double length = 0;
  for (int c = 1; c < columns; ++c) length += (points[std::size_t(row) * columns + c] - points[std::size_t(row) * columns + c - 1]).norm();
  return length;
}

double column_length(const std::vector<Vector3d>& points, int columns, int rows, int column) {
  double length = 0;
  for (int r = 1; r < rows; ++r)
    length += (points[std::size_t(r) * columns + column] - points[std::size_t(r - 1) * columns + column]).norm();
  return length;
}

void add_fibres(LeafletSurface& leaflet) {
  leaflet.fibre.resize(leaflet.reference.size());
  for (int r = 0; r < leaflet.rows; ++r)
    for (int c = 0; c < leaflet.columns; ++c) {
      const int before = std::max(0, c - 1), after = std::min(leaflet.columns - 1, c + 1);
      leaflet.fibre[leaflet.index(r, c)] =
          (leaflet.reference[leaflet.index(r, after)] - leaflet.reference[leaflet.index(r, before)]).normalized();
    }
}

std::string text(const char* format, double a, double b = 0, double c = 0) {
  char line[240];
  std::snprintf(line, sizeof line, format, a, b, c);
  return line;
}

}  // namespace

LeafletMeasures labrosse_measures(double base_radius, double commissure_radius, double height, const ValveOptions& options) {
  LeafletMeasures m;
  m.edge_center_height = height - commissure_radius * std::tan(options.free_edge_angle);
  m.coaptation_height = options.coaptation_ratio * commissure_radius;
  m.base_angle = std::atan((m.edge_center_height - m.coaptation_height) / base_radius);
  m.height = m.coaptation_height + base_radius / std::cos(m.base_angle);
  m.free_edge_length = 2 * std::hypot(commissure_radius, height - m.edge_center_height);
  return m;
}

TriangleMesh leaflet_mesh(const LeafletSurface& leaflet, const std::vector<Vector3d>& points) {
  TriangleMesh mesh;
  mesh.vertices = points;
  mesh.triangles = grid_triangles(leaflet.columns, leaflet.rows);
  return mesh;
}

ValveTemplate make_valve_template(const RootFrame& frame, const WallRadiusFunction& radius_at, const ValveOptions& options) {
  ValveTemplate valve;
  std::array<Sector, 3> sectors;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    sectors[i] = {frame.commissure_angles[i], frame.commissure_angles[next] + (next == 0 ? turn : 0), frame.commissure_heights[i],
                  frame.commissure_heights[next], frame.nadir_heights[i]};
    const double width = sectors[i].to - sectors[i].from;
    if (width < 1.0 || width > 0.95 * std::numbers::pi)
      throw std::runtime_error(
          text("no leaflet fits between commissures %.0f degrees apart; give the three commissures", width * 360 / turn));
    valve.commissure_radius += radius_at(frame.commissure_angles[i], frame.commissure_heights[i]) / 3;
    valve.commissure_height += frame.commissure_heights[i] / 3;
  }
  valve.annulus_radius = frame.annulus_radius;
  const LeafletMeasures measures = labrosse_measures(valve.annulus_radius, valve.commissure_radius, valve.commissure_height, options);
  if (measures.edge_center_height <= 0.2 * valve.commissure_height)
    throw std::runtime_error(
        text("the commissures lie only %.1f mm above the annulus of %.1f mm: too low for a valve; check the annulus and junction",
             1e3 * valve.commissure_height, 2e3 * valve.annulus_radius));
  if (measures.edge_center_height < 7e-3 || measures.edge_center_height > 12e-3)
    valve.warnings.push_back(
        text("the closed free edges meet %.1f mm above the annulus; 7 to 12 mm is usual", 1e3 * measures.edge_center_height));
  if (measures.height < 14e-3 || measures.height > 25e-3)
    valve.warnings.push_back(text("the leaflets are %.1f mm high; 14 to 25 mm is usual", 1e3 * measures.height));
  for (int i = 0; i < 3; ++i) {
    LeafletSurface& leaflet = valve.leaflets[i];
    leaflet.columns = options.columns;
    leaflet.rows = options.rows;
    leaflet.measures = measures;
    const double standoff = std::asin(std::min(0.5, options.sector_offset / valve.commissure_radius));
    const std::vector<Vector3d> attachment = attachment_line(sectors[i], standoff, radius_at, options);
    for (std::size_t c = 1; c < attachment.size(); ++c) {
      const Vector3d middle = 0.5 * (attachment[c] + attachment[c - 1]);
      const double gap = radius_at(std::atan2(middle.y(), middle.x()), middle.z()) + options.wall_inset - middle.head<2>().norm();
      leaflet.measures.attachment_gap_max = std::max(leaflet.measures.attachment_gap_max, std::abs(gap));
    }
    const std::vector<Vector3d> design = closed_design(sectors[i], attachment, measures, options);
    const double low = std::min(0.0, sectors[i].nadir_height) - 3e-3, high = std::max(sectors[i].from_height, sectors[i].to_height) + 1e-3;
    const WallTable wall(sectors[i], low, high, radius_at);
    const std::vector<Vector3d> reference = relaxed_reference(sectors[i], design, wall, options);
    leaflet.measures.free_edge_length = row_length(design, options.columns, options.rows - 1);
    leaflet.measures.height = column_length(design, options.columns, options.rows, options.columns / 2);
    for (int r = 0; r < options.rows; ++r) {
      const double strain = row_length(reference, options.columns, r) / row_length(design, options.columns, r) - 1;
      valve.largest_strain = std::max(valve.largest_strain, std::abs(strain));
    }
    const auto world = [&](const Vector3d& p) {
      return Vector3d(frame.origin + p.x() * frame.x_axis + p.y() * frame.y_axis + p.z() * frame.axis);
    };
    for (const Vector3d& p : reference) leaflet.reference.push_back(world(p));
    for (const Vector3d& p : design) leaflet.design.push_back(world(p));
    add_fibres(leaflet);
    const TriangleMesh mesh = leaflet_mesh(leaflet, leaflet.reference);
    for (const auto& t : mesh.triangles)
      leaflet.measures.area += 0.5 * (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]).norm();
  }
  if (valve.largest_strain > 0.02)
    valve.warnings.push_back(text("the leaflets' starting form is strained by %.1f %% against their design", 100 * valve.largest_strain));
  return valve;
}

}  // namespace geometry
