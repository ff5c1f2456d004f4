// The valve of a run as a model for the report: leaflets coloured by stress when open, closed and most stressed, within the vessel.
#include "app/report_model.h"

#include <algorithm>

#include "app/base64.h"
#include "app/glb.h"
#include "app/make_frame.h"
#include "app/movie.h"
#include "app/valve_moments.h"

namespace app {
namespace {

GlbSurface leaflet(const sim::RunFrame& frame, const sim::RunHeader::ShellInfo& shell, const std::string& name) {
  GlbSurface surface;
  surface.name = name;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (frame.body[i] != shell.body || frame.kind[i] != static_cast<std::uint8_t>(sim::Kind::shell)) continue;
    const auto& p = frame.position[i];
    surface.points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
    surface.value.push_back(frame.von_mises[i]);
  }
  for (const auto& element : shell.elements)
    if (element[2] >= 0) surface.triangles.push_back(element);
  return surface;
}

// The vessel; nothing where it would make the page heavy.
GlbSurface vessel(const sim::RunSurface& lumen) {
  GlbSurface surface;
  surface.name = "vessel", surface.points = lumen.vertices, surface.triangles = lumen.triangles;
  surface.color = Eigen::Vector4f(0.82f, 0.62f, 0.58f, 0.25f);
  return surface;
}

}  // namespace

ReportMoments report_moments(const ClinicalFigures& clinical) {
  const sim::ValveSummary& summary = clinical.summary;
  ReportMoments moments;
  const sim::Curve area = clinical.series.curve("orifice_area"), flow = clinical.series.curve("valve_flow"),
                   stress = clinical.series.curve("leaflet_stress_p99");
  moments.open = moments.closed = sim::largest(area, summary.beat_start, summary.beat_end).time;
  moments.stressed = sim::largest(stress, summary.beat_start, summary.beat_end).time;
  // Open and closed at rest are the pictures' own, within the beat that the figures are of.
  std::vector<double> time, areas, flows;
  for (std::size_t i = 0; i < area.time.size(); ++i) {
    if (area.time[i] < summary.beat_start || area.time[i] > summary.beat_end) continue;
    time.push_back(area.time[i]), areas.push_back(area.value[i]), flows.push_back(sim::value_at(flow, area.time[i]));
  }
  if (const auto found = valve_moments(time, areas, flows)) moments.open = found->open, moments.closed = found->closed;
  return moments;
}

nlohmann::json report_model(const sim::RunReader& run, const ReportMoments& moments) {
  constexpr std::size_t heavy = 80000;  // triangles
  std::vector<double> times;
  for (std::size_t k = 0; k < run.frame_count(); ++k) times.push_back(run.frame_time(k));
  std::vector<GlbSurface> surfaces;
  std::vector<GlbScene> scenes;
  const bool with_vessel = !run.header().lumen.triangles.empty() && run.header().lumen.triangles.size() < heavy;
  if (with_vessel) surfaces.push_back(vessel(run.header().lumen));
  const std::vector<sim::RunHeader::ShellInfo> shells = visible_shells(run);
  std::vector<float> values;
  nlohmann::json when = nlohmann::json::array();
  for (const auto& [name, time] :
       {std::pair{"open", moments.open}, std::pair{"closed", moments.closed}, std::pair{"largest stress", moments.stressed}}) {
    const sim::RunFrame frame = run.frame(nearest_frame(times, time));
    GlbScene scene{name, {}};
    for (const sim::RunHeader::ShellInfo& shell : shells) {
      scene.surfaces.push_back(surfaces.size());
      surfaces.push_back(leaflet(frame, shell, run.header().bodies[static_cast<std::size_t>(shell.body)].name + ", " + name));
      values.insert(values.end(), surfaces.back().value.begin(), surfaces.back().value.end());
    }
    if (with_vessel) scene.surfaces.push_back(0);
    scenes.push_back(scene);
    when.push_back(frame.time);
  }
  if (values.empty()) return {};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  const double top = std::max(1e-3, static_cast<double>(*at));
  nlohmann::json model{{"glb", base64(glb_bytes(surfaces, scenes, top))}, {"top", top}, {"times", when}};
  if (run.header().valve) {
    const sim::ValveFrame& valve = *run.header().valve;
    model["center"] = {valve.annulus_center[0], valve.annulus_center[1], valve.annulus_center[2]};
    model["axis"] = {valve.axis[0], valve.axis[1], valve.axis[2]};
    model["radius"] = valve.annulus_radius;
  }
  return model;
}

}  // namespace app
