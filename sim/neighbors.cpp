#include "sim/neighbors.h"

#include <omp.h>

#include <algorithm>
#include <cmath>

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
  for (const auto& x : position) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  grid.cell = 0.5 * radius;
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
  const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(position.size());
#pragma omp parallel for schedule(static)
  for (std::ptrdiff_t i = 0; i < n; ++i) grid.cell_of[i] = flat<D>(grid, coordinates(grid, position[i]));
  grid.start.assign(total + 1, 0);
  for (std::ptrdiff_t i = 0; i < n; ++i) ++grid.start[grid.cell_of[i] + 1];
  for (std::size_t c = 0; c < total; ++c) grid.start[c + 1] += grid.start[c];
  grid.row.resize(position.size());
  std::vector<std::int32_t> next(grid.start.begin(), grid.start.end() - 1);
  for (std::ptrdiff_t i = 0; i < n; ++i) grid.row[next[grid.cell_of[i]]++] = static_cast<std::int32_t>(i);
}

namespace {

// Calls visit(first, last) for each contiguous run of grid.row that may hold neighbours of x.
template <int D, class Visit>
void visit_runs(const CellGrid<D>& grid, const Vector<D>& x, double radius, Visit&& visit) {
  const std::array<int, D> c = coordinates(grid, x);
  std::array<int, D> low, high;
  for (int k = 0; k < D; ++k) {
    const int reach = static_cast<int>(std::ceil(radius / grid.edge[k] - 1e-9));
    low[k] = c[k] - reach;
    high[k] = c[k] + reach;
    if (grid.periodic[k] && high[k] - low[k] + 1 > grid.cells[k]) {
      low[k] = 0;
      high[k] = grid.cells[k] - 1;
    }
    if (!grid.periodic[k]) {
      low[k] = std::max(low[k], 0);
      high[k] = std::min(high[k], grid.cells[k] - 1);
    }
  }
  auto wrap = [&](int i, int k) { return grid.periodic[k] ? ((i % grid.cells[k]) + grid.cells[k]) % grid.cells[k] : i; };
  auto row_of_cells = [&](std::int32_t base) {
    if (!grid.periodic[0] || (low[0] >= 0 && high[0] < grid.cells[0])) {
      visit(grid.start[base + low[0]], grid.start[base + high[0] + 1]);
      return;
    }
    for (int i = low[0]; i <= high[0]; ++i) visit(grid.start[base + wrap(i, 0)], grid.start[base + wrap(i, 0) + 1]);
  };
  if constexpr (D == 2) {
    for (int j = low[1]; j <= high[1]; ++j) row_of_cells(wrap(j, 1) * grid.cells[0]);
  } else {
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j) row_of_cells((wrap(k, 2) * grid.cells[1] + wrap(j, 1)) * grid.cells[0]);
  }
}

}  // namespace

template <int D>
void find_neighbors(Neighbors& neighbors, CellGrid<D>& grid, std::span<const Vector<D>> position, std::span<const Search> search,
                    std::span<const std::uint8_t> is_fluid, const Domain<D>& domain, double radius) {
  fill_cells(grid, position, domain, radius);
  const Periodicity<D> space = make_periodicity(domain);
  const std::size_t n = position.size();
  std::vector<Vector<D>> sorted(n);
  for (std::size_t k = 0; k < n; ++k) sorted[k] = position[grid.row[k]];
  neighbors.start.assign(n + 1, 0);
  const int chunks = omp_get_max_threads() * 8;
  std::vector<std::vector<std::int32_t>> found(chunks);
  const double square = radius * radius;
#pragma omp parallel for schedule(dynamic, 1)
  for (int chunk = 0; chunk < chunks; ++chunk) {
    auto& list = found[chunk];
    const std::size_t first = n * chunk / chunks, last = n * (chunk + 1) / chunks;
    for (std::size_t i = first; i < last; ++i) {
      if (search[i] == Search::none) continue;
      const bool fluid_only = search[i] == Search::fluid_only;
      const Vector<D> x = position[i];
      const std::size_t before = list.size();
      visit_runs(grid, x, radius, [&](std::int32_t a, std::int32_t b) {
        for (std::int32_t k = a; k < b; ++k) {
          if (space.difference(x, sorted[k]).squaredNorm() >= square) continue;
          const std::int32_t j = grid.row[k];
          if (j == static_cast<std::int32_t>(i) || (fluid_only && !is_fluid[j])) continue;
          list.push_back(j);
        }
      });
      neighbors.start[i + 1] = static_cast<std::int64_t>(list.size() - before);
    }
  }
  for (std::size_t i = 0; i < n; ++i) neighbors.start[i + 1] += neighbors.start[i];
  neighbors.index.resize(static_cast<std::size_t>(neighbors.start[n]));
#pragma omp parallel for schedule(dynamic, 1)
  for (int chunk = 0; chunk < chunks; ++chunk)
    std::copy(found[chunk].begin(), found[chunk].end(), neighbors.index.begin() + neighbors.start[n * chunk / chunks]);
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
