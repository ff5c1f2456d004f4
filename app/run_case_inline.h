#pragma once

#include <memory>
#include <utility>

#include "app/build_case.h"
#include "app/run_case.h"

namespace app {

template <class Use>
void with_scene(const SceneFile& file, const RunCaseOptions& options, Use&& use) {
  const std::shared_ptr<const CaseParticles> placed = options.placed ? options.placed : place_case(file);
  if (file.dimension == 2) {
    if (options.dry) refuse_dry(file);
    BuiltCase<2> built = build_case<2>(file, *placed);
    const sim::Scene<2> scene = sim::make_scene(std::move(built.description));
    use(built, scene);
  } else {
    BuiltCase<3> built = build_case<3>(file, *placed);
    if (options.dry) built = dry_case(file, std::move(built), *options.dry);
    const sim::Scene<3> scene = sim::make_scene(std::move(built.description));
    use(built, scene);
  }
}

template <class Use>
void with_scene(const SceneFile& file, Use&& use) {
  with_scene(file, RunCaseOptions{}, std::forward<Use>(use));
}

}  // namespace app
