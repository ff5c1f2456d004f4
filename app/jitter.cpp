#include "app/jitter.h"

#include "app/split_mix.h"

namespace app {
namespace {

// The n-th number of a seed without those before it.
double uniform(std::uint64_t seed, std::uint64_t n) { return uniform_of(seed * 0xd1342543de82ef95ull + (n + 1) * 0x9e3779b97f4a7c15ull); }

}  // namespace

void jitter_particles(CaseParticles& parts, const StartSpec& start, int dimension, double spacing) {
  if (start.jitter == 0) return;
  std::uint64_t n = 0;
  for (BodyParticles& body : parts.bodies)
    for (std::size_t i = 0; i < body.size(); ++i) {
      const bool moves = body.kind == sim::Kind::fluid || (body.kind == sim::Kind::elastic && body.depth[i] > spacing);
      for (int axis = 0; axis < dimension; ++axis) {
        const double shift = start.jitter * spacing * (2 * uniform(start.seed, n++) - 1);
        if (moves) body.position[i][axis] += shift;
      }
    }
}

}  // namespace app
