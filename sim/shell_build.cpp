// Rest data of shells: neighbours, tangents, quadratic fits, clamps.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/kernel.h"
#include "sim/point_grid.h"
#include "sim/shell.h"
#include "sim/shell_frequency.h"

namespace sim {
namespace {

constexpr double kernel_radius = 2.1;   // of the body's spacing
constexpr double near_distance = 1.35;  // of the spacing: bonds, and which rows lie at a clamp's face
constexpr double ridge = 1e-4;          // on second derivatives (numerics-elastic.md 3(ii))
constexpr double well_posed = 5e-3;     // least eigenvalue of the fit's moments over the sum of weights
constexpr double same_sheet = 0.3;      // smallest cosine between normals of neighbours: folds are not bridged

template <int D>
using Terms = Eigen::Matrix<double, ShellElasticity<D>::terms, 1>;
template <int D>
using TermMatrix = Eigen::Matrix<double, ShellElasticity<D>::terms, ShellElasticity<D>::terms>;

// m(xi) = [xi; xi_a^2/2; xi_1 xi_2], xi in units of the spacing.
template <int D>
Terms<D> monomials(const Vector<D>& offset, const std::array<Vector<D>, D - 1>& tangent, double spacing) {
  const double x = offset.dot(tangent[0]) / spacing;
  Terms<D> m;
  if constexpr (D == 2) {
    m << x, 0.5 * x * x;
  } else {
    const double y = offset.dot(tangent[1]) / spacing;
    m << x, y, 0.5 * x * x, 0.5 * y * y, x * y;
  }
  return m;
}

template <int D>
Padded<D> pad(const Vector<D>& v) {
  Padded<D> p = Padded<D>::Zero();
  p.template head<D>() = v;
  return p;
}

// Right-handed tangents of a normal; the first along the fibre where there is one.
std::array<Vector<2>, 1> tangents_of(const Vector<2>& normal, const Vector<2>&) { return {Vector<2>(normal.y(), -normal.x())}; }
std::array<Vector<3>, 2> tangents_of(const Vector<3>& normal, const Vector<3>& along) {
  Vector<3> first = along - normal * normal.dot(along);
  if (first.norm() < 1e-3) {
    int axis = 0;
    normal.cwiseAbs().minCoeff(&axis);
    first = Vector<3>::Unit(axis) - normal * normal[axis];
  }
  first.normalize();
  return {first, normal.cross(first)};
}

template <int D>
bool clamped(const ShellElasticity<D>& shells, std::int32_t i) {
  return (shells.fixed[i] & ((1 << D) - 1)) == (1 << D) - 1;
}

// A clamp acts at the fixed region's face, half way between the last held and the first free row. The held row there stands for the stretch
// between face and first free row (weight 4/3 makes its half bond twice as stiff); the bending of the first free cell is shared by the
// hinges at the held row (4: the parabola of a rigid tangent) and at the free row (4/3): 1/4 + 3/4 = 1. Held rows behind take no part.
template <int D>
void weigh_clamps(ShellElasticity<D>& shells, const ShellBody& body, const PointGrid<D>& grid) {
  for (std::int32_t i = body.first; i < body.first + body.count; ++i) {
    const bool held = clamped(shells, i);
    bool at_face = false;
    grid.for_each_near(shells.rest_position[i], near_distance * body.spacing,
                       [&](std::int32_t local, double) { at_face = at_face || clamped(shells, body.first + local) != held; });
    if (held) {
      shells.membrane_weight[i] = at_face ? 4.0 / 3 : 0.0;
      shells.bending_weight[i] = at_face ? 1.0 : 0.0;
    } else if (at_face) {
      shells.bending_weight[i] = 4.0 / 3;
    }
  }
}

template <int D>
struct Neighborhood {
  std::vector<std::int32_t> rows;
  std::vector<double> weight;
  TermMatrix<D> inverse;  // M^-1
};

template <int D>
void gather(const ShellElasticity<D>& shells, const ShellBody& body, const PointGrid<D>& grid, std::int32_t i, double radius,
            Neighborhood<D>& near) {
  std::vector<std::pair<std::int32_t, double>> found;
  grid.for_each_near(shells.rest_position[i], radius, [&](std::int32_t local, double squared) {
    const std::int32_t j = body.first + local;
    const bool deep = shells.membrane_weight[j] == 0 && shells.membrane_weight[i] != 0;
    if (j != i && !deep && shells.normal[j].dot(shells.normal[i]) > same_sheet) found.emplace_back(j, std::sqrt(squared));
  });
  std::sort(found.begin(), found.end());
  near.rows.clear();
  near.weight.clear();
  for (const auto& [j, distance] : found) {
    const double w = weight(distance, radius, 0.5 * body.spacing);
    if (w > 1e-6) near.rows.push_back(j), near.weight.push_back(w);
  }
}

// M = sum w m m^T + ridge; false where the neighbours do not determine the fit.
template <int D>
bool invert_moments(const ShellElasticity<D>& shells, const ShellBody& body, std::int32_t i, Neighborhood<D>& near, double stiffening) {
  constexpr int terms = ShellElasticity<D>::terms, linear = D - 1;
  if (static_cast<int>(near.rows.size()) < terms) return false;
  TermMatrix<D> moments = TermMatrix<D>::Zero();
  double sum = 0;
  for (std::size_t k = 0; k < near.rows.size(); ++k) {
    const Terms<D> m = monomials<D>(shells.rest_position[near.rows[k]] - shells.rest_position[i], shells.tangent[i], body.spacing);
    moments += near.weight[k] * m * m.transpose();
    sum += near.weight[k];
  }
  const Eigen::SelfAdjointEigenSolver<TermMatrix<D>> eigen(moments);
  if (stiffening == ridge && eigen.eigenvalues()[0] < well_posed * sum) return false;
  for (int t = linear; t < terms; ++t) moments(t, t) += stiffening * sum;
  near.inverse = moments.inverse();
  return true;
}

// Turns the normal until the fitted surface has no slope against it. False where that does not settle.
template <int D>
bool align_with_surface(ShellElasticity<D>& shells, const ShellBody& body, const Vector<D>& fibre, std::int32_t i, Neighborhood<D>& near,
                        double stiffening) {
  const Vector<D> start = shells.normal[i];
  for (int iteration = 0; iteration < 60 && invert_moments(shells, body, i, near, stiffening); ++iteration) {
    Vector<D - 1> slope = Vector<D - 1>::Zero();
    for (std::size_t k = 0; k < near.rows.size(); ++k) {
      const Vector<D> offset = shells.rest_position[near.rows[k]] - shells.rest_position[i];
      const Terms<D> fit = near.inverse * (near.weight[k] * monomials<D>(offset, shells.tangent[i], body.spacing));
      slope += fit.template head<D - 1>() * (offset.dot(shells.normal[i]) / body.spacing);
    }
    if (slope.norm() < 1e-12) return shells.normal[i].dot(start) > 0.5;
    Vector<D> normal = shells.normal[i];
    for (int a = 0; a < D - 1; ++a) normal -= slope[a] * shells.tangent[i][a];
    shells.normal[i] = normal.normalized();
    shells.tangent[i] = tangents_of(shells.normal[i], fibre);
  }
  shells.normal[i] = start;
  shells.tangent[i] = tangents_of(start, fibre);
  return false;
}

// The neighbours that determine the fit: the smallest radius of 2.1, 2.3, ... spacings that does; in a narrow corner, where none does, a
// fit that is linear in effect (second derivatives held down by a large ridge).
template <int D>
void find_neighborhood(ShellElasticity<D>& shells, const ShellBody& body, const std::string& name, const Vector<D>& fibre,
                       const PointGrid<D>& grid, std::int32_t i, Neighborhood<D>& near) {
  for (double stiffening : {ridge, 1.0, 100.0})
    for (double factor = kernel_radius; factor < 3.4; factor += 0.2) {
      gather(shells, body, grid, i, factor * body.spacing, near);
      if (align_with_surface(shells, body, fibre, i, near, stiffening)) return;
    }
  throw std::invalid_argument("shell body '" + name + "': the particle at (" + std::to_string(shells.rest_position[i].x()) + ", " +
                              std::to_string(shells.rest_position[i].y()) +
                              ", ...) m has too few neighbours to define a surface; use a smaller spacing or a larger sheet");
}

// Pairs of one particle: g and q of the fit. A held particle looks only towards the free side (direction nu): its stretch along nu is that
// of the bond to the first free row (the other tangent stays), its curvature that of a parabola on the rest tangents, H = 2 (d . N) /
// distance^2.
template <int D>
void append_pairs(ShellElasticity<D>& shells, const ShellBody& body, std::int32_t i, const Neighborhood<D>& near) {
  constexpr int terms = ShellElasticity<D>::terms, linear = D - 1;
  const double s = body.spacing;
  Vector<D> towards_free = Vector<D>::Zero();
  double length = 0, moment = 0;
  const bool held = clamped(shells, i);
  shells.held_tangent.emplace_back();
  for (int a = 0; a < linear; ++a) shells.held_tangent.back()[a] = pad(shells.tangent[i][a]);
  auto offset_of = [&](std::size_t k) -> Vector<D> { return shells.rest_position[near.rows[k]] - shells.rest_position[i]; };
  if (held) {
    for (std::size_t k = 0; k < near.rows.size(); ++k)
      if (!clamped(shells, near.rows[k])) towards_free += near.weight[k] * offset_of(k).normalized();
    towards_free.normalize();
    for (std::size_t k = 0; k < near.rows.size(); ++k)
      if (!clamped(shells, near.rows[k])) {
        const double along = std::max(0.0, offset_of(k).dot(towards_free));
        length += near.weight[k] * along * along;
        moment += 0.25 * near.weight[k] * along * along * along * along;
      }
  }
  for (std::size_t k = 0; k < near.rows.size(); ++k) {
    const Terms<D> m = monomials<D>(offset_of(k), shells.tangent[i], s);
    Terms<D> fit = near.inverse * (near.weight[k] * m);
    fit.template head<linear>() /= s;
    fit.template tail<terms - linear>() /= s * s;
    if (held) {
      fit.setZero();
      const double along = offset_of(k).dot(towards_free);
      if (!clamped(shells, near.rows[k]) && along > 0 && moment > 0) {
        const double g = near.weight[k] * along / length, q = near.weight[k] * 0.5 * along * along / moment;
        Vector<D - 1> nu;
        for (int a = 0; a < linear; ++a) nu[a] = towards_free.dot(shells.tangent[i][a]);
        nu.normalize();
        for (int a = 0; a < linear; ++a) {
          fit[a] = g * nu[a];
          fit[linear + a] = q * nu[a] * nu[a];
          shells.held_tangent.back()[a] -= pad(Vector<D>(fit[a] * offset_of(k)));
        }
        if constexpr (D == 3) fit[4] = q * nu[0] * nu[1];
      }
    }
    shells.neighbor.push_back(near.rows[k]);
    for (int t = 0; t < terms; ++t) shells.fit.push_back(fit[t]);
  }
  for (int t = 0; t < terms; ++t) {
    double sum = 0;
    for (std::size_t p = shells.start[i]; p < shells.neighbor.size(); ++p) sum += shells.fit[p * terms + t];
    shells.fit_sum.push_back(sum);
  }
  shells.start.push_back(static_cast<std::int32_t>(shells.neighbor.size()));
}

// kappa0 = N . H at rest.
template <int D>
void measure_rest_curvature(ShellElasticity<D>& shells, std::int32_t i) {
  constexpr int terms = ShellElasticity<D>::terms, linear = D - 1;
  double h[3] = {0, 0, 0};
  for (std::int32_t p = shells.start[i]; p < shells.start[i + 1]; ++p) {
    const double height = (shells.rest_position[shells.neighbor[p]] - shells.rest_position[i]).dot(shells.normal[i]);
    for (int t = linear; t < terms; ++t) h[t - linear] += shells.fit[p * terms + t] * height;
  }
  shells.rest_curvature[i] = {h[0], h[1], h[2]};
}

template <int D>
void append_bonds(ShellElasticity<D>& shells, const ShellBody& body) {
  for (std::int32_t i = body.first; i < body.first + body.count; ++i) {
    for (std::int32_t p = shells.start[i]; p < shells.start[i + 1]; ++p) {
      const std::int32_t j = shells.neighbor[p];
      const double distance = (shells.rest_position[j] - shells.rest_position[i]).norm();
      if (distance > near_distance * body.spacing) continue;
      shells.bond.push_back(j);
      shells.bond_length.push_back(distance);
      shells.bond_mass.push_back(2 * shells.mass[i] * shells.mass[j] / (shells.mass[i] + shells.mass[j]));
    }
    shells.bond_start.push_back(static_cast<std::int32_t>(shells.bond.size()));
  }
}

template <int D>
void append_body(ShellElasticity<D>& shells, const SceneDescription<D>& description, std::int32_t index) {
  const Body& source = description.bodies[index];
  const InitialParticles<D>& particles = description.particles;
  ShellBody body;
  body.body = index;
  body.first = static_cast<std::int32_t>(shells.size());
  body.count = static_cast<std::int32_t>(source.count);
  body.thickness = source.elastic.thickness;
  body.bending_thickness = source.elastic.bending_thickness_ratio * body.thickness;
  body.density = source.elastic.density;
  body.damping = source.elastic.damping;
  if (!(body.thickness > 0)) throw std::invalid_argument("shell body '" + source.name + "': thickness must be > 0 m");
  if (!(body.bending_thickness > 0 && body.bending_thickness <= body.thickness))
    throw std::invalid_argument("shell body '" + source.name + "': bending_thickness_ratio must lie in (0, 1]");
  if (!(body.density > 0)) throw std::invalid_argument("shell body '" + source.name + "': density must be > 0 kg/m3");
  try {
    body.material = sheet_material(source.elastic);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("shell body '" + source.name + "': " + error.what());
  }
  body.material.narrow = D == 2 && source.elastic.plane_stress;
  double area = 0;
  std::vector<Vector<D>> fibres(static_cast<std::size_t>(body.count), Vector<D>::Zero());
  for (std::int32_t k = 0; k < body.count; ++k) {
    const std::size_t row = static_cast<std::size_t>(source.first + k);
    if (row < particles.fibre.size()) fibres[k] = particles.fibre[row];
    shells.body.push_back(static_cast<std::int32_t>(shells.bodies.size()));
    shells.rest_position.push_back(particles.position[row]);
    shells.normal.push_back(particles.normal[row].normalized());
    shells.tangent.push_back(tangents_of(shells.normal.back(), fibres[k]));
    shells.area.push_back(particles.volume[row]);
    shells.mass.push_back(body.density * body.thickness * particles.volume[row]);
    shells.stiffness_scale.push_back(row < particles.stiffness_scale.size() ? particles.stiffness_scale[row] : 1.0);
    shells.fixed.push_back(row < particles.fixed.size() ? particles.fixed[row] : 0);
    area += particles.volume[row];
  }
  const std::size_t total = shells.size();
  shells.fibre.resize(total, Eigen::Vector2d::Zero());
  shells.rest_curvature.resize(total);
  shells.membrane_weight.resize(total, 1);
  shells.bending_weight.resize(total, 1);
  body.spacing = D == 3 ? std::sqrt(area / body.count) : area / body.count;

  const PointGrid<D> grid(std::span<const Vector<D>>(shells.rest_position).subspan(body.first), kernel_radius * body.spacing);
  weigh_clamps(shells, body, grid);
  Neighborhood<D> near;
  for (std::int32_t i = body.first; i < body.first + body.count; ++i) {
    const Vector<D>& fibre = fibres[i - body.first];
    find_neighborhood(shells, body, source.name, fibre, grid, i, near);
    for (int a = 0; a < D - 1; ++a) shells.fibre[i][a] = fibre.dot(shells.tangent[i][a]);
    if (shells.fibre[i].norm() > 1e-6) shells.fibre[i].normalize();
    append_pairs(shells, body, i, near);
    measure_rest_curvature(shells, i);
  }
  append_bonds(shells, body);
  shells.bodies.push_back(body);
}

template <int D>
void reverse_pairs(ShellElasticity<D>& shells) {
  constexpr int count = ShellElasticity<D>::terms;
  const std::size_t rows = shells.size();
  shells.reverse_start.assign(rows + 1, 0);
  for (std::int32_t j : shells.neighbor) ++shells.reverse_start[j + 1];
  for (std::size_t j = 0; j < rows; ++j) shells.reverse_start[j + 1] += shells.reverse_start[j];
  shells.reverse_fit.resize(shells.fit.size());
  shells.reverse_owner.resize(shells.neighbor.size());
  auto next = shells.reverse_start;
  for (std::size_t i = 0; i < rows; ++i)
    for (std::int32_t p = shells.start[i]; p < shells.start[i + 1]; ++p) {
      const std::int32_t slot = next[shells.neighbor[p]]++;
      std::copy_n(&shells.fit[p * count], count, &shells.reverse_fit[slot * count]);
      shells.reverse_owner[slot] = static_cast<std::int32_t>(i);
    }
}

}  // namespace

template <int D>
ShellElasticity<D> build_shells(const SceneDescription<D>& description) {
  ShellElasticity<D> shells;
  shells.start.push_back(0);
  shells.bond_start.push_back(0);
  shells.substep_factor = description.scheme.elastic_substep;
  bool blood = false;
  std::int64_t first_row = -1;
  for (std::size_t b = 0; b < description.bodies.size(); ++b) {
    const Body& body = description.bodies[b];
    blood = blood || body.kind == Kind::fluid;
    if (body.kind != Kind::shell || body.count == 0) continue;
    if (first_row < 0) first_row = body.first;
    append_body(shells, description, static_cast<std::int32_t>(b));
    for (const ShellMesh<D>& mesh : description.shell_meshes) {
      if (mesh.body != static_cast<std::int32_t>(b)) continue;
      for (auto element : mesh.elements) {
        for (auto& row : element) row += shells.bodies.back().first;
        shells.elements.push_back(element);
      }
    }
  }
  if (shells.empty()) return shells;
  shells.first_row = first_row;
  shells.axial_dashpot = blood || description.valve ? 5000 : 0;
  reverse_pairs(shells);
  // Measured limit of the linear shell 0.73 l0/c = 2/omega (numerics-elastic.md 3): substep_factor of l0/c in terms of omega.
  const double frequency = highest_frequency(shells);
  shells.rest_step = frequency > 0 ? shells.substep_factor / 0.73 * 2 / frequency : 1;
  return shells;
}

template ShellElasticity<2> build_shells(const SceneDescription<2>&);
template ShellElasticity<3> build_shells(const SceneDescription<3>&);

}  // namespace sim
