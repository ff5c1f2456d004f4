// What the published elastic operators simulate, in numbers: for `cusp explain --paper` and docs/paper.md.
#pragma once

#include <nlohmann/json.hpp>

namespace app {

// One row a Poisson's ratio: the material's own moduli and those that Eqs (21), (22), (24) simulate: derived to leading order, and measured with
// the program's operator on quadratic displacements in a cube of particles; the bar: its stiffness against the material's (derived, and
// measured on a stretched bar of 4 x 4 particles across), and its von Mises stress inside against the true F/A.
nlohmann::json measure_paper();

}  // namespace app
