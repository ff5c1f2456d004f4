#include "sim/neighbors.h"

#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace sim {

template <int D>
Periodicity<D> make_periodicity(const Domain<D>& domain) {
  Periodicity<D> p;
  if (!domain.present) return p;
  for (int k = 0; k < D; ++k)
    if (domain.periodic[k]) {
      p.any = true;
      p.length[k] = domain.max[k] - domain.min[k];
      p.origin[k] = domain.min[k];
    }
  return p;
}

namespace {

// Extent of the grid along one axis: the periodic length, or the particles' box.
template <int D>
void lay_out(CellGrid<D>& grid, std::span<const Vector<D>> position, const Domain<D>& domain, double radius) {
  Vector<D> low = Vector<D>::Constant(1e300), high = Vector<D>::Constant(-1e300);
#pragma omp parallel if (position.size() > 8192)
  {
    Vector<D> lowest = low, highest = high;
#pragma omp for schedule(static) nowait
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(position.size()); ++i) {
      lowest = lowest.cwiseMin(position[i]);
      highest = highest.cwiseMax(position[i]);
    }
#pragma omp critical
    {
      low = low.cwiseMin(lowest);
      high = high.cwiseMax(highest);
    }
  }
  grid.cell = radius;
  for (int k = 0; k < D; ++k) {
    grid.periodic[k] = domain.present && domain.periodic[k];
    if (grid.periodic[k]) {
      low[k] = domain.min[k];
      high[k] = domain.max[k];
    }
    const double extent = std::max(high[k] - low[k], 1e-12);
    const double count = std::clamp(std::floor(extent / grid.cell), 1.0, 4096.0);
    grid.cells[k] = static_cast<int>(count);
    grid.edge[k] = std::max(extent / count, grid.periodic[k] ? 0.0 : grid.cell) * (grid.periodic[k] ? 1.0 : 1.0 + 1e-9);
  }
  grid.origin = low;
  // One particle far away must not make a grid that no memory holds: coarser cells along the longest axes then.
  const double most = std::max(2e7, 8.0 * static_cast<double>(position.size()));
  for (;;) {
    double total = 1;
    int longest = 0;
    for (int k = 0; k < D; ++k) {
      total *= grid.cells[k];
      if (grid.cells[k] > grid.cells[longest]) longest = k;
    }
    if (total <= most) break;
    const int fewer = (grid.cells[longest] + 1) / 2;
    grid.edge[longest] *= static_cast<double>(grid.cells[longest]) / fewer;
    grid.cells[longest] = fewer;
  }
}

template <int D>
std::array<int, D> coordinates(const CellGrid<D>& grid, const Vector<D>& x) {
  std::array<int, D> c;
  for (int k = 0; k < D; ++k) {
    int i = static_cast<int>(std::floor((x[k] - grid.origin[k]) / grid.edge[k]));
    if (grid.periodic[k]) i = ((i % grid.cells[k]) + grid.cells[k]) % grid.cells[k];
    c[k] = std::clamp(i, 0, grid.cells[k] - 1);
  }
  return c;
}

template <int D>
std::int32_t flat(const CellGrid<D>& grid, const std::array<int, D>& c) {
  std::int32_t cell = c[D - 1];
  for (int k = D - 2; k >= 0; --k) cell = cell * grid.cells[k] + c[k];
  return cell;
}

}  // namespace

template <int D>
void fill_cells(CellGrid<D>& grid, std::span<const Vector<D>> position, const Domain<D>& domain, double radius) {
  lay_out(grid, position, domain, radius);
  std::size_t total = 1;
  for (int k = 0; k < D; ++k) total *= static_cast<std::size_t>(grid.cells[k]);
  grid.cell_of.resize(position.size());
  grid.row.resize(position.size());
  grid.start.assign(total + 1, 0);
  const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(position.size());
  // Each part of the rows is counted and dealt out by itself; the parts lie one behind the other in every cell, so that rows ascend in it.
  const std::size_t most_parts = std::max<std::size_t>(1, 4 * position.size() / total);
  const auto parts = static_cast<std::ptrdiff_t>(std::min<std::size_t>(static_cast<std::size_t>(omp_get_max_threads()), most_parts));
  grid.next.assign(static_cast<std::size_t>(parts) * total, 0);
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t part = 0; part < parts; ++part) {
    std::int32_t* count = grid.next.data() + static_cast<std::size_t>(part) * total;
    for (std::ptrdiff_t i = n * part / parts; i < n * (part + 1) / parts; ++i) {
      grid.cell_of[i] = flat<D>(grid, coordinates(grid, position[i]));
      ++count[grid.cell_of[i]];
    }
  }
  std::int32_t sum = 0;
  for (std::size_t c = 0; c < total; ++c) {
    grid.start[c] = sum;
    for (std::ptrdiff_t part = 0; part < parts; ++part) {
      std::int32_t& count = grid.next[static_cast<std::size_t>(part) * total + c];
      sum += std::exchange(count, sum);
    }
  }
  grid.start[total] = sum;
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t part = 0; part < parts; ++part) {
    std::int32_t* next = grid.next.data() + static_cast<std::size_t>(part) * total;
    for (std::ptrdiff_t i = n * part / parts; i < n * (part + 1) / parts; ++i)
      grid.row[next[grid.cell_of[i]]++] = static_cast<std::int32_t>(i);
  }
}

namespace {

// Cells along axis k that may hold neighbours of what lies in cell c, each once.
template <int D>
void cells_around(const CellGrid<D>& grid, int c, int k, std::vector<int>& around) {
  around.clear();
  const int cells = grid.cells[k];
  for (int i = c - 1; i <= c + 1; ++i) {
    const int wrapped = grid.periodic[k] ? (i + cells) % cells : i;
    if (wrapped >= 0 && wrapped < cells && std::find(around.begin(), around.end(), wrapped) == around.end()) around.push_back(wrapped);
  }
  std::sort(around.begin(), around.end());
}

// What lies in a cell and around it, copied together: the particles of the cell are all compared with the same candidates.
template <int D>
struct Candidates {
  std::array<std::vector<double>, D> x;
  std::vector<std::int32_t> row;
  std::vector<std::uint8_t> is_fluid;
  std::vector<double> square;      // of the distance from the particle in turn, m²
  std::vector<std::uint8_t> near;  // 1 where it is a neighbour
  std::size_t own = 0;             // where the cell's own particles begin
  std::array<std::vector<int>, D> around;

  void gather(const CellGrid<D>& grid, std::span<const Vector<D>> position, std::span<const std::uint8_t> fluid, std::size_t cell) {
    std::array<int, D> c;
    std::size_t rest = cell;
    for (int k = 0; k < D; ++k) {
      c[k] = static_cast<int>(rest % static_cast<std::size_t>(grid.cells[k]));
      rest /= static_cast<std::size_t>(grid.cells[k]);
      cells_around(grid, c[k], k, around[k]);
    }
    row.clear();
    const auto add = [&](std::array<int, D> at) {
      const std::int32_t one = flat<D>(grid, at);
      if (static_cast<std::size_t>(one) == cell) own = row.size();
      row.insert(row.end(), grid.row.begin() + grid.start[one], grid.row.begin() + grid.start[one + 1]);
    };
    if constexpr (D == 2) {
      for (int j : around[1])
        for (int i : around[0]) add({i, j});
    } else {
      for (int k : around[2])
        for (int j : around[1])
          for (int i : around[0]) add({i, j, k});
    }
    // Filled up to whole registers with candidates that are far from all.
    const std::size_t whole = (row.size() + 7) / 8 * 8;
    for (int k = 0; k < D; ++k) x[k].resize(whole), std::fill(x[k].begin() + static_cast<std::ptrdiff_t>(row.size()), x[k].end(), 1e150);
    is_fluid.resize(whole), square.resize(whole), near.resize(whole);
    for (std::size_t m = 0; m < row.size(); ++m) {
      for (int k = 0; k < D; ++k) x[k][m] = position[row[m]][k];
      is_fluid[m] = fluid[row[m]];
    }
  }

  // Squared distances from `from` along periodic axes: the nearest image counts.
  void measure_periodic(const Vector<D>& from, const Periodicity<D>& space) {
    const std::size_t count = square.size();
    std::fill(square.begin(), square.end(), 0.0);
    double* result = square.data();
    for (int k = 0; k < D; ++k) {
      const double* at = x[k].data();
      const double here = from[k], length = space.length[k], half = length > 0 ? 0.5 * length : 1e300;
#pragma omp simd
      for (std::size_t m = 0; m < count; ++m) {
        double r = at[m] - here;
        r -= r > half ? length : 0.0;
        r += r < -half ? length : 0.0;
        result[m] += r * r;
      }
    }
  }

  // Marks the candidates nearer to `from` than the root of `within`.
  void mark(const Vector<D>& from, double within, std::uint8_t any_kind) {
    const std::size_t count = near.size();
    const std::uint8_t* fluid = is_fluid.data();
    std::uint8_t* chosen = near.data();
    std::array<const double*, D> at;
    const Vector<D> here = from;
    for (int k = 0; k < D; ++k) at[k] = x[k].data();
#pragma omp simd
    for (std::size_t m = 0; m < count; ++m) {
      double distance = 0;
      for (int k = 0; k < D; ++k) distance += (at[k][m] - here[k]) * (at[k][m] - here[k]);
      chosen[m] = static_cast<std::uint8_t>((distance < within) & (fluid[m] | any_kind));
    }
  }
  void mark_measured(double within, std::uint8_t any_kind) {
    const std::size_t count = near.size();
    const double* distance = square.data();
    const std::uint8_t* fluid = is_fluid.data();
    std::uint8_t* chosen = near.data();
#pragma omp simd
    for (std::size_t m = 0; m < count; ++m) chosen[m] = static_cast<std::uint8_t>((distance[m] < within) & (fluid[m] | any_kind));
  }

  // Writes the rows nearer to `from` than the root of `within`, candidate `self` apart, to `to`; returns how many.
  std::size_t select(const Vector<D>& from, const Periodicity<D>& space, double within, bool fluid_only, std::size_t self,
                     std::int32_t* to) {
    const std::size_t count = near.size();
    std::uint8_t* chosen = near.data();
    const std::uint8_t any_kind = fluid_only ? 0 : 1;
    if (space.any) {
      measure_periodic(from, space);
      mark_measured(within, any_kind);
    } else {
      mark(from, within, any_kind);
    }
    chosen[self] = 0;
    std::size_t found = 0;
    for (std::size_t m = 0; m < count; m += 8) {  // few are near: eight at a time are passed by
      std::uint64_t word;
      std::memcpy(&word, chosen + m, 8);
      for (; word != 0; word &= word - 1) to[found++] = row[m + static_cast<std::size_t>(std::countr_zero(word)) / 8];
    }
    return found;
  }
};

}  // namespace

std::int32_t* FoundRows::space_for(std::size_t more) {
  if (count + more > room) {
    room = std::max<std::size_t>(2 * room, count + more + 4096);
    std::unique_ptr<std::int32_t[]> larger(new std::int32_t[room]);
    std::copy(row.get(), row.get() + count, larger.get());
    row = std::move(larger);
  }
  return row.get() + count;
}

template <int D>
void find_neighbors(Neighbors& neighbors, CellGrid<D>& grid, std::span<const Vector<D>> position, std::span<const Search> search,
                    std::span<const std::uint8_t> is_fluid, const Domain<D>& domain, double radius) {
  fill_cells(grid, position, domain, radius);
  const Periodicity<D> space = make_periodicity(domain);
  const std::size_t n = position.size();
  neighbors.start.assign(n + 1, 0);
  std::vector<std::size_t>& found_at = grid.found_at;
  found_at.resize(n);
  const int chunks = omp_get_max_threads() * 32;
  std::vector<FoundRows>& found = grid.found;
  found.resize(chunks);
  for (FoundRows& list : found) list.count = 0;
  const std::size_t cells = grid.start.size() - 1;
  // Chunks of whole cells with about as many particles each.
  const auto first_cell = [&](int chunk) {
    if (chunk == chunks) return cells;
    const auto rows = static_cast<std::int32_t>(n * static_cast<std::size_t>(chunk) / static_cast<std::size_t>(chunks));
    return static_cast<std::size_t>(std::lower_bound(grid.start.begin(), grid.start.end() - 1, rows) - grid.start.begin());
  };
  const double square = radius * radius;
#pragma omp parallel
  {
    Candidates<D> candidates;
#pragma omp for schedule(dynamic, 1)
    for (int chunk = 0; chunk < chunks; ++chunk) {
      FoundRows& list = found[chunk];
      const std::size_t last = first_cell(chunk + 1);
      for (std::size_t cell = first_cell(chunk); cell < last; ++cell) {
        bool gathered = false;
        for (std::int32_t m = grid.start[cell]; m < grid.start[cell + 1]; ++m) {
          const std::int32_t i = grid.row[m];
          if (search[i] == Search::none) continue;
          if (!gathered) candidates.gather(grid, position, is_fluid, cell);
          gathered = true;
          const std::size_t near =
              candidates.select(position[i], space, square, search[i] == Search::fluid_only,
                                candidates.own + static_cast<std::size_t>(m - grid.start[cell]), list.space_for(candidates.row.size()));
          found_at[i] = list.count;
          neighbors.start[i + 1] = static_cast<std::int64_t>(near);
          list.count += near;
        }
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) neighbors.start[i + 1] += neighbors.start[i];
  neighbors.index.resize(static_cast<std::size_t>(neighbors.start[n]));
#pragma omp parallel for schedule(dynamic, 1)
  for (int chunk = 0; chunk < chunks; ++chunk)
    for (std::int32_t m = grid.start[first_cell(chunk)]; m < grid.start[first_cell(chunk + 1)]; ++m) {
      const std::int32_t i = grid.row[m];
      if (search[i] == Search::none) continue;
      const std::int32_t* rows = found[chunk].row.get() + found_at[i];
      std::copy(rows, rows + (neighbors.start[i + 1] - neighbors.start[i]), neighbors.index.begin() + neighbors.start[i]);
    }
}

template Periodicity<2> make_periodicity(const Domain<2>&);
template Periodicity<3> make_periodicity(const Domain<3>&);
template void fill_cells(CellGrid<2>&, std::span<const Vector<2>>, const Domain<2>&, double);
template void fill_cells(CellGrid<3>&, std::span<const Vector<3>>, const Domain<3>&, double);
template void find_neighbors(Neighbors&, CellGrid<2>&, std::span<const Vector<2>>, std::span<const Search>, std::span<const std::uint8_t>,
                             const Domain<2>&, double);
template void find_neighbors(Neighbors&, CellGrid<3>&, std::span<const Vector<3>>, std::span<const Search>, std::span<const std::uint8_t>,
                             const Domain<3>&, double);

}  // namespace sim
