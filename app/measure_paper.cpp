#include "app/measure_paper.h"

#include <cmath>

#include "sim/paper_elasticity.h"
#include "sim/stress.h"

namespace app {
namespace {

using Vector3 = sim::Vector<3>;

constexpr double youngs_modulus = 1e6;  // Pa

// A block of nx x ny x nz particles at unit spacing, the first `held` layers along x held.
sim::SceneDescription<3> block(int nx, int ny, int nz, int held, double poisson_ratio, double radius) {
  sim::SceneDescription<3> scene;
  scene.spacing = 1;
  scene.scheme.elastic_kernel_radius = radius;
  sim::Body body;
  body.kind = sim::Kind::elastic;
  body.elastic.youngs_modulus = youngs_modulus, body.elastic.poisson_ratio = poisson_ratio;
  scene.bodies.push_back(body);
  auto& particles = scene.particles;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        particles.position.emplace_back(i, j, k);
        particles.kind.push_back(sim::Kind::elastic);
        particles.body.push_back(0);
        particles.stiffness_scale.push_back(1);
        particles.fixed.push_back(i < held ? 7 : 0);
      }
  return scene;
}

// Force per volume at the middle of a cube under the displacement u_x = a s^2, s = y (shear) or x, over 2a: G, or lambda + 2 G.
double operator_modulus(double poisson_ratio, double radius, int axis) {
  constexpr int side = 17;  // the rotations of the middle's neighbours need full support, too
  const sim::PaperElasticity<3> body = sim::build_paper_elasticity(block(side, side, side, 0, poisson_ratio, radius));
  const std::size_t middle = body.size() / 2;
  const double a = 1e-6;
  std::vector<Vector3> position = body.rest, force(body.size());
  std::vector<sim::Tensor<3>> rotation(body.size());
  for (Vector3& x : position) {
    const double s = x[axis] - body.rest[middle][axis];
    x[0] += a * s * s;
  }
  sim::paper_rotations<3>(body, position, rotation);
  sim::paper_elastic_force<3>(body, position, rotation, force);
  return force[middle][0] / (2 * a);
}

struct Bar {
  double stiffness = 0, von_mises = 0;  // over the true ones
};

// A bar pulled at its end until it rests: implicit steps so long that inertia has no say.
Bar stretched_bar(double poisson_ratio) {
  constexpr int length = 16, across = 4;
  const sim::PaperElasticity<3> body = sim::build_paper_elasticity(block(length, across, across, 1, poisson_ratio, 2.1));
  const double traction = 1e-4 * youngs_modulus;
  std::vector<Vector3> position = body.rest, velocity(body.size(), Vector3::Zero()), external(body.size(), Vector3::Zero());
  for (std::size_t i = 0; i < body.size(); ++i)
    if (body.rest[i][0] > length - 1.5) external[i][0] = traction;  // per unit cell: force over area
  for (int k = 0; k < 3; ++k) {
    sim::paper_elastic_step<3>(body, external, 1e3, 60, position, velocity);
    std::fill(velocity.begin(), velocity.end(), Vector3::Zero());
  }
  std::vector<Eigen::Matrix3d> stress;
  sim::paper_stress<3>(body, position, stress);
  double near = 0, far = 0, mises = 0;
  int count = 0, inside = 0;
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vector3& x = body.rest[i];
    if (x[0] == 5) near += position[i][0] - x[0], ++count;
    if (x[0] == 11) far += position[i][0] - x[0];
    const auto inner = [&](int k) { return x[k] > 0.5 && x[k] < across - 1.5; };
    if (x[0] > 5.5 && x[0] < 10.5 && inner(1) && inner(2)) mises += sim::von_mises(stress[i]), ++inside;
  }
  const double strain = (far - near) / count / 6;
  return {traction / strain / youngs_modulus, mises / inside / traction};
}

}  // namespace

nlohmann::json measure_paper() {
  nlohmann::json rows = nlohmann::json::array();
  for (double nu : {0.3, 0.45, 0.49}) {
    const sim::LameModuli own = sim::lame_moduli(youngs_modulus, nu), simulated = sim::paper_effective_moduli(own, 3);
    const double g = simulated.shear_modulus, lambda = simulated.lame_lambda;
    const double young = g * (3 * lambda + 2 * g) / (lambda + g), poisson = lambda / (2 * (lambda + g));
    const double shear = operator_modulus(nu, 4.2, 1), both = operator_modulus(nu, 4.2, 0);
    const Bar bar = stretched_bar(nu);
    rows.push_back({{"poisson_ratio", nu},
                    {"shear_modulus", own.shear_modulus},
                    {"lame_lambda", own.lame_lambda},
                    {"shear_modulus_derived", g},
                    {"shear_modulus_measured", shear},
                    {"lame_lambda_derived", lambda},
                    {"lame_lambda_measured", both - 2 * shear},
                    {"youngs_modulus_ratio_derived", young / youngs_modulus},
                    {"poisson_ratio_derived", poisson},
                    {"bar_stiffness_ratio_measured", bar.stiffness},
                    {"von_mises_ratio_derived", 2 * own.shear_modulus * (1 + poisson) / young},
                    {"von_mises_ratio_measured", bar.von_mises}});
  }
  return {{"youngs_modulus", youngs_modulus}, {"rows", rows}};
}

}  // namespace app
