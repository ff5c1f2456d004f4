// Small run files without a simulation: a made-up valve that opens and closes, and a 2-D scene. What the tests of pictures read.
#pragma once

#include <cmath>
#include <filesystem>

#include "sim/run_file.h"

namespace app::example {

inline constexpr double pi = 3.14159265358979;

inline void add_row(sim::RunFrame& frame, sim::Kind kind, int body, const std::array<double, 3>& p, float pressure, float stress,
                    double speed = 0) {
  frame.id.push_back(static_cast<std::int64_t>(frame.id.size()));
  frame.kind.push_back(static_cast<std::uint8_t>(kind));
  frame.body.push_back(body);
  frame.position.push_back(p);
  frame.velocity.push_back({0, 0, static_cast<float>(speed)});
  frame.pressure.push_back(pressure);
  frame.stress.push_back({});
  frame.von_mises.push_back(stress);
  frame.principal_stress.push_back(1.1f * stress);
}

// A tube of radius 12 mm along z with three leaflets, which are open (1) at half of the run and closed (0) at its ends.
inline void write_valve_run(const std::filesystem::path& file, int frames = 9, double stress = 3e5,
                            const std::string& title = "Example valve") {
  constexpr int columns = 12, rows = 8, around = 48;
  constexpr double radius = 0.012, spacing = 0.0015;
  sim::RunHeader header;
  header.title = title;
  header.scheme = "accurate";
  header.spacing = spacing;
  header.end = 0.8;
  header.output = 0.8 / (frames - 1);
  header.ports = {"ventricle", "aorta"};
  const int per_leaflet = (columns + 1) * (rows + 1);
  sim::ValveFrame valve;
  valve.annulus_center = {0, 0, 0};
  valve.axis = {0, 0, 1};
  valve.annulus_radius = valve.commissure_radius = radius;
  valve.commissure_height = 0.014;
  valve.leaflet_bodies = {0, 1, 2};
  valve.ventricle_port = 0;
  valve.aorta_port = 1;
  header.valve = valve;
  for (int k = 0; k < 3; ++k) {
    header.bodies.push_back(
        {"leaflet " + std::to_string(k + 1), sim::Kind::shell, k * per_leaflet, per_leaflet, 1060, 1e6, 0.45, 0.5e-3, "neo-hookean"});
    sim::RunHeader::ShellInfo shell{k, {}};
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
        shell.elements.push_back({a, b, d});
        shell.elements.push_back({a, d, c});
      }
    header.shells.push_back(shell);
  }
  header.bodies.push_back({"blood", sim::Kind::fluid, 3 * per_leaflet, 1, 1060, 0, 0, 0, "newtonian"});
  for (int j = 0; j <= 30; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * i / around;
      header.lumen.vertices.push_back({static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)),
                                       static_cast<float>(-0.015 + 0.0017 * j)});
      const int a = j * around + i, b = j * around + (i + 1) % around;
      if (j < 30) {
        header.lumen.triangles.push_back({a, b, b + around});
        header.lumen.triangles.push_back({a, b + around, a + around});
      }
    }
  header.columns = {
      "time", "maximum_speed", "port.ventricle.flow", "port.ventricle.pressure", "port.aorta.flow", "port.aorta.pressure", "orifice_area"};
  header.units = {"s", "m/s", "m3/s", "Pa", "m3/s", "Pa", "m2"};
  sim::RunWriter writer = sim::RunWriter::create(file, header);
  for (int n = 0; n < frames; ++n) {
    sim::RunFrame frame;
    frame.time = 0.8 * n / (frames - 1);
    const double opening = std::sin(pi * frame.time / 0.8);
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
          const double t = 2.0 * i / columns - 1, s = static_cast<double>(j) / rows, middle = 2 * pi * k / 3, angle = middle + t * pi / 3;
          const double base = 0.013 * t * t, lean = middle + (t < 0 ? -1 : 1) * pi / 3, reach = radius * std::abs(t);
          const double x = opening * 0.85 * radius * std::cos(angle) + (1 - opening) * reach * std::cos(lean);
          const double y = opening * 0.85 * radius * std::sin(angle) + (1 - opening) * reach * std::sin(lean);
          const double z = 0.010 + 0.004 * (opening + (1 - opening) * t * t);
          add_row(frame, sim::Kind::shell, k,
                  {radius * std::cos(angle) * (1 - s) + x * s, radius * std::sin(angle) * (1 - s) + y * s, base * (1 - s) + z * s}, 0,
                  static_cast<float>(stress * (1 - 0.7 * s)));
        }
    for (double z = -0.012; z < 0.033; z += spacing)
      for (double y = -radius; y < radius; y += spacing)
        for (double x = -radius; x < radius; x += spacing)
          if (std::hypot(x, y) < radius - 0.5 * spacing)
            add_row(frame, sim::Kind::fluid, 3, {x, y, z}, static_cast<float>(12000 + 4000 * opening - 1e5 * z), 0, opening);
    writer.add_frame(frame);
    writer.add_row({frame.time, opening, 4e-4 * opening, 1000 + 15000 * opening, 0, 10000 + 4000 * opening, 4e-4 * opening * opening}, {});
  }
  writer.add_warning("stress above the law's validity at 3 particles");
  writer.set_status("finished", 1, 10);
  writer.finish();
}

// Water beside a bent beam (shell) and an elastic block, in a walled box: 2-D.
inline void write_flat_run(const std::filesystem::path& file, int frames = 3) {
  constexpr double spacing = 0.05;
  sim::RunHeader header;
  header.title = "Water and a beam";
  header.scheme = "accurate";
  header.dimension = 2;
  header.spacing = spacing;
  header.end = 1;
  header.output = 1.0 / (frames - 1);
  header.bodies = {{"block", sim::Kind::elastic, 0, 36, 1000, 1e6, 0.3, 0, "linear"},
                   {"beam", sim::Kind::shell, 36, 11, 1000, 1e6, 0.3, 0.04, "linear"},
                   {"tank", sim::Kind::wall, 47, 50, 0, 0, 0, 0, ""},
                   {"water", sim::Kind::fluid, 97, 200, 1000, 0, 0, 0, "newtonian"}};
  sim::RunHeader::ShellInfo shell{1, {}};
  for (int i = 9; i >= 0; --i) shell.elements.push_back({i + 1, i, -1});
  header.shells = {shell};
  header.columns = {"time", "tip.x", "tip.y", "maximum_speed"};
  header.units = {"s", "m", "m", "m/s"};
  sim::RunWriter writer = sim::RunWriter::create(file, header);
  for (int n = 0; n < frames; ++n) {
    sim::RunFrame frame;
    frame.time = static_cast<double>(n) / (frames - 1);
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        add_row(frame, sim::Kind::elastic, 0, {1.6 + spacing * i, spacing * (j + 0.5), 0}, 0, static_cast<float>(1e4 * i));
    for (int i = 0; i <= 10; ++i)
      add_row(frame, sim::Kind::shell, 1, {1.2 + 0.1 * frame.time * i * i / 100, 0.05 * i, 0}, 0, static_cast<float>(5e4 - 5e3 * i));
    for (int i = 0; i < 50; ++i) add_row(frame, sim::Kind::wall, 2, {spacing * (i + 0.5) - 0.2, -0.5 * spacing, 0}, 0, 0);
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 20; ++i)
        add_row(frame, sim::Kind::fluid, 3, {spacing * (i + 0.5), spacing * (j + 0.5), 0},
                static_cast<float>(9810 * (0.5 - spacing * (j + 0.5))), 0);
    writer.add_frame(frame);
    writer.add_row({frame.time, 0.1 * frame.time, 0, 0}, {});
  }
  writer.set_status("finished", 1, 10);
  writer.finish();
}

}  // namespace app::example
