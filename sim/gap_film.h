// The film of blood between leaflets that lie on each other: too thin for particles, it still has a pressure (the reason why a closed
// valve's leaflets are pressed together only as far as that film lets them).
//
// A face of a shell particle that blood particles wet takes their pressure, p_own. One that none reaches takes the mean of its mesh
// neighbours on the same face: Reynolds' lubrication equation for a film of even thickness, div grad p = 0 along the sheet, between the
// wet faces at its two ends. Between the two `wet` in [0, 1] blends, so that one particle more or less changes no pressure by a jump:
//   p_a = wet_a p_own,a + (1 - wet_a) mean_n p_n
// The transpose of that map brings the volume that a face displaces to the blood at the film's ends: force and volume stay adjoint.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sim {

struct FilmFactor;  // sparse LU of the film's equations

// Faces are numbered 2 s + side (0: the normal's, 1: the other) for shell row s.
struct GapFilm {
  std::vector<std::int32_t> row_of;  // face -> row of the film's equations, -1 where fully wet
  std::vector<std::int32_t> face;    // row -> face
  struct Share {
    std::int32_t row, face;
    double weight;
  };
  std::vector<Share> given;  // right-hand side: weights of p_own
  std::shared_ptr<FilmFactor> factor;
  bool empty() const { return face.empty(); }
};

// wet: per face; neighbours of shell row s: neighbor[neighbor_start[s] .. neighbor_start[s + 1]). Faces of a sheet without any wet face
// take the pressure of the other face.
GapFilm make_gap_film(std::span<const double> wet, std::span<const std::int32_t> neighbor_start, std::span<const std::int32_t> neighbor);

// p_own -> p on all faces, in place; Pa.
void film_pressure(const GapFilm& film, std::span<double> pressure);

// Transpose of film_pressure, in place: volumes displaced at faces -> at wet faces.
void film_outflow(const GapFilm& film, std::span<double> volume);

}  // namespace sim
