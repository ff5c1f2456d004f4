#pragma once

#include <utility>

#include "app/build_case.h"
#include "app/run_case.h"

namespace app {

template <class Use>
void with_scene(const SceneFile& file, Use&& use) {
  if (file.dimension == 2) {
    BuiltCase<2> built = build_case<2>(file);
    const sim::Scene<2> scene = sim::make_scene(std::move(built.description));
    use(built, scene);
  } else {
    BuiltCase<3> built = build_case<3>(file);
    const sim::Scene<3> scene = sim::make_scene(std::move(built.description));
    use(built, scene);
  }
}

}  // namespace app
