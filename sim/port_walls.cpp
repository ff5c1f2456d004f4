#include "sim/port_walls.h"

#include <cmath>
#include <map>

namespace sim {
namespace {

template <class Row>
void insert_rows(std::vector<Row>& rows, std::size_t at, const std::vector<Row>& more) {
  if (!rows.empty() || at == 0) rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(at), more.begin(), more.end());
}

}  // namespace

template <int D>
void continue_walls_beyond_ports(SceneDescription<D>& description, double depth) {
  InitialParticles<D>& particles = description.particles;
  const double l0 = description.spacing;
  std::map<std::array<long, D>, std::vector<Vector<D>>> occupied;
  auto cell = [&](const Vector<D>& x) {
    std::array<long, D> c;
    for (int k = 0; k < D; ++k) c[k] = std::lround(std::floor(x[k] / l0));
    return c;
  };
  std::size_t fluid_start = 0;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (particles.kind[i] != Kind::fluid) {
      occupied[cell(particles.position[i])].push_back(particles.position[i]);
      fluid_start = i + 1;
    }
  auto taken = [&](const Vector<D>& x) {
    const auto c = cell(x);
    bool found = false;
    auto look = [&](auto&& self, int k, std::array<long, D> at) -> void {
      if (k == D) {
        const auto it = occupied.find(at);
        if (it != occupied.end())
          for (const auto& y : it->second) found = found || (y - x).squaredNorm() < 0.49 * l0 * l0;
        return;
      }
      for (long s = -1; s <= 1; ++s) {
        at[k] = c[k] + s;
        self(self, k + 1, at);
      }
    };
    look(look, 0, c);
    return found;
  };
  std::vector<Vector<D>> position, normal;
  std::vector<double> depths, volumes;
  for (const auto& port : description.ports)
    for (std::size_t i = 0; i < fluid_start; ++i) {
      if (particles.kind[i] != Kind::wall) continue;
      const Vector<D> r = particles.position[i] - port.point;
      const double height = r.dot(port.normal), aside = (r - height * port.normal).norm();
      if (height > 0 || height < -depth || aside > port.radius + 5 * l0) continue;
      const Vector<D> mirrored = particles.position[i] - 2 * height * port.normal;
      if (taken(mirrored)) continue;
      occupied[cell(mirrored)].push_back(mirrored);
      position.push_back(mirrored);
      normal.push_back(particles.normal[i] - 2 * particles.normal[i].dot(port.normal) * port.normal);
      depths.push_back(particles.depth[i]);
      volumes.push_back(particles.volume[i]);
    }
  if (position.empty()) return;
  const std::size_t count = position.size();
  Body body;
  body.name = "walls beyond the ports";
  body.kind = Kind::wall;
  body.first = static_cast<std::int64_t>(fluid_start);
  body.count = static_cast<std::int64_t>(count);
  const std::vector<Vector<D>> zero(count, Vector<D>::Zero());
  insert_rows(particles.position, fluid_start, position);
  insert_rows(particles.velocity, fluid_start, zero);
  insert_rows(particles.kind, fluid_start, std::vector<Kind>(count, Kind::wall));
  insert_rows(particles.body, fluid_start, std::vector<std::int32_t>(count, static_cast<std::int32_t>(description.bodies.size())));
  insert_rows(particles.volume, fluid_start, volumes);
  insert_rows(particles.normal, fluid_start, normal);
  insert_rows(particles.depth, fluid_start, depths);
  insert_rows(particles.surface_area, fluid_start, zero);
  insert_rows(particles.fixed, fluid_start, std::vector<std::uint8_t>(count, 0));
  insert_rows(particles.stiffness_scale, fluid_start, std::vector<double>(count, 1.0));
  insert_rows(particles.fibre, fluid_start, zero);
  for (auto& other : description.bodies)
    if (other.kind == Kind::fluid) other.first += static_cast<std::int64_t>(count);
  description.bodies.push_back(body);
}

template void continue_walls_beyond_ports(SceneDescription<2>&, double);
template void continue_walls_beyond_ports(SceneDescription<3>&, double);

}  // namespace sim
