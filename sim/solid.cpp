#include "sim/solid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "sim/solid_cell.h"
#include "sim/solid_clamp.h"
#include "sim/solid_consistency.h"
#include "sim/solid_fit.h"
#include "sim/solid_neighbors.h"
#include "sim/solid_surface.h"

namespace sim {

namespace {

// Which rows have particles of their own body that are held along the axes of their clamp's face within 1.6 l0.
template <int D>
class HeldNeighbors {
 public:
  HeldNeighbors(const SceneDescription<D>& scene, std::size_t count) : particles_(scene.particles) {
    std::vector<Vector<D>> position;
    for (std::size_t i = 0; i < count; ++i)
      if (particles_.fixed.size() >= count && particles_.fixed[i]) row_.push_back(i), position.push_back(particles_.position[i]);
    if (!position.empty()) near_ = points_within<D>(std::span(particles_.position).first(count), position, 1.6 * scene.spacing);
  }
  bool beside(std::size_t i) const {
    if (row_.empty()) return false;
    for (const std::int32_t k : near_.of(i))
      if (particles_.body[row_[k]] == particles_.body[i] && (particles_.fixed[row_[k]] & particles_.clamp_axes[i])) return true;
    return false;
  }

 private:
  const InitialParticles<D>& particles_;
  std::vector<std::size_t> row_;
  NeighborTable near_;
};

template <int D>
void copy_rows(const SceneDescription<D>& scene, SolidElasticity<D>& solid) {
  const auto& particles = scene.particles;
  std::size_t n = 0;
  while (n < particles.size() && particles.kind[n] == Kind::elastic) ++n;
  const auto optional = [n](const auto& source, auto& target, auto fallback) {
    target.assign(n, fallback);
    if (source.size() >= n) std::copy_n(source.begin(), n, target.begin());
  };
  solid.spacing = scene.spacing;
  optional(particles.position, solid.rest, Vector<D>(Vector<D>::Zero()));
  optional(particles.volume, solid.volume, std::pow(scene.spacing, D));
  optional(particles.fixed, solid.fixed, std::uint8_t{0});
  optional(particles.body, solid.body, std::int32_t{0});
  optional(particles.surface_area, solid.surface_area, Vector<D>(Vector<D>::Zero()));
  optional(particles.depth, solid.depth, 0.0);
  if (particles.surface_begin.size() > n) {
    for (std::size_t i = 0; i < n; ++i)
      if (particles.surface_begin[i + 1] - particles.surface_begin[i] > SurfacePieces<D>::most)
        throw std::invalid_argument("solid: particle " + std::to_string(i) + " has more pieces of surface than a cell has faces");
    solid.surface_begin.assign(particles.surface_begin.begin(), particles.surface_begin.begin() + static_cast<std::ptrdiff_t>(n) + 1);
    solid.piece_area = particles.piece_area, solid.piece_offset = particles.piece_offset;
  }
  const HeldNeighbors<D> held(scene, n);
  for (std::size_t i = 0; i < n; ++i) {
    const Body& body = scene.bodies[solid.body[i]];
    const double scale = particles.stiffness_scale.size() >= n ? particles.stiffness_scale[i] : 1;
    const Vector<D> fibre = particles.fibre.size() >= n ? particles.fibre[i] : Vector<D>(Vector<D>::Zero());
    try {
      solid.law.push_back(law_point<D>(body.elastic, scale, fibre));
      if (!(body.elastic.density > 0)) throw std::invalid_argument("density must be positive (kg/m3)");
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("elastic body '" + body.name + "': " + error.what());
    }
    solid.mass.push_back(body.elastic.density * solid.volume[i]);
    // A clamp's face that does not run along cell faces leaves the particle next to it more or less than its cell to stand for. Where the
    // body ends at the face (a roller under it: nothing of the body is held inside) its cells fill it already.
    if (particles.clamp_axes.size() >= n && (particles.clamp_axes[i] & ~particles.fixed[i]) && held.beside(i) &&
        particles.clamp_offset[i].norm() < 1.001 * scene.spacing) {
      const double part = std::clamp(particles.clamp_offset[i].norm() / scene.spacing + 0.5, 0.5, 1.5);
      solid.volume[i] *= part;
      solid.surface_area[i] *= part;
      if (!solid.surface_begin.empty())
        for (std::int64_t p = solid.surface_begin[i]; p < solid.surface_begin[i + 1]; ++p) solid.piece_area[p] *= part;
    }
    solid.damping.push_back(body.elastic.damping);
    solid.wave_speed.push_back(wave_speed<D>(solid.law[i], body.elastic.density));
    solid.cell_moment.push_back(std::pow(solid.volume[i], 2.0 / D) / 12);
  }
}

// Highest angular frequency at rest by power iteration on M^-1 K, K applied as a difference of forces. Returns 2/omega, s.
template <int D>
double step_limit_at_rest(const SolidElasticity<D>& solid) {
  const std::size_t n = solid.size();
  SolidWork<D> work;
  std::vector<Vector<D>> mode(n), position(n), plus(n), minus(n);
  std::uint64_t noise = 88172645463325252ull;  // xorshift: a start that contains every mode
  for (std::size_t i = 0; i < n; ++i)
    for (int k = 0; k < D; ++k) {
      noise ^= noise << 13, noise ^= noise >> 7, noise ^= noise << 17;
      mode[i](k) = solid.fixed[i] >> k & 1 ? 0 : static_cast<double>(noise >> 11) / 9007199254740992.0 - 0.5;
    }
  const double amplitude = 1e-6 * solid.spacing;
  double eigenvalue = 0;
  for (int iteration = 0; iteration < 40; ++iteration) {
    double largest = 0;
    for (const auto& m : mode) largest = std::max(largest, m.template lpNorm<Eigen::Infinity>());
    if (!(largest > 0)) return 0;
    for (std::size_t i = 0; i < n; ++i) position[i] = solid.rest[i] + mode[i] * (amplitude / largest);
    solid_forces<D>(solid, position, work, plus);
    for (std::size_t i = 0; i < n; ++i) position[i] = solid.rest[i] - mode[i] * (amplitude / largest);
    solid_forces<D>(solid, position, work, minus);
    double product = 0, norm = 0;
    for (std::size_t i = 0; i < n; ++i) {
      Vector<D> response = (minus[i] - plus[i]) * (largest / (2 * amplitude * solid.mass[i]));
      for (int k = 0; k < D; ++k)
        if (solid.fixed[i] >> k & 1) response(k) = 0;
      product += solid.mass[i] * mode[i].dot(response);
      norm += solid.mass[i] * mode[i].squaredNorm();
      plus[i] = response;
    }
    eigenvalue = product / norm;
    const double scale = std::sqrt(norm) / std::max(product, 1e-300);  // keeps the numbers in range
    for (std::size_t i = 0; i < n; ++i) mode[i] = plus[i] * scale;
  }
  return eigenvalue > 0 ? 2 / std::sqrt(1.02 * eigenvalue) : 0;  // the Rayleigh quotient approaches from below
}

// Y of one row from its fits; components that are held keep 0.
template <int D>
Derivatives<D> row_derivatives(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, std::size_t i) {
  Derivatives<D> y = Derivatives<D>::Zero();
  const Vector<D> own = position[i] - solid.rest[i];
  for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
    const SolidFit& fit = solid.fits[f];
    Derivatives<D> part = Derivatives<D>::Zero();
    for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
      const std::int32_t j = solid.neighbor[l];
      const Vector<D> difference = j < 0 ? Vector<D>(-own) : Vector<D>(position[j] - solid.rest[j] - own);
      part += difference * solid.shape[l].transpose();
    }
    for (int k = 0; k < D; ++k)
      if (fit.components >> k & 1) y.row(k) = part.row(k);
  }
  return y;
}

// e_l = d_l - Y m(R_l): what the fit does not represent of the difference over a link.
template <int D>
Vector<D> residual(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, std::size_t i, std::int64_t l,
                   const Derivatives<D>& y) {
  const std::int32_t j = solid.neighbor[l];
  const Vector<D> own = position[i] - solid.rest[i];
  const Vector<D> difference = j < 0 ? Vector<D>(-own) : Vector<D>(position[j] - solid.rest[j] - own);
  return difference - y * monomials<D>(solid.offset[l]);
}

// (lambda - lambda_h) of rows that share their volumetric strain.
template <int D>
double shared_modulus(const SolidElasticity<D>& solid, std::size_t i) {
  const LameModuli& m = solid.law[i].moduli;
  return m.lame_lambda - plane_stress_lambda(m);
}

// V dW/dY of every row, with the column's mean volumetric strain where it is shared.
template <int D>
void row_stresses(const SolidElasticity<D>& solid, SolidWork<D>& work) {
  const auto n = static_cast<std::int64_t>(solid.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    const bool shared = shares_volume(solid, i);
    work.stress[i] = solid.volume[i] * cell_stress<D>(solid.law[i], solid.cell_moment[i], shared, work.derivatives[i]);
    work.volumetric[i] = shared ? volumetric_strain<D>(solid.law[i].law, deformation_gradient<D>(work.derivatives[i])) : 0;
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    if (!shares_volume(solid, i)) continue;
    const std::int32_t j = solid.partner[i];
    const double mean = (work.volumetric[i] + work.volumetric[j]) / 2;
    const double coefficient = mean * (solid.volume[i] * shared_modulus(solid, i) + solid.volume[j] * shared_modulus(solid, j)) / 2;
    work.stress[i].template leftCols<D>() +=
        coefficient * volumetric_strain_gradient<D>(solid.law[i].law, deformation_gradient<D>(work.derivatives[i]));
  }
}

}  // namespace

template <int D>
SolidElasticity<D> build_solids(const SceneDescription<D>& scene) {
  SolidElasticity<D> solid;
  copy_rows(scene, solid);
  if (solid.size() == 0) return solid;
  std::vector<std::string> names;
  for (const Body& body : scene.bodies) names.push_back(body.name);
  build_fits(solid, clamp_points(scene, solid.size()), scene.scheme.elastic_kernel_radius, names);
  make_consistent(solid);
  for (std::size_t i = 0; i < solid.size(); ++i)  // in plane stress nothing locks
    if (solid.law[i].plane_stress) solid.partner[i] = -1;
  solid.rest_step_limit = step_limit_at_rest(solid);
  return solid;
}

template <int D>
void solid_derivatives(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work) {
  work.derivatives.resize(solid.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(solid.size()); ++i) work.derivatives[i] = row_derivatives<D>(solid, position, i);
}

template <int D>
void solid_forces(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work, std::span<Vector<D>> force) {
  const auto n = static_cast<std::int64_t>(solid.size());
  work.stress.resize(n);
  work.volumetric.resize(n);
  work.link_force.resize(solid.neighbor.size());
  solid_derivatives<D>(solid, position, work);
  row_stresses(solid, work);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    Vector<D> own = Vector<D>::Zero();
    for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
      const SolidFit& fit = solid.fits[f];
      // dE/du_l = (T - sum c w e m^T) s_l + c w e_l, for the components of the fit
      Derivatives<D> through = work.stress[i];
      for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
        const Vector<D> pull = fit.residual_stiffness * solid.weight[l] * residual<D>(solid, position, i, l, work.derivatives[i]);
        through -= pull * monomials<D>(solid.offset[l]).transpose();
        work.link_force[l] = -pull;
      }
      for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
        Vector<D>& f_l = work.link_force[l];
        f_l -= through * solid.shape[l];
        for (int k = 0; k < D; ++k)
          if (!(fit.components >> k & 1)) f_l(k) = 0;
        own -= f_l;
      }
    }
    force[i] = own;
  }
#pragma omp parallel for schedule(static)
  for (std::int64_t j = 0; j < n; ++j)
    for (std::int64_t in = solid.incoming_begin[j]; in < solid.incoming_begin[j + 1]; ++in) force[j] += work.link_force[solid.incoming[in]];
}

template <int D>
void solid_damping(const SolidElasticity<D>& solid, std::span<const Vector<D>> velocity, std::span<Vector<D>> force) {
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(solid.size()); ++i) force[i] -= solid.damping[i] * solid.mass[i] * velocity[i];
}

template <int D>
double solid_energy(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, SolidWork<D>& work) {
  const std::size_t n = solid.size();
  solid_derivatives<D>(solid, position, work);
  std::vector<double> volumetric(n, 0), energy(n, 0);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(n); ++i) {
    const bool shared = shares_volume(solid, i);
    energy[i] = solid.volume[i] * cell_energy<D>(solid.law[i], solid.cell_moment[i], shared, work.derivatives[i]);
    if (shared) volumetric[i] = volumetric_strain<D>(solid.law[i].law, deformation_gradient<D>(work.derivatives[i]));
    for (std::int64_t f = solid.fit_begin[i]; f < solid.fit_begin[i + 1]; ++f) {
      const SolidFit& fit = solid.fits[f];
      for (std::int64_t l = fit.first; l < fit.first + fit.count; ++l) {
        const Vector<D> e = residual<D>(solid, position, i, l, work.derivatives[i]);
        for (int k = 0; k < D; ++k)
          if (fit.components >> k & 1) energy[i] += fit.residual_stiffness / 2 * solid.weight[l] * e(k) * e(k);
      }
    }
  }
  double total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    total += energy[i];
    if (!shares_volume(solid, i)) continue;
    const double mean = (volumetric[i] + volumetric[solid.partner[i]]) / 2;
    total += solid.volume[i] * shared_modulus(solid, i) / 2 * mean * mean;
  }
  return total;
}

template <int D>
double solid_time_step_limit(const SolidElasticity<D>& solid, std::span<const Vector<D>> position, double factor) {
  if (!(factor > 0 && factor <= 0.5))
    throw std::invalid_argument("scheme.elastic_substep must lie in (0, 0.5] (of l0/c), got " + std::to_string(factor));
  if (solid.size() == 0) return 1e300;
  double fastest = 0;  // 1/s
#pragma omp parallel for schedule(static) reduction(max : fastest)
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(solid.size()); ++i) {
    const Tensor<D> f = deformation_gradient<D>(row_derivatives<D>(solid, position, i));
    const double stretch = std::sqrt((f.transpose() * f).trace() / D);
    const double compression = std::max(std::abs(f.determinant()) / std::pow(stretch, D - 1), 0.2);
    double stiffening = std::max(stretch, 1 / compression);
    const double fibre = (f * solid.law[i].fibre).squaredNorm() - 1;
    if (fibre > 0) {
      const double e = std::min(fibre, solid.law[i].fibre_limit), k2 = solid.law[i].fibre_stiffening;
      const double modulus = solid.law[i].moduli.lame_lambda + 2 * solid.law[i].moduli.shear_modulus;
      const double grown = 4 * solid.law[i].fibre_modulus * std::exp(k2 * e * e) * (1 + 2 * k2 * e * e) * (1 + fibre);
      stiffening *= std::sqrt((modulus + grown) / (modulus + 4 * solid.law[i].fibre_modulus));
    }
    fastest = std::max(fastest, stiffening * std::max(solid.wave_speed[i] / (factor * solid.spacing),
                                                      solid.rest_step_limit > 0 ? 1 / (0.9 * solid.rest_step_limit) : 0));
  }
  return 1 / fastest;
}

#define SIM_INSTANTIATE(D)                                                                                                   \
  template SolidElasticity<D> build_solids<D>(const SceneDescription<D>&);                                                   \
  template void solid_derivatives<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, SolidWork<D>&);                  \
  template void solid_forces<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, SolidWork<D>&, std::span<Vector<D>>); \
  template void solid_damping<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, std::span<Vector<D>>);               \
  template double solid_energy<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, SolidWork<D>&);                     \
  template double solid_time_step_limit<D>(const SolidElasticity<D>&, std::span<const Vector<D>>, double);
SIM_INSTANTIATE(2)
SIM_INSTANTIATE(3)
#undef SIM_INSTANTIATE

}  // namespace sim
