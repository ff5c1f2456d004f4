#include "sim/elastic_stress.h"

#include <Eigen/LU>

#include <algorithm>

#include "sim/paper_elasticity.h"
#include "sim/solid_stress.h"
#include "sim/stress.h"

namespace sim {
namespace {

template <int D>
std::span<const Vector<D>> rows_of(const State<D>& state, std::int64_t first, std::int64_t count) {
  return {state.position.data() + first, static_cast<std::size_t>(count)};
}

}  // namespace

template <int D>
ShellStress faces_stress(const Scene<D>& scene, const State<D>& state) {
  ShellStress stress;
  if (!scene.shells) return stress;
  const auto position = rows_of(state, scene.elastic_count, scene.shell_count);
  const std::size_t n = position.size();
  stress.minus.resize(n), stress.middle.resize(n), stress.plus.resize(n);
  shell_stress(*scene.shells, position, Face::minus, std::span(stress.minus));
  shell_stress(*scene.shells, position, Face::middle, std::span(stress.middle));
  shell_stress(*scene.shells, position, Face::plus, std::span(stress.plus));
  return stress;
}

template <int D>
std::vector<Eigen::Matrix3d> elastic_stress(const Scene<D>& scene, const State<D>& state) {
  std::vector<Eigen::Matrix3d> stress(static_cast<std::size_t>(scene.elastic_count + scene.shell_count), Eigen::Matrix3d::Zero());
  if (scene.solids && scene.description.scheme.name == Scheme::paper) {
    std::vector<Eigen::Matrix3d> solids;
    paper_stress<D>(build_paper_elasticity(scene.description), rows_of(state, 0, scene.elastic_count), solids);
    std::copy(solids.begin(), solids.end(), stress.begin());
  } else if (scene.solids) {
    SolidWork<D> work;
    std::vector<Eigen::Matrix3d> solids;
    solid_stress(*scene.solids, rows_of(state, 0, scene.elastic_count), work, solids);
    std::copy(solids.begin(), solids.end(), stress.begin());
  }
  const ShellStress faces = faces_stress(scene, state);
  for (std::size_t i = 0; i < faces.plus.size(); ++i)
    stress[static_cast<std::size_t>(scene.elastic_count) + i] =
        von_mises(faces.plus[i]) >= von_mises(faces.minus[i]) ? faces.plus[i] : faces.minus[i];
  return stress;
}

template <int D>
std::vector<double> volume_ratio(const Scene<D>& scene, const State<D>& state) {
  std::vector<double> ratio(static_cast<std::size_t>(scene.elastic_count), 1);
  if (!scene.solids) return ratio;
  SolidWork<D> work;
  solid_derivatives(*scene.solids, rows_of(state, 0, scene.elastic_count), work);
  for (std::size_t i = 0; i < ratio.size(); ++i)
    ratio[i] = (Tensor<D>::Identity() + work.derivatives[i].template leftCols<D>()).determinant();
  return ratio;
}

template std::vector<Eigen::Matrix3d> elastic_stress(const Scene<2>&, const State<2>&);
template std::vector<Eigen::Matrix3d> elastic_stress(const Scene<3>&, const State<3>&);
template ShellStress faces_stress(const Scene<2>&, const State<2>&);
template ShellStress faces_stress(const Scene<3>&, const State<3>&);
template std::vector<double> volume_ratio(const Scene<2>&, const State<2>&);
template std::vector<double> volume_ratio(const Scene<3>&, const State<3>&);

}  // namespace sim
