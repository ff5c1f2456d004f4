#include "sim/paper_step.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "sim/paper_elasticity.h"
#include "sim/solid_loads.h"

namespace sim {

template <int D>
void check_paper_scheme(const SceneDescription<D>& scene) {
  const char* lacking = nullptr;
  for (const Body& body : scene.bodies) {
    if (body.kind == Kind::fluid) lacking = "a fluid body";
    if (body.kind == Kind::shell) lacking = "a body of one particle layer";
  }
  if (scene.time.mode == TimeMode::static_equilibrium) lacking = "time.mode = \"static\"";
  if (lacking)
    throw std::invalid_argument(
        std::string("scheme.name = \"paper\" moves elastic bodies of two or more layers in time, and the scene has ") + lacking +
        "; use scheme.name = \"accurate\"");
}

template <int D>
void step_paper_solids(const Scene<D>& scene, State<D>& state, Workspace<D>& work, double dt, StepReport& report) {
  // Built anew each step: an exhibit need not be fast, and no other scheme pays for it.
  const PaperElasticity<D> elasticity = build_paper_elasticity(scene.description);
  const SolidElasticity<D>& solids = *scene.solids;
  const std::size_t n = elasticity.size();
  std::vector<Vector<D>> position(state.position.begin(), state.position.begin() + static_cast<std::ptrdiff_t>(n));
  std::vector<Vector<D>> velocity(state.velocity.begin(), state.velocity.begin() + static_cast<std::ptrdiff_t>(n)), external(n);
  const int pieces = std::max(1, static_cast<int>(std::ceil(dt / 1e-4 - 1e-9)));
  std::optional<Vector<D>> gravity;
  if (scene.gravity) gravity = scene.gravity->acceleration;
  for (int k = 0; k < pieces; ++k) {
    const double piece = dt / pieces, time = state.time + (k + 1) * piece;  // Eq (20): forces at the end
    std::fill(external.begin(), external.end(), Vector<D>::Zero());
    solid_derivatives<D>(solids, position, work.solid_motion.work);
    external_loads<D>(solids, scene.description.loads, gravity, time, position, work.solid_motion.work, external);
    for (std::size_t i = 0; i < n; ++i) external[i] = (external[i] - solids.damping[i] * solids.mass[i] * velocity[i]) / solids.volume[i];
    const PaperStepReport step =
        paper_elastic_step<D>(elasticity, external, piece, scene.description.scheme.outer_iterations, position, velocity);
    report.elastic_substeps += step.outer_iterations;
    if (step.converged) continue;
    char text[160];
    std::snprintf(text, sizeof text, "the published elastic step did not settle in %d outer iterations (last change %.3g m)",
                  step.outer_iterations, step.change);
    throw NumericalFailure(text);
  }
  std::copy(position.begin(), position.end(), state.position.begin());
  std::copy(velocity.begin(), velocity.end(), state.velocity.begin());
  state.ledger.elastic_substeps += report.elastic_substeps;
}

template void check_paper_scheme(const SceneDescription<2>&);
template void check_paper_scheme(const SceneDescription<3>&);
template void step_paper_solids(const Scene<2>&, State<2>&, Workspace<2>&, double, StepReport&);
template void step_paper_solids(const Scene<3>&, State<3>&, Workspace<3>&, double, StepReport&);

}  // namespace sim
