#include "render/skin_cache.h"

#include <algorithm>

namespace render {
namespace {

constexpr int most_levels = 3;

bool same_shape(const Surface& a, const Surface& b) {
  return a.thickness == b.thickness && a.fairing == b.fairing && a.vertices == b.vertices && a.triangles == b.triangles;
}

// Moves the first that fits to the front; false where there is none.
template <class T, class Fits>
bool to_front(std::list<T>& list, Fits fits) {
  const auto found = std::find_if(list.begin(), list.end(), fits);
  if (found == list.end()) return false;
  list.splice(list.begin(), list, found);
  return true;
}

template <class T>
void put_in_front(std::list<T>& list, T item, std::size_t kept) {
  list.push_front(std::move(item));
  if (list.size() > kept) list.pop_back();
}

}  // namespace

int levels_needed(const Surface& surface, float pixels_per_metre) {
  const int most = std::clamp(surface.smoothing, 0, most_levels);
  if (most == 0 || surface.triangles.empty()) return most;
  double sum = 0;
  for (const auto& triangle : surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) sum += (surface.vertices[triangle[k]] - surface.vertices[triangle[(k + 1) % 3]]).norm();
  double edge = sum / (3 * static_cast<double>(surface.triangles.size())) * pixels_per_metre;
  int levels = 0;
  for (; levels < most && edge > longest_edge; edge /= 2) ++levels;
  return levels;
}

std::shared_ptr<const SkinCache::Levels> SkinCache::levels_of(const Surface& surface, int smoothing) {
  const std::size_t count = static_cast<std::size_t>(smoothing) + 1;
  const auto fits = [&](const std::shared_ptr<const Levels>& levels) {
    return levels->each.size() == count && levels->followed.size() == surface.vertices.size() &&
           levels->each.front().triangles == surface.triangles;
  };
  if (!to_front(levels_, fits)) {
    auto levels = std::make_shared<Levels>();
    levels->each.push_back(make_topology(surface.triangles));
    levels->followed = followed(surface.vertices.size(), levels->each.front());
    for (std::size_t vertices = surface.vertices.size(); levels->each.size() < count;) {
      const Topology& coarse = levels->each.back();
      Topology fine = make_topology(refined(coarse, vertices));
      vertices += coarse.edges.size();
      levels->each.push_back(std::move(fine));
    }
    put_in_front<std::shared_ptr<const Levels>>(levels_, levels, kept);
  }
  return levels_.front();
}

SkinCache::Entry SkinCache::make_entry(const Surface& surface, int smoothing) {
  Entry entry;
  entry.surface = {surface.name, surface.vertices, surface.triangles, {}, surface.thickness, smoothing, 0, surface.fairing};
  entry.levels = levels_of(surface, smoothing);
  DrawnMesh& middle = entry.middle;
  middle.positions = faired(surface.vertices, entry.levels->followed, surface.fairing);
  for (std::size_t level = 0; level + 1 < entry.levels->each.size(); ++level)
    middle.positions = subdivided(middle.positions, entry.levels->each[level]);
  const Topology& finest = entry.levels->each.back();
  middle.triangles = finest.triangles;
  middle.normals = vertex_normals(middle.positions, middle.triangles);
  if (surface.thickness > 0) {
    entry.skin = skin(middle, surface.thickness, finest.border);
  } else {
    entry.skin.mesh = middle;
    for (std::size_t i = 0; i < middle.positions.size(); ++i) entry.skin.source.push_back(static_cast<std::int32_t>(i));
  }
  const std::vector<Eigen::Vector3f> outward = border_outward(middle, finest.border);
  const auto edge = [&](std::int32_t i) { return Eigen::Vector3f(middle.positions[i] + 0.5f * surface.thickness * outward[i]); };
  for (const auto& [a, b] : finest.border) entry.rim.push_back({edge(a), edge(b)});
  return entry;
}

SkinCache::Entry& SkinCache::entry_of(const Surface& surface, int smoothing) {
  if (!to_front(entries_, [&](const Entry& entry) { return entry.surface.smoothing == smoothing && same_shape(entry.surface, surface); }))
    put_in_front(entries_, make_entry(surface, smoothing), kept);
  return entries_.front();
}

const DrawnMesh& SkinCache::drawn(const Surface& surface, int field, float pixels_per_metre) {
  Entry& entry = entry_of(surface, levels_needed(surface, pixels_per_metre));
  if (field < 0) {
    entry.skin.mesh.values.resize(entry.skin.mesh.positions.size(), 0.0f);
    return entry.skin.mesh;
  }
  const std::vector<float>& raw = surface.fields.at(static_cast<std::size_t>(field));
  if (entry.surface.averaging == surface.averaging && entry.values == raw && !entry.values.empty()) return entry.skin.mesh;
  entry.surface.averaging = surface.averaging;
  entry.values = raw;
  std::vector<float> values = recovered(raw, surface.vertices, surface.triangles, surface.averaging);
  for (std::size_t level = 0; level + 1 < entry.levels->each.size(); ++level)
    values = subdivided(std::move(values), entry.levels->each[level]);
  entry.skin.mesh.values.clear();
  for (const std::int32_t from : entry.skin.source) entry.skin.mesh.values.push_back(values[static_cast<std::size_t>(from)]);
  return entry.skin.mesh;
}

const DrawnMesh& SkinCache::middle(const Surface& surface, float pixels_per_metre) {
  return entry_of(surface, levels_needed(surface, pixels_per_metre)).middle;
}

const std::vector<std::array<Eigen::Vector3f, 2>>& SkinCache::rim(const Surface& surface, float pixels_per_metre) {
  return entry_of(surface, levels_needed(surface, pixels_per_metre)).rim;
}

const Border& SkinCache::border(const Surface& surface) { return levels_of(surface, 0)->each.front().border; }

}  // namespace render
