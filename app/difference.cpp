#include "app/difference.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace app {
namespace {

void check_same_leaflets(const render::Frame& first, const render::Frame& second) {
  bool same = first.surfaces.size() == second.surfaces.size() &&
              first.particles[solid_set].positions.size() == second.particles[solid_set].positions.size();
  for (std::size_t s = first_leaflet; same && s < first.surfaces.size(); ++s)
    same = first.surfaces[s].vertices.size() == second.surfaces[s].vertices.size();
  if (!same)
    throw std::invalid_argument(
        "--difference: the runs' leaflets are not made of the same particles (another spacing, mesh or template); leave it out");
}

// Calls use(field, first's values, second's values) for each field of each solid.
void for_each_field(
    const render::Frame& first, const render::Frame& second,
    const std::function<void(std::size_t thing, std::size_t field, const std::vector<float>&, const std::vector<float>&)>& use) {
  for (std::size_t k = 0; k < solid_fields.size(); ++k) {
    for (std::size_t s = first_leaflet; s < first.surfaces.size(); ++s)
      use(s, k, first.surfaces[s].fields[k], second.surfaces[s].fields[k]);
    use(0, k, first.particles[solid_set].fields[k], second.particles[solid_set].fields[k]);
  }
}

}  // namespace

std::vector<double> difference_extent(const render::Frame& first, const render::Frame& second) {
  check_same_leaflets(first, second);
  std::vector<std::vector<float>> sizes(solid_fields.size());
  for_each_field(first, second, [&](std::size_t, std::size_t k, const std::vector<float>& a, const std::vector<float>& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
      if (const float d = std::abs(b[i] - a[i]); std::isfinite(d)) sizes[k].push_back(d);
  });
  std::vector<double> extent;
  for (std::vector<float>& all : sizes) {
    if (all.empty()) {
      extent.push_back(0);
      continue;
    }
    const auto at = all.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    extent.push_back(*at);
  }
  return extent;
}

render::Frame difference_frame(const render::Frame& first, const render::Frame& second, const std::vector<double>& extent) {
  check_same_leaflets(first, second);
  render::Frame result = second;
  for_each_field(first, second, [&](std::size_t thing, std::size_t k, const std::vector<float>& a, const std::vector<float>& b) {
    std::vector<float>& values = thing == 0 ? result.particles[solid_set].fields[k] : result.surfaces[thing].fields[k];
    for (std::size_t i = 0; i < a.size(); ++i) values[i] = b[i] - a[i];
  });
  std::vector<int> solid_scales;
  for (std::size_t k = 0; k < solid_fields.size(); ++k) {
    solid_scales.push_back(scale_slot(solid_fields[k]));
    render::ColorScale& scale = result.scales[static_cast<std::size_t>(solid_scales.back())];
    const double size = std::max(extent.at(k), 1e-12);
    scale = field_scale(solid_fields[k], {-size, size}, "kPa", "diverging");
    scale.label = "Difference";
    scale.highest.reset();
  }
  std::erase_if(result.panels, [&](const render::Panel& panel) {
    return std::none_of(panel.legends.begin(), panel.legends.end(),
                        [&](int legend) { return std::find(solid_scales.begin(), solid_scales.end(), legend) != solid_scales.end(); });
  });
  if (result.panels.empty())
    throw std::invalid_argument("--difference: is of leaflets and other solids; give --field stress, principal_stress or displacement");
  for (render::Panel& panel : result.panels) panel.note = second.title + " minus " + first.title;
  return result;
}

}  // namespace app
