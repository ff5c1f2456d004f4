#include "sim/gap_film.h"

#include <Eigen/SparseLU>

namespace sim {

struct FilmFactor {
  Eigen::SparseLU<Eigen::SparseMatrix<double>> lu;
};

GapFilm make_gap_film(std::span<const double> wet, std::span<const std::int32_t> neighbor_start, std::span<const std::int32_t> neighbor) {
  constexpr double through = 1e-3;  // share of the other face: ties faces that no wet face reaches along the sheet
  GapFilm film;
  film.row_of.assign(wet.size(), -1);
  for (std::size_t a = 0; a < wet.size(); ++a) {
    if (wet[a] >= 1) continue;
    film.row_of[a] = static_cast<std::int32_t>(film.face.size());
    film.face.push_back(static_cast<std::int32_t>(a));
  }
  if (film.empty()) return film;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int32_t row = 0; row < static_cast<std::int32_t>(film.face.size()); ++row) {
    const std::int32_t a = film.face[row], s = a / 2, side = a % 2;
    const auto add = [&](std::int32_t other, double weight) {
      if (film.row_of[other] >= 0)
        entries.emplace_back(row, film.row_of[other], -weight);
      else
        film.given.push_back({row, other, weight});
    };
    if (wet[a] > 0) film.given.push_back({row, a, wet[a]});
    entries.emplace_back(row, row, 1 + 1e-9);  // a sheet that no blood touches at all has no pressure
    const std::int32_t count = neighbor_start[s + 1] - neighbor_start[s];
    const double rest = 1 - wet[a], along = count > 0 ? rest * (1 - through) : 0.0;
    for (std::int32_t k = neighbor_start[s]; k < neighbor_start[s + 1]; ++k) add(2 * neighbor[k] + side, along / count);
    add(2 * s + 1 - side, rest - along);
  }
  const auto rows = static_cast<Eigen::Index>(film.face.size());
  Eigen::SparseMatrix<double> matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  film.factor = std::make_shared<FilmFactor>();
  film.factor->lu.compute(matrix);
  return film;
}

void film_pressure(const GapFilm& film, std::span<double> pressure) {
  if (film.empty()) return;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(film.face.size()));
  for (const auto& share : film.given) right[share.row] += share.weight * pressure[share.face];
  const Eigen::VectorXd solution = film.factor->lu.solve(right);
  for (std::size_t row = 0; row < film.face.size(); ++row) pressure[film.face[row]] = solution[static_cast<Eigen::Index>(row)];
}

void film_outflow(const GapFilm& film, std::span<double> volume) {
  if (film.empty()) return;
  Eigen::VectorXd given(static_cast<Eigen::Index>(film.face.size()));
  for (std::size_t row = 0; row < film.face.size(); ++row) {
    given[static_cast<Eigen::Index>(row)] = volume[film.face[row]];
    volume[film.face[row]] = 0;
  }
  const Eigen::VectorXd flux = film.factor->lu.transpose().solve(given);
  for (const auto& share : film.given) volume[share.face] += share.weight * flux[share.row];
}

}  // namespace sim
