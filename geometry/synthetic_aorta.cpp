#include "geometry/synthetic_aorta.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geometry {
namespace {

using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;

// 0 below `from`, 1 above `to`, smooth with two continuous derivatives.
double smooth_step(double z, double from, double to) {
  const double s = std::clamp((z - from) / (to - from), 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

// Height profile of a sinus: 0 at the annulus and at the junction, 1 at `peak` (as parts of the height between), with a rounded knee at
// both ends; the knee is what a nadir is recognised by.
double sinus_profile(double part, double peak) {
  const double skew = (0.5 - peak) / (peak * (1 - peak));
  const double s = part + skew * part * (1 - part);
  double bulge = std::sin(pi * s);
  if (part < 0) bulge = pi * (1 + skew) * part;
  if (part > 1) bulge = pi * (1 - skew) * (1 - part);
  const double rounding = 0.12;
  return 0.5 * (bulge + std::sqrt(bulge * bulge + rounding * rounding));
}

double bare_radius(const SyntheticAorta& a, double z) {
  double radius = 0.5 * a.outflow_diameter;
  radius += 0.5 * (a.annulus_diameter - a.outflow_diameter) * smooth_step(z, -0.7 * a.outflow_length, 0);
  radius += 0.5 * (a.junction_diameter - a.annulus_diameter) * smooth_step(z, 0, a.junction_height);
  radius +=
      0.5 * (a.ascending_diameter - a.junction_diameter) * smooth_step(z, a.junction_height, a.junction_height + 0.8 * a.ascending_length);
  return radius;
}

double lowest(const SyntheticAorta& a) { return -(a.outflow_length + a.extension); }
double highest(const SyntheticAorta& a) { return a.junction_height + a.ascending_length + a.extension; }

TriangleMesh make_lumen(const SyntheticAorta& a) {
  const double low = lowest(a), high = highest(a);
  const int around = 3 * int(std::ceil(pi * a.sinus_diameter / a.spacing / 3));
  const int along = int(std::ceil((high - low) / a.spacing));
  TriangleMesh mesh;
  for (int i = 0; i <= along; ++i) {
    const double z = low + (high - low) * i / along;
    for (int j = 0; j < around; ++j) {
      const double theta = 2 * pi * j / around, r = synthetic_radius(a, theta, z);
      mesh.vertices.emplace_back(r * std::cos(theta), r * std::sin(theta), z);
    }
  }
  const auto at = [&](int i, int j) { return std::int32_t(i * around + j % around); };
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < around; ++j) {
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  // Flat ends: rings towards the middle, so that no triangle is a sliver.
  for (const bool top : {false, true}) {
    const double z = top ? high : low;
    const double radius = synthetic_radius(a, 0, z);
    const int rings = std::max(2, int(radius / a.spacing / 3));
    std::int32_t outer = at(top ? along : 0, 0);
    const auto triangle = [&](std::int32_t p, std::int32_t q, std::int32_t r) {
      if (top)
        mesh.triangles.push_back({p, q, r});
      else
        mesh.triangles.push_back({p, r, q});
    };
    for (int ring = rings - 1; ring >= 1; --ring) {
      const auto inner = std::int32_t(mesh.vertices.size());
      for (int j = 0; j < around; ++j) {
        const double theta = 2 * pi * j / around, r = radius * ring / rings;
        mesh.vertices.emplace_back(r * std::cos(theta), r * std::sin(theta), z);
      }
      for (int j = 0; j < around; ++j) {
        const int next = (j + 1) % around;
        triangle(outer + j, outer + next, inner + next);
        triangle(outer + j, inner + next, inner + j);
      }
      outer = inner;
    }
    mesh.vertices.emplace_back(0, 0, z);
    for (int j = 0; j < around; ++j) triangle(outer + j, outer + (j + 1) % around, std::int32_t(mesh.vertices.size()) - 1);
  }
  return mesh;
}

// Mean diameter of the section at height z, and the largest and smallest width.
RootPlane section_plane(const SyntheticAorta& a, double z) {
  RootPlane plane;
  plane.center = {0, 0, z};
  constexpr int steps = 720;
  double area = 0;
  std::vector<double> r(steps);
  for (int j = 0; j < steps; ++j) {
    r[j] = synthetic_radius(a, 2 * pi * j / steps, z);
    area += 0.5 * r[j] * r[j] * 2 * pi / steps;
  }
  plane.mean_diameter = 2 * std::sqrt(area / pi);
  // Extent of the section along a direction, over all points of its outline.
  const auto width = [&](double direction) {
    double least = 0, most = 0;
    for (int j = 0; j < steps; ++j) {
      const double along = r[j] * std::cos(2 * pi * j / steps - direction);
      least = std::min(least, along);
      most = std::max(most, along);
    }
    return most - least;
  };
  double best = 0;
  for (int j = 0; j < 180; ++j)
    if (width(pi * j / 180) > plane.largest_diameter) plane.largest_diameter = width(best = pi * j / 180);
  plane.perpendicular_diameter = width(best + 0.5 * pi);
  return plane;
}

}  // namespace

double synthetic_radius(const SyntheticAorta& a, double theta, double z) {
  const double bare = bare_radius(a, z);
  // A section's sinus-to-commissure width is 2 bare + bulge: the way the published diameters are taken.
  const double bulge = a.sinus_diameter - 2 * bare_radius(a, a.sinus_height);
  const double lobe = 0.5 * (1 - std::cos(3 * (theta - a.first_commissure)));
  const double fade = smooth_step(z, -0.3 * a.junction_height, 0) * (1 - smooth_step(z, a.junction_height, 1.3 * a.junction_height));
  return bare + bulge * lobe * fade * sinus_profile(z / a.junction_height, a.sinus_height / a.junction_height);
}

SyntheticPatient make_synthetic_patient(const SyntheticAorta& a) {
  SyntheticPatient patient;
  patient.lumen = make_lumen(a);
  AorticRoot& root = patient.root;
  root.annulus = section_plane(a, 0);
  root.sinuses = section_plane(a, a.sinus_height);
  root.sinotubular_junction = section_plane(a, a.junction_height);
  for (int i = 0; i < 3; ++i) {
    const double commissure = a.first_commissure + 2 * pi * i / 3, nadir = commissure + pi / 3;
    const double z = a.junction_height - a.commissure_drop, r = synthetic_radius(a, commissure, z), base = synthetic_radius(a, nadir, 0);
    root.commissures[i] = {r * std::cos(commissure), r * std::sin(commissure), z};
    root.nadirs[i] = {base * std::cos(nadir), base * std::sin(nadir), 0};
  }
  patient.frame = make_root_frame(root);
  for (const bool top : {false, true}) {
    DomainPort port;
    port.name = top ? "aorta" : "ventricle";
    port.point = {0, 0, top ? highest(a) : lowest(a)};
    port.normal = {0, 0, top ? 1.0 : -1.0};
    port.radius = synthetic_radius(a, 0, port.point.z());
    port.area = pi * port.radius * port.radius;
    patient.ports.push_back(port);
  }
  return patient;
}

}  // namespace geometry
