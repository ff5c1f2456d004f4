#include "app/view_knobs.h"

#include <cstdio>

namespace app {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string spot_text(const StiffSpot& spot) {
  return "{ region = { type = \"sphere\", center = [" + number(spot.center.x()) + ", " + number(spot.center.y()) + ", " +
         number(spot.center.z()) + "], radius = " + number(spot.radius) + " }, scale = " + number(spot.scale) + " }";
}

const BodySpec* leaflets_of(const SceneFile& scene) {
  for (const BodySpec& body : scene.bodies)
    if (body.kind == sim::Kind::elastic || body.kind == sim::Kind::shell) return &body;
  return nullptr;
}

}  // namespace

Knobs knobs_of(const SceneFile& scene) {
  Knobs knobs;
  if (const BodySpec* leaflets = leaflets_of(scene)) {
    knobs.youngs_modulus = leaflets->elastic.youngs_modulus;
    knobs.poisson_ratio = leaflets->elastic.poisson_ratio;
    if (leaflets->elastic.thickness > 0) knobs.thickness = leaflets->elastic.thickness;
  }
  if (scene.patient) {
    knobs.heart_rate = scene.patient->heart_rate;
    if (const WaveSpec& wave = scene.patient->ventricle_pressure; wave.systolic) knobs.ventricle_systolic = *wave.systolic;
    if (const WaveSpec& wave = scene.patient->aortic_pressure; wave.systolic)
      knobs.aortic_systolic = *wave.systolic, knobs.aortic_diastolic = *wave.diastolic;
  }
  return knobs;
}

std::vector<std::string> knob_settings(const Knobs& start, const Knobs& now) {
  std::vector<std::string> settings;
  const auto add = [&](const std::string& key, double before, double after) {
    if (before != after) settings.push_back(key + "=" + number(after));
  };
  const std::string material = "body.leaflets.material.";
  add(material + "youngs_modulus", start.youngs_modulus, now.youngs_modulus);
  add(material + "poisson_ratio", start.poisson_ratio, now.poisson_ratio);
  add(material + "thickness", start.thickness, now.thickness);
  add("patient.heart_rate", start.heart_rate, now.heart_rate);
  if (now.own_pressures) {
    settings.push_back("patient.ventricle_pressure={ systolic = " + number(now.ventricle_systolic) + ", diastolic = 1000 }");
    settings.push_back("patient.aortic_pressure={ systolic = " + number(now.aortic_systolic) +
                       ", diastolic = " + number(now.aortic_diastolic) + " }");
  }
  if (!now.spots.empty()) {
    std::string list;
    for (const StiffSpot& spot : now.spots) list += (list.empty() ? "" : ", ") + spot_text(spot);
    settings.push_back("body.leaflets.stiffness_map=[" + list + "]");
  }
  return settings;
}

std::string knobs_text(const Knobs& start, const Knobs& now) {
  std::string text;
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : ", ") + words; };
  if (now.youngs_modulus != start.youngs_modulus)
    add("leaflets " + shown(now.youngs_modulus / 1e6) + " MPa (was " + shown(start.youngs_modulus / 1e6) + ")");
  if (now.poisson_ratio != start.poisson_ratio) add("Poisson's ratio " + shown(now.poisson_ratio));
  if (now.thickness != start.thickness) add(shown(1e3 * now.thickness) + " mm thick (was " + shown(1e3 * start.thickness) + ")");
  if (now.heart_rate != start.heart_rate) add(shown(now.heart_rate) + " beats a minute");
  if (now.own_pressures) add("own pressures");
  if (!now.spots.empty()) add(std::to_string(now.spots.size()) + (now.spots.size() == 1 ? " stiff spot" : " stiff spots"));
  return text.empty() ? "nothing changed" : text;
}

}  // namespace app
