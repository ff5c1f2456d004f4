#include "geometry/surface_shares.h"

#include <algorithm>
#include <cmath>

#include "geometry/iso_surface.h"
#include "geometry/point_grid.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

struct Group {
  Vector3d area = Vector3d::Zero();
  std::vector<std::size_t> element;
};

// Elements of one particle, the largest first, each to the group that faces the same way; slivers (chamfers that the grid cuts off edges)
// go to the group nearest in direction.
std::vector<Group> facing_groups(const std::vector<SurfaceElement>& elements, std::vector<std::size_t> own, double sliver) {
  std::stable_sort(own.begin(), own.end(), [&](std::size_t a, std::size_t b) {
    return elements[a].area.squaredNorm() > elements[b].area.squaredNorm() * (1 + 1e-9);
  });
  constexpr double same_way = 0.866;
  std::vector<Group> groups;
  const auto closest = [&](const Vector3d& area, const Group* but) {
    Group* best = nullptr;
    double cosine = -2;
    for (Group& group : groups) {
      const double c = &group == but ? -2 : group.area.dot(area) / std::max(group.area.norm() * area.norm(), 1e-300);
      if (c > cosine) cosine = c, best = &group;
    }
    return std::pair{best, cosine};
  };
  const auto join = [](Group& group, const Vector3d& area, const std::vector<std::size_t>& element) {
    group.area += area;
    group.element.insert(group.element.end(), element.begin(), element.end());
  };
  for (std::size_t e : own) {
    const auto [group, cosine] = closest(elements[e].area, nullptr);
    if (cosine > same_way)
      join(*group, elements[e].area, {e});
    else
      groups.push_back({elements[e].area, {e}});
  }
  for (std::size_t g = 0; g < groups.size() && groups.size() > 1;) {
    if (groups[g].area.norm() > sliver) {
      ++g;
      continue;
    }
    join(*closest(groups[g].area, &groups[g]).first, groups[g].area, groups[g].element);
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(g));
    g = 0;
  }
  while (groups.size() > most_shares) {
    const auto smallest = std::ranges::min_element(groups, {}, [](const Group& group) { return group.area.squaredNorm(); });
    join(*closest(smallest->area, &*smallest).first, smallest->area, smallest->element);
    groups.erase(smallest);
  }
  return groups;
}

SurfaceShare share_of(const std::vector<SurfaceElement>& elements, const std::vector<std::size_t>& own, std::size_t particle,
                      const Vector3d& x) {
  SurfaceShare share{particle};
  for (std::size_t e : own) share.area += elements[e].area;
  if (share.area.squaredNorm() > 0)
    for (std::size_t e : own) share.offset += (elements[e].center - x) * (elements[e].area.dot(share.area) / share.area.squaredNorm());
  return share;
}

bool has_mesh(const Shape& shape) {
  const auto part_has = [](const Shape& part) { return has_mesh(part); };
  return std::holds_alternative<MeshSolid>(shape.base) || std::any_of(shape.subtract.begin(), shape.subtract.end(), part_has) ||
         std::any_of(shape.intersect.begin(), shape.intersect.end(), part_has);
}

// Grid on which the surface is cut into elements, in particle spacings. It chamfers edges: with a quarter of a spacing the faces beside
// them lose so much that an eighth of a sphere of four layers bulges by 1 %. Meshes, to which distances are dear, have a quarter.
double fineness(const Shape& shape) { return has_mesh(shape) ? 0.25 : 0.125; }

}  // namespace

std::vector<SurfaceShare> surface_shares(const Shape& shape, const std::vector<Vector3d>& position, int dimension, double spacing,
                                         double volume, const std::function<bool(const Vector3d&)>& inside) {
  const std::vector<SurfaceElement> elements = surface_elements(shape, dimension, fineness(shape) * spacing);
  std::vector<std::vector<std::size_t>> own(position.size());
  const PointGrid grid(position, 2.5 * spacing);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    double best = 1e300;
    std::size_t nearest = position.size();
    grid.for_each_near(elements[e].center, [&](std::size_t i, const Vector3d&, double d2) {
      if (d2 < best) best = d2, nearest = i;
    });
    if (nearest < position.size()) own[nearest].push_back(e);
  }
  std::vector<SurfaceShare> shares;
  std::vector<std::vector<std::size_t>> members;
  double size = 0, enclosed = 0;
  const double sliver = 0.1 * std::pow(spacing, dimension - 1);
  for (std::size_t i = 0; i < position.size(); ++i)
    for (Group& group : facing_groups(elements, own[i], sliver)) {
      shares.push_back(share_of(elements, group.element, i, position[i]));
      members.push_back(std::move(group.element));
      size += shares.back().area.norm();
      enclosed += shares.back().area.dot(position[i] + shares.back().offset) / dimension;
    }
  const double move = volume > 0 && size > 0 ? dimension * (volume - enclosed) / size : 0;
  std::vector<SurfaceShare> result;
  for (std::size_t s = 0; s < shares.size(); ++s) {
    SurfaceShare share = shares[s];
    if (inside) {
      const std::size_t all = members[s].size();
      std::erase_if(members[s], [&](std::size_t e) { return !inside(elements[e].center); });
      if (members[s].empty()) continue;
      if (members[s].size() < all) share = share_of(elements, members[s], share.particle, position[share.particle]);
    }
    if (!(share.area.norm() > 0)) continue;
    share.offset += move * share.area.normalized();
    result.push_back(share);
  }
  return result;
}

}  // namespace geometry
