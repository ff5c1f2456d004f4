// Which side of a leaflet: links that cross one are cut in all sums, and blood keeps to its side.
#pragma once

#include "sim/scene.h"
#include "sim/workspace.h"

namespace sim {

// The shells' elements as they are now, with their plane: element e has the State rows elements[e].
template <int D>
struct SheetGeometry {
  std::vector<std::array<std::int32_t, D>> elements;   // State rows
  std::vector<std::int32_t> incident_start, incident;  // per shell row: elements that hold it
  std::vector<std::int32_t> neighbor_start, neighbor;  // per shell row: rows that share an element
  std::vector<std::uint8_t> edge;                      // per shell row: on the sheet's boundary
};
template <int D>
SheetGeometry<D> make_sheet_geometry(const ShellElasticity<D>& shells);

// Sets the link weight to 0 for every neighbour entry of a fluid row whose segment crosses a sheet element that does not hold the
// neighbour itself. Symmetric between fluid rows.
template <int D>
void cut_links(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// For each face of a shell row (0: normal's side, 1: the other) the blood that wets it: rows, normalised weights and how wet it is; and the
// film that joins the faces that no blood reaches (gap_film.h).
template <int D>
void wetted_sides(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);

// Remembers where blood near a sheet is, before the move…
template <int D>
void remember_sides(const Scene<D>& scene, const State<D>& state, Workspace<D>& work);
// …and after it puts back, at 0.35 l0 on its side, what crossed or came nearer; takes the approach velocity. Counts crossings.
template <int D>
void keep_sides(const Scene<D>& scene, State<D>& state, Workspace<D>& work);

// Blood in gaps too narrow to resolve (support < 1) moves with what surrounds it: there viscosity rules (lubrication).
template <int D>
void stick_in_gaps(State<D>& state, const Workspace<D>& work);

}  // namespace sim
