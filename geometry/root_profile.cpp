#include "geometry/root_profile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace geometry::detail {
namespace {

using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

double radius_at(const TriangleTree& tree, const Axis& axis, double theta, double z) {
  return tree.first_hit(axis.at(0, 0, z), std::cos(theta) * axis.x_axis + std::sin(theta) * axis.y_axis);
}

// Mean over +-16 degrees; infinity where fewer than half of the rays meet the wall.
double sector_radius(const TriangleTree& tree, const Axis& axis, double theta, double z) {
  double sum = 0;
  int hits = 0;
  for (int k = -4; k <= 4; ++k) {
    const double r = radius_at(tree, axis, theta + k * 4 * pi / 180, z);
    if (r == infinity) continue;
    sum += r;
    ++hits;
  }
  return hits >= 5 ? sum / hits : infinity;
}

// Keeps harmonic 0 and 2..6: harmonic 1 is an axis beside the middle, the high ones are noise.
std::vector<double> keep_low_harmonics(const std::vector<double>& r, double& third) {
  const auto n = r.size();
  std::vector<double> out(n, 0);
  for (int m : {0, 2, 3, 4, 5, 6}) {
    std::complex<double> c = 0;
    for (std::size_t i = 0; i < n; ++i) c += r[i] * std::polar(1.0, -2 * pi * m * double(i) / double(n));
    c /= double(n);
    if (m == 3) third = 2 * std::abs(c);
    for (std::size_t i = 0; i < n; ++i) out[i] += (m == 0 ? 1 : 2) * (c * std::polar(1.0, 2 * pi * m * double(i) / double(n))).real();
  }
  return out;
}

double gap(double from, double to) { return std::fmod(to - from + 4 * pi, 2 * pi); }

}  // namespace

Vector3d Axis::at(double radius, double theta, double z) const {
  return origin + z * direction + radius * (std::cos(theta) * x_axis + std::sin(theta) * y_axis);
}

Axis make_axis(const Vector3d& origin, const Vector3d& toward) {
  Axis axis;
  axis.origin = origin;
  axis.direction = (toward - origin).normalized();
  axis.x_axis = axis.direction.unitOrthogonal();
  axis.y_axis = axis.direction.cross(axis.x_axis);
  return axis;
}

BoreProfile measure_bore(const TriangleMesh& lumen, const Centreline& line) {
  BoreProfile bore;
  bore.length = line.size() > 0 ? line.arc.back() : 0;
  bore.arc = line.arc;
  bore.diameter.assign(line.size(), 0);
#pragma omp parallel for schedule(dynamic, 4)
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Section section = section_around(lumen, line.points[i], line.tangents[i]);
    if (!section.contour.empty()) bore.diameter[i] = section.diameter();
  }
  return bore;
}

BoreProfile reversed(const BoreProfile& bore) {
  BoreProfile out;
  out.length = bore.length;
  for (std::size_t i = bore.arc.size(); i-- > 0;) {
    out.arc.push_back(bore.length - bore.arc[i]);
    out.diameter.push_back(bore.diameter[i]);
  }
  return out;
}

BoreProfile without_ends(const BoreProfile& bore, double share) {
  BoreProfile out;
  out.length = bore.length;
  for (std::size_t i = 0; i < bore.arc.size(); ++i) {
    if (bore.diameter[i] <= 0 || std::min(bore.arc[i], bore.length - bore.arc[i]) < share * bore.diameter[i]) continue;
    out.arc.push_back(bore.arc[i]);
    out.diameter.push_back(bore.diameter[i]);
  }
  return out;
}

std::vector<double> gauss_smooth(const std::vector<double>& values, double sigma) {
  const int reach = int(std::ceil(3 * sigma)), count = int(values.size());
  std::vector<double> out(values.size());
  for (int i = 0; i < count; ++i) {
    double sum = 0, weights = 0;
    for (int j = std::max(0, i - reach); j <= std::min(count - 1, i + reach); ++j) {
      const double weight = std::exp(-0.5 * (i - j) * (i - j) / (sigma * sigma));
      sum += weight * values[std::size_t(j)];
      weights += weight;
    }
    out[std::size_t(i)] = sum / weights;
  }
  return out;
}

namespace {

// First minimum downstream of s that the bore clearly leaves again, or the lowest within 1.2 diameters.
std::size_t junction_after(const BoreProfile& bore, const std::vector<double>& d, std::size_t s) {
  std::size_t junction = s;
  for (std::size_t i = s + 1; i < d.size() && bore.arc[i] - bore.arc[s] < 1.2 * d[s]; ++i) {
    if (d[i] < d[junction]) junction = i;
    if (d[i] > 1.03 * d[junction]) break;
  }
  return junction;
}

// Going down from s: the narrowest place before the bore widens again.
std::size_t annulus_before(const BoreProfile& bore, const std::vector<double>& d, std::size_t s) {
  std::size_t annulus = s;
  for (std::size_t i = s; i-- > 0 && bore.arc[s] - bore.arc[i] < 1.2 * d[s];) {
    if (d[i] < d[annulus]) annulus = i;
    if (d[i] > 1.05 * d[annulus] && d[s] > 1.12 * d[annulus]) break;
  }
  return annulus;
}

// The profile closes like a dome below the sinus instead of running on as a tube.
bool closes_below(const BoreProfile& bore, const std::vector<double>& d, std::size_t s, std::size_t annulus) {
  if (bore.arc[annulus] - bore.arc[0] > 0.15 * d[s]) return false;
  std::size_t above = annulus;
  while (above < s && bore.arc[above] - bore.arc[annulus] < 0.15 * d[s]) ++above;
  return above == annulus || d[above] - d[annulus] > 0.4 * (bore.arc[above] - bore.arc[annulus]);
}

}  // namespace

std::vector<Candidate> find_widenings(const BoreProfile& bore) {
  std::vector<Candidate> candidates;
  if (bore.diameter.size() < 5) return candidates;
  const std::vector<double> d = gauss_smooth(bore.diameter, 1.5);
  for (std::size_t s = 1; s + 1 < d.size(); ++s) {
    if (d[s] < d[s - 1] || d[s] <= d[s + 1]) continue;
    const std::size_t junction = junction_after(bore, d, s), annulus = annulus_before(bore, d, s);
    if (d[s] < 1.06 * d[junction]) continue;
    Candidate candidate{bore.arc[annulus], bore.arc[s], bore.arc[junction], d[annulus], d[s], d[junction]};
    candidate.inlet_missing = closes_below(bore, d, s, annulus);
    const bool narrow_inlet = d[s] >= 1.12 * d[annulus] && d[annulus] <= 1.08 * d[junction];
    const double length = bore.arc[junction] - bore.arc[annulus];
    if (candidate.inlet_missing || (narrow_inlet && length > 0.45 * d[s] && length < 1.9 * d[s])) candidates.push_back(candidate);
  }
  return candidates;
}

Lobes find_lobes(const TriangleTree& tree, const Axis& axis, double z_sinus, double diameter) {
  constexpr int count = 180, levels = 7;
  Lobes lobes;
  std::vector<double> mean(count, 0);
  for (int i = 0; i < count; ++i) {
    int hits = 0;
    for (int level = 0; level < levels; ++level) {
      const double r = radius_at(tree, axis, 2 * pi * i / count, z_sinus + 0.15 * diameter * (2.0 * level / (levels - 1) - 1));
      if (r == infinity || r > 1.5 * diameter) continue;
      mean[std::size_t(i)] += r;
      ++hits;
    }
    if (hits < levels / 2) {
      lobes.why = "its sections are not closed";
      return lobes;
    }
    mean[std::size_t(i)] /= hits;
  }
  double third = 0, average = 0;
  const std::vector<double> r = keep_low_harmonics(mean, third);
  for (double value : mean) average += value / count;
  lobes.third_harmonic = third / average;
  std::vector<int> peaks;
  for (int i = 0; i < count; ++i)
    if (r[std::size_t(i)] > r[std::size_t((i + count - 1) % count)] && r[std::size_t(i)] >= r[std::size_t((i + 1) % count)])
      peaks.push_back(i);
  if (peaks.size() != 3) {
    lobes.why = "its widening has " + std::to_string(peaks.size()) + " lobes, not three";
    return lobes;
  }
  int valleys[3];  // valley i before peak i
  for (int p = 0; p < 3; ++p) {
    const int from = peaks[std::size_t((p + 2) % 3)], to = peaks[std::size_t(p)];
    valleys[p] = from;
    for (int i = from; i != to; i = (i + 1) % count)
      if (r[std::size_t(i)] < r[std::size_t(valleys[p])]) valleys[p] = i;
  }
  lobes.prominence = infinity;
  for (int p = 0; p < 3; ++p) {
    const double higher = std::max(r[std::size_t(valleys[p])], r[std::size_t(valleys[(p + 1) % 3])]);
    lobes.prominence = std::min(lobes.prominence, (r[std::size_t(peaks[std::size_t(p)])] - higher) / average);
    lobes.peak[std::size_t(p)] = 2 * pi * peaks[std::size_t(p)] / count;
    lobes.valley[std::size_t(p)] = 2 * pi * valleys[p] / count;
  }
  for (std::size_t p = 0; p < 3; ++p) {
    const double sector = gap(lobes.peak[p], lobes.peak[(p + 1) % 3]);
    if (sector < 75 * pi / 180 || sector > 170 * pi / 180) {
      lobes.why = "its three lobes are not spread round the vessel";
      return lobes;
    }
  }
  if (lobes.prominence < 0.07 || lobes.third_harmonic < 0.02) {
    lobes.why = "its three lobes are too shallow";
    return lobes;
  }
  lobes.found = true;
  return lobes;
}

std::optional<Vector3d> find_nadir(const TriangleTree& tree, const Axis& axis, double theta, double z_sinus, double diameter) {
  const double step = 0.0125 * diameter;  // about 0.4 mm
  const double top = z_sinus + 0.35 * diameter;
  std::vector<double> r, z;
  for (double at = top; at > z_sinus - 1.05 * diameter; at -= step) {
    const double radius = sector_radius(tree, axis, theta, at);
    if (radius == infinity || radius > diameter) break;
    r.push_back(radius);
    z.push_back(at);
  }
  if (r.size() < 20) return std::nullopt;
  r = gauss_smooth(r, 0.8e-3 / step * std::min(1.0, diameter / 0.03));
  std::size_t widest = 0;
  for (std::size_t i = 0; i < r.size() && z[i] > z_sinus - 0.35 * diameter; ++i)
    if (r[i] > r[widest]) widest = i;
  // Largest r'' / (1 + r'^2)^1.5 below the lobe, where the wall above it leans outward.
  std::size_t best = 0;
  double sharpest = 0;
  for (std::size_t i = widest + 1; i + 1 < r.size(); ++i) {
    const double below = z[widest] - z[i];
    if (below < 0.12 * diameter || below > 0.7 * diameter) continue;
    const double slope = (r[i - 1] - r[i + 1]) / (2 * step), bend = (r[i - 1] - 2 * r[i] + r[i + 1]) / (step * step);
    const double curvature = bend / std::pow(1 + slope * slope, 1.5);
    if (r[i] < 0.97 * r[widest] && curvature > sharpest) {
      sharpest = curvature;
      best = i;
    }
  }
  if (best == 0) return std::nullopt;
  return axis.at(r[best], theta, z[best]);
}

std::optional<double> find_junction(const TriangleMesh& lumen, const Axis& axis, double z_sinus, double diameter) {
  const double step = 0.0125 * diameter;
  std::vector<double> z, d;
  for (double at = z_sinus; at < z_sinus + 1.3 * diameter; at += step) {
    const Section section = section_around(lumen, axis.at(0, 0, at), axis.direction);
    if (section.contour.empty()) break;
    z.push_back(at);
    d.push_back(section.diameter());
  }
  if (d.size() < 10) return std::nullopt;
  d = gauss_smooth(d, 2);
  std::size_t least = 0;
  for (std::size_t i = 1; i < d.size(); ++i) {
    if (d[i] < d[least]) least = i;
    if (d[i] > 1.02 * d[least] && d[least] < 0.96 * d[0]) break;
  }
  for (std::size_t i = 0; i <= least; ++i)
    if (d[i] <= 1.015 * d[least]) return z[i];
  return std::nullopt;
}

}  // namespace geometry::detail
