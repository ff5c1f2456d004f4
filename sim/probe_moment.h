// What all probes of one moment share, computed when the first of them asks. Internal to sim/probe*.cpp.
#pragma once

#include <optional>

#include "sim/elastic_stress.h"
#include "sim/point_grid.h"
#include "sim/probes.h"

namespace sim {

template <int D>
class ProbeMoment {
 public:
  ProbeMoment(const Scene<D>& scene, const State<D>& state, Workspace<D>& work) : scene_(scene), state_(state), work_(work) {}

  const std::vector<Eigen::Matrix3d>& stress();  // rows of solids (and shells, unused)
  const ShellStress& faces();
  const std::vector<double>& volume();  // det F of solids
  const SolidWork<D>& solid_work();     // displacement derivatives of solids
  // In space:
  Vector<D> velocity_at(const Vector<D>& x, std::int32_t body);
  double pressure_at(const Vector<D>& x, std::int32_t body);
  double density_at(const Vector<D>& x, std::int32_t body);
  double flow_through(const Probe<D>& probe);

 private:
  struct Near {
    std::vector<std::int32_t> fluid, boundary;            // rows
    std::vector<Vector<D>> fluid_offset, surface_offset;  // to the particle; to the boundary's true surface, m
    std::int32_t wall = -1;                               // nearest boundary row
    double wall_distance = 0, fluid_distance = 0;         // m: signed height over that surface; to the nearest fluid particle
    Vector<D> wall_normal = Vector<D>::Zero();
  };
  Near near(const Vector<D>& x, std::int32_t body, double radius);
  bool behind_shell(const Vector<D>& x, const Vector<D>& sample, const std::vector<std::int32_t>& shells) const;
  bool in_wall(const Near& around) const;
  void prepare_space();
  double cell_mean_excess(std::int32_t row, const Vector<D>& normal) const;

  const Scene<D>& scene_;
  const State<D>& state_;
  Workspace<D>& work_;
  std::optional<std::vector<Eigen::Matrix3d>> stress_;
  std::optional<ShellStress> faces_;
  std::optional<std::vector<double>> volume_;
  std::optional<SolidWork<D>> solid_work_;
  std::optional<PointGrid<D>> grid_;
};

}  // namespace sim
