#include "app/clinical.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "app/assets.h"
#include "app/scene_file.h"

namespace app {
namespace {

// Fields of a CSV line; "..." may hold commas.
std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::optional<double> number(const std::string& text) { return text.empty() ? std::nullopt : std::optional<double>(std::stod(text)); }

struct SceneFacts {
  double period = 0;  // s
  sim::Rheology blood = sim::Newtonian{3.5e-3};
};

// Heart rate and blood of the scene that the run was made of. A scene that can no longer be read (its mesh was moved) leaves the defaults:
// the whole run is one beat, blood has 3.5 mPa s.
SceneFacts scene_facts(const sim::RunHeader& header, const std::filesystem::path& file) {
  SceneFacts facts;
  try {
    const SceneFile scene =
        parse_scene_text(header.scene_text, file.parent_path() / header.scene_folder / header.scene_name, header.settings);
    if (scene.patient) facts.period = 60 / scene.patient->heart_rate;
    for (const BodySpec& body : scene.bodies)
      if (body.kind == sim::Kind::fluid) facts.blood = body.fluid.rheology;
  } catch (const std::exception&) {
  }
  return facts;
}

const char* verdict_word(Verdict one) {
  static const char* const words[] = {"", "inside", "borderline", "below", "above"};
  return words[static_cast<int>(one)];
}

std::string format(const char* pattern, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, pattern, value);
  return buffer;
}

std::string corridor_text(const Corridor& corridor) {
  if (corridor.low && corridor.high) return format("%g", *corridor.low) + " – " + format("%g", *corridor.high);
  if (corridor.high) return "< " + format("%g", *corridor.high);
  return corridor.low ? "> " + format("%g", *corridor.low) : "";
}

nlohmann::json or_null(double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(); }

}  // namespace

std::vector<Corridor> read_corridors(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  std::vector<Corridor> corridors;
  std::string line;
  for (bool heading = true; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (std::exchange(heading, false)) continue;
    const std::vector<std::string> field = split(line);
    if (field.size() != 7) throw std::runtime_error(file.string() + ": no corridor: " + line);
    corridors.push_back({field[0], field[1], field[5], field[6], std::stod(field[2]), number(field[3]), number(field[4])});
  }
  return corridors;
}

Verdict verdict(const sim::Figure& figure, const Corridor& corridor) {
  if ((!corridor.low && !corridor.high) || corridor.kind == "orientation" || !std::isfinite(figure.value)) return Verdict::none;
  const double value = figure.value * corridor.factor;
  const double margin = std::isfinite(figure.uncertainty) ? figure.uncertainty * corridor.factor : 0;
  if (corridor.low && value < *corridor.low) return value + margin < *corridor.low ? Verdict::below : Verdict::borderline;
  if (corridor.high && value > *corridor.high) return value - margin > *corridor.high ? Verdict::above : Verdict::borderline;
  return Verdict::inside;
}

std::optional<ClinicalFigures> clinical_figures(const sim::RunReader& run, const std::filesystem::path& file) {
  if (!run.header().valve || run.header().shells.empty() || run.frame_count() == 0) return std::nullopt;
  const SceneFacts facts = scene_facts(run.header(), file);
  ClinicalFigures result;
  result.series = sim::valve_series(run, facts.blood);
  const sim::SummaryOptions options = sim::summary_options(run.header(), facts.period);
  result.period = options.period;
  result.summary = sim::summarise_valve(result.series, options);
  const std::vector<Corridor> known = read_corridors(asset("corridors/valve.csv"));
  for (const sim::Figure& figure : result.summary.figures) {
    Corridor found{figure.key, figure.units, "", "", 1, {}, {}};
    for (const Corridor& corridor : known)
      if (corridor.figure == figure.key) found = corridor;
    result.corridors.push_back(found);
  }
  return result;
}

nlohmann::json clinical_json(const ClinicalFigures& figures) {
  nlohmann::json json{{"beats", figures.summary.beats},
                      {"beat", {figures.summary.beat_start, figures.summary.beat_end}},
                      {"warnings", figures.summary.warnings},
                      {"notice", standing_notice}};
  for (std::size_t k = 0; k < figures.summary.figures.size(); ++k) {
    const sim::Figure& figure = figures.summary.figures[k];
    const Corridor& corridor = figures.corridors[k];
    nlohmann::json one{{"key", figure.key},
                       {"label", figure.label},
                       {"units", figure.units},
                       {"value", or_null(figure.value)},
                       {"uncertainty", or_null(figure.uncertainty)},
                       {"time", or_null(figure.time)},
                       {"note", figure.note},
                       {"warnings", figure.warnings},
                       {"display_unit", corridor.unit},
                       {"factor", corridor.factor},
                       {"kind", corridor.kind},
                       {"source", corridor.source},
                       {"verdict", verdict_word(verdict(figure, corridor))}};
    one["low"] = corridor.low ? nlohmann::json(*corridor.low) : nlohmann::json();
    one["high"] = corridor.high ? nlohmann::json(*corridor.high) : nlohmann::json();
    json["figures"].push_back(one);
  }
  for (const sim::LeafletStress& stress : figures.summary.leaflets)
    json["leaflets"].push_back({{"leaflet", stress.leaflet},
                                {"region", sim::region_name(stress.region)},
                                {"von_mises", stress.von_mises},
                                {"von_mises_time", stress.von_mises_time},
                                {"principal", stress.principal},
                                {"principal_time", stress.principal_time}});
  return json;
}

std::string clinical_text(const ClinicalFigures& figures) {
  std::string text;
  char line[512];
  for (std::size_t k = 0; k < figures.summary.figures.size(); ++k) {
    const sim::Figure& figure = figures.summary.figures[k];
    const Corridor& corridor = figures.corridors[k];
    const std::string value = std::isfinite(figure.value) ? format("%.4g", figure.value * corridor.factor) : "-";
    const std::string spread = std::isfinite(figure.uncertainty) ? "± " + format("%.2g", figure.uncertainty * corridor.factor) : "";
    std::snprintf(line, sizeof line, "  %-66s %9s %-10s %-5s", figure.label.c_str(), value.c_str(), spread.c_str(), corridor.unit.c_str());
    text += line;
    const std::string bounds = corridor_text(corridor), word = verdict_word(verdict(figure, corridor));
    if (!bounds.empty())
      text += "  [" + bounds + (corridor.kind == "orientation" ? ", orientation" : ": " + (word.empty() ? "-" : word)) + "]";
    if (std::isfinite(figure.time)) text += "  at " + format("%.3f s", figure.time);
    if (!figure.note.empty()) text += ", " + figure.note;
    text += "\n";
    for (const std::string& warning : figure.warnings) text += "      warning: " + warning + "\n";
  }
  text += "  stress of leaflets, largest over the beat, kPa (von Mises / principal):\n";
  for (const sim::LeafletStress& stress : figures.summary.leaflets) {
    std::snprintf(line, sizeof line, "    leaflet %d  %-11s %8.1f at %.3f s / %8.1f at %.3f s\n", stress.leaflet,
                  sim::region_name(stress.region), 1e-3 * stress.von_mises, stress.von_mises_time, 1e-3 * stress.principal,
                  stress.principal_time);
    text += line;
  }
  for (const std::string& warning : figures.summary.warnings) text += "  warning: " + warning + "\n";
  return text + "  " + standing_notice + "\n";
}

}  // namespace app
