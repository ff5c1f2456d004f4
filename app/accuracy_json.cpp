// A study as accuracy.json and back.
#include <cmath>
#include <limits>
#include <stdexcept>

#include "app/accuracy.h"

namespace app {
namespace {

using nlohmann::json;

json numbers(const std::vector<double>& values) {  // JSON has no NaN
  json list = json::array();
  for (double value : values) list.push_back(std::isfinite(value) ? json(value) : json(nullptr));
  return list;
}

std::vector<double> numbers_of(const json& list) {
  std::vector<double> values;
  for (const json& one : list) values.push_back(one.is_number() ? one.get<double>() : std::numeric_limits<double>::quiet_NaN());
  return values;
}

json point_json(const AccuracyPoint& p) {
  return {{"curve", p.curve},
          {"value", p.value},
          {"settings", p.settings},
          {"threads", p.threads},
          {"spacing", p.spacing},
          {"scene_itself", p.scene_itself},
          {"wall_seconds", numbers(p.wall)},
          {"processor_seconds", numbers(p.processor)},
          {"steps", p.steps},
          {"particles", p.particles},
          {"particle_steps", p.particle_steps()},
          {"pressure_products", p.pressure_products},
          {"elastic_substeps", p.elastic_substeps},
          {"peak_memory", p.peak_memory},
          {"error", numbers(p.error)},
          {"change", numbers(p.change)}};
}

AccuracyPoint point_of(const json& j) {
  AccuracyPoint p;
  j.at("curve").get_to(p.curve), j.at("value").get_to(p.value), j.at("settings").get_to(p.settings), j.at("threads").get_to(p.threads);
  j.at("spacing").get_to(p.spacing), j.at("scene_itself").get_to(p.scene_itself), j.at("steps").get_to(p.steps);
  j.at("particles").get_to(p.particles), j.at("pressure_products").get_to(p.pressure_products);
  j.at("elastic_substeps").get_to(p.elastic_substeps), j.at("peak_memory").get_to(p.peak_memory);
  p.wall = numbers_of(j.at("wall_seconds")), p.processor = numbers_of(j.at("processor_seconds"));
  p.error = numbers_of(j.at("error")), p.change = numbers_of(j.at("change"));
  return p;
}

// What is read off the points: for scripts, so that nobody has to fit again.
json findings(const AccuracyStudy& study) {
  json all = json::object();
  const std::vector<std::size_t> ladder = ladder_of(study);
  for (int q = -1; q < static_cast<int>(study.quantities.size()); ++q) {
    json one;
    const CostError points = cost_and_error(study, q);
    const std::vector<std::size_t> front = pareto_front(points.cost, points.error);
    std::vector<double> cost, error, spacing, ladder_error;
    for (std::size_t k : front) cost.push_back(points.cost[k]), error.push_back(points.error[k]);
    one["front"] = front;
    for (const double wanted : {0.05, 0.02, 0.01}) {
      const auto reached = cost_to_reach(cost, error, wanted);
      one["cost_to_reach"].push_back({{"error", wanted}, {"seconds", reached ? json(*reached) : json("not reached")}});
    }
    for (std::size_t k : ladder)
      if (std::isfinite(points.error[k])) spacing.push_back(study.points[k].spacing), ladder_error.push_back(points.error[k]);
    const auto order = observed_order(spacing, ladder_error);
    one["order"] = order ? json{{"exponent", order->exponent}, {"scatter", order->scatter}} : json("no order");
    const auto factor = default_over_front(study, q);
    one["default_over_front"] = factor ? json(*factor) : json(nullptr);
    all[q < 0 ? "worst" : study.quantities[static_cast<std::size_t>(q)]] = one;
  }
  return all;
}

}  // namespace

nlohmann::json study_json(const AccuracyStudy& study) {
  json j{{"title", study.title},
         {"scene", study.scene},
         {"signature", study.signature},
         {"against", study.against},
         {"against_finest", study.against_finest},
         {"patient", study.patient},
         {"static", study.statics},
         {"dimension", study.dimension},
         {"threads", study.threads},
         {"end", study.end},
         {"calibration_microseconds", study.calibration},
         {"clock", study.clock == CostClock::wall ? "wall" : "processor"},
         {"quantities", study.quantities},
         {"sources", study.sources},
         {"uncertainty", numbers(study.uncertainty)},
         {"noise", numbers(study.noise)},
         {"left_out", study.left_out},
         {"points", json::array()},
         {"findings", findings(study)}};
  for (const AccuracyPoint& point : study.points) j["points"].push_back(point_json(point));
  for (const FreeKnob& knob : free_knobs(study))
    j["free_knobs"].push_back({{"curve", knob.curve}, {"value", knob.value}, {"cost_factor", knob.cost_factor}});
  return j;
}

AccuracyStudy study_from_json(const nlohmann::json& j) {
  if (!j.is_object()) throw std::runtime_error("is no study of accuracy");
  try {
    AccuracyStudy study;
    j.at("title").get_to(study.title), j.at("scene").get_to(study.scene), j.at("signature").get_to(study.signature);
    j.at("against").get_to(study.against), j.at("against_finest").get_to(study.against_finest), j.at("patient").get_to(study.patient);
    j.at("static").get_to(study.statics), j.at("dimension").get_to(study.dimension), j.at("threads").get_to(study.threads);
    j.at("end").get_to(study.end), j.at("calibration_microseconds").get_to(study.calibration);
    study.clock = j.at("clock") == "processor" ? CostClock::processor : CostClock::wall;
    j.at("quantities").get_to(study.quantities), j.at("sources").get_to(study.sources), j.at("left_out").get_to(study.left_out);
    study.uncertainty = numbers_of(j.at("uncertainty")), study.noise = numbers_of(j.at("noise"));
    for (const json& point : j.at("points")) study.points.push_back(point_of(point));
    return study;
  } catch (const json::exception&) {
    throw std::runtime_error("is no study of accuracy that this version wrote");
  }
}

}  // namespace app
