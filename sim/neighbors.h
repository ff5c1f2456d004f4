// Who is near whom: a cell grid and, per row, the list of its neighbours within the kernel radius.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/particles.h"
#include "sim/scene_description.h"

namespace sim {

// Shortest vector from a to b in a space that may be periodic along some axes.
template <int D>
struct Periodicity {
  std::array<double, D> length{};  // m, 0 = not periodic
  std::array<double, D> origin{};  // m
  bool any = false;
  Vector<D> difference(const Vector<D>& from, const Vector<D>& to) const {
    Vector<D> r = to - from;
    if (any)
      for (int k = 0; k < D; ++k)
        if (length[k] > 0) {
          if (r[k] > 0.5 * length[k]) r[k] -= length[k];
          if (r[k] < -0.5 * length[k]) r[k] += length[k];
        }
    return r;
  }
  Padded<D> difference(const Padded<D>& from, const Padded<D>& to) const requires(D == 3) {
    Padded<D> r = to - from;
    if (any) r.template head<D>() = difference(Vector<D>(from.template head<D>()), Vector<D>(to.template head<D>()));
    return r;
  }
  // The position inside the periodic domain.
  Vector<D> wrapped(Vector<D> x) const {
    if (any)
      for (int k = 0; k < D; ++k)
        if (length[k] > 0) {
          while (x[k] < origin[k]) x[k] += length[k];
          while (x[k] >= origin[k] + length[k]) x[k] -= length[k];
        }
    return x;
  }
};
template <int D>
Periodicity<D> make_periodicity(const Domain<D>& domain);

// Rows whose neighbours are wanted, and which rows count as neighbours for them.
enum class Search : std::uint8_t { none, fluid_only, all };

// Neighbours of row i: index[start[i]] … index[start[i + 1] - 1], in a fixed order (cell by cell, rows ascending inside a cell).
struct Neighbors {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> index;
  std::span<const std::int32_t> of(std::size_t row) const {
    return {index.data() + start[row], static_cast<std::size_t>(start[row + 1] - start[row])};
  }
};

// Rows found by one part of the search; grows by doubling, without setting what is written next anyway.
struct FoundRows {
  std::unique_ptr<std::int32_t[]> row;
  std::size_t count = 0, room = 0;
  std::int32_t* space_for(std::size_t more);
};

// Cells of at least a radius over the particles' bounding box.
template <int D>
struct CellGrid {
  Vector<D> origin;
  std::array<int, D> cells{};
  std::array<bool, D> periodic{};
  double cell = 0;                       // m, smallest cell edge
  std::array<double, D> edge{};          // m, per axis (periodic axes fit a whole number)
  std::vector<std::int32_t> start, row;  // cell -> rows
  std::vector<std::int32_t> cell_of;     // row -> cell
  std::vector<std::int32_t> next;        // scratch: per part of the rows and cell, where its next row goes
  std::vector<FoundRows> found;          // scratch of the search
  std::vector<std::size_t> found_at;
};
template <int D>
void fill_cells(CellGrid<D>& grid, std::span<const Vector<D>> position, const Domain<D>& domain, double radius);

// Fills `neighbors` for every row i with search[i] != none with all rows j != i nearer than `radius`; where search[i] is fluid_only, only
// rows with is_fluid[j]. Non-finite positions are refused by the caller.
template <int D>
void find_neighbors(Neighbors& neighbors, CellGrid<D>& grid, std::span<const Vector<D>> position, std::span<const Search> search,
                    std::span<const std::uint8_t> is_fluid, const Domain<D>& domain, double radius);

}  // namespace sim
