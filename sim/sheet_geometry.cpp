// How a sheet's elements and particles hang together at rest; what sides.cpp asks at every step.
#include <algorithm>
#include <map>

#include "sim/sides.h"

namespace sim {

template <int D>
SheetGeometry<D> make_sheet_geometry(const ShellElasticity<D>& shells) {
  SheetGeometry<D> sheet;
  const std::size_t n = shells.size();
  std::vector<std::int32_t> count(n, 0);
  for (const auto& element : shells.elements)
    for (std::int32_t s : element) ++count[s];
  sheet.incident_start.assign(n + 1, 0);
  for (std::size_t s = 0; s < n; ++s) sheet.incident_start[s + 1] = sheet.incident_start[s] + count[s];
  sheet.incident.resize(sheet.incident_start[n]);
  std::vector<std::int32_t> next(sheet.incident_start.begin(), sheet.incident_start.end() - 1);
  std::map<std::array<std::int32_t, D - 1>, int> facets;  // in 3-D edges, in 2-D end points: those of one element bound the sheet
  for (std::size_t e = 0; e < shells.elements.size(); ++e) {
    const auto& element = shells.elements[e];
    std::array<std::int32_t, D> rows;
    for (int k = 0; k < D; ++k) {
      sheet.incident[next[element[k]]++] = static_cast<std::int32_t>(e);
      rows[k] = element[k] + static_cast<std::int32_t>(shells.first_row);
      std::array<std::int32_t, D - 1> facet;
      for (int m = 0; m < D - 1; ++m) facet[m] = element[(k + m) % D];
      std::sort(facet.begin(), facet.end());
      ++facets[facet];
    }
    sheet.elements.push_back(rows);
  }
  sheet.neighbor_start.assign(1, 0);
  for (std::size_t s = 0; s < n; ++s) {
    const auto first = static_cast<std::ptrdiff_t>(sheet.neighbor.size());
    for (std::int32_t k = sheet.incident_start[s]; k < sheet.incident_start[s + 1]; ++k)
      for (std::int32_t t : shells.elements[sheet.incident[k]])
        if (t != static_cast<std::int32_t>(s)) sheet.neighbor.push_back(t);
    std::sort(sheet.neighbor.begin() + first, sheet.neighbor.end());
    sheet.neighbor.erase(std::unique(sheet.neighbor.begin() + first, sheet.neighbor.end()), sheet.neighbor.end());
    sheet.neighbor_start.push_back(static_cast<std::int32_t>(sheet.neighbor.size()));
  }
  sheet.edge.assign(n, 0);
  for (const auto& [facet, uses] : facets)
    if (uses == 1)
      for (std::int32_t s : facet) sheet.edge[s] = 1;
  return sheet;
}

template SheetGeometry<2> make_sheet_geometry(const ShellElasticity<2>&);
template SheetGeometry<3> make_sheet_geometry(const ShellElasticity<3>&);

}  // namespace sim
