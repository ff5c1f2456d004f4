#include "app/replay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <regex>
#include <sstream>
#include <tuple>

#include "app/valve_moments.h"

namespace app {

SceneFile scene_of_run(const std::filesystem::path& run, const sim::RunHeader& header, const std::vector<std::string>& settings) {
  std::vector<std::string> all = header.settings;
  all.insert(all.end(), settings.begin(), settings.end());
  return parse_scene_text(header.scene_text, run.parent_path() / header.scene_folder / header.scene_name, all);
}

bool moves_particles(const std::string& setting) {
  static const std::regex harmless(
      "(body\\.[^.]+\\.(material\\.(youngs_modulus|poisson_ratio|law|density|damping|fibre_[a-z]+|viscosity|rheology|hematocrit|"
      "consistency|"
      "index|yield_stress)|stiffness_map.*)"
      "|patient\\.(valve\\.(youngs_modulus|poisson_ratio|law|density|damping|fibre_[a-z]+)|heart_rate|ventricle_pressure.*|aortic_pressure."
      "*|"
      "blood\\..*)"
      "|(time|scheme|limits|load|probe|gravity)\\..*|title)");
  return !std::regex_match(setting.substr(0, setting.find('=')), harmless);
}

std::vector<std::string> spelt_out_settings(const std::string& vary) {
  const auto equals = vary.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == vary.size())
    throw SceneError("--vary '" + vary + "': has no values; write KEY=V1,V2, as in body.leaflets.material.youngs_modulus=0.5e6,1e6,2e6");
  std::vector<std::string> settings;
  std::stringstream values(vary.substr(equals + 1));
  for (std::string value; std::getline(values, value, ',');) settings.push_back(vary.substr(0, equals) + "=" + value);
  return settings;
}

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double median(std::vector<double> values) {
  if (values.empty()) return none;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// One run's series and the moments of its valve.
struct Beat {
  const sim::RunReader& run;
  std::vector<double> time;
  ValveMoments moments;

  // Values of a column within [from, to]; empty where there is no such column.
  std::vector<double> within(const std::string& column, double from, double to) const {
    const std::vector<double> all = run.column(column);
    std::vector<double> values;
    for (std::size_t i = 0; i < all.size() && i < time.size(); ++i)
      if (time[i] >= from && time[i] <= to && std::isfinite(all[i])) values.push_back(all[i]);
    return values;
  }
  // The middle half of the open phase, and the closed one without its first quarter.
  double while_open(const std::string& column) const {
    const double quarter = 0.25 * (moments.closing - moments.opened);
    return median(within(column, moments.opened + quarter, moments.closing - quarter));
  }
  double while_closed(const std::string& column) const {
    return median(within(column, moments.closing + 0.25 * (time.back() - moments.closing), time.back()));
  }
  double largest(const std::string& column) const {
    const std::vector<double> values = within(column, time.front(), time.back());
    return values.empty() ? none : *std::max_element(values.begin(), values.end());
  }
  // m3 that flowed back from the moment of closing on, >= 0 (trapezoidal rule over the reverse part of the flow).
  double flowed_back(const std::string& column) const {
    const std::vector<double> flow = run.column(column);
    if (flow.size() != time.size()) return none;
    double volume = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
      if (time[i - 1] >= moments.closing) volume += 0.5 * (time[i] - time[i - 1]) * (std::max(0.0, -flow[i]) + std::max(0.0, -flow[i - 1]));
    return volume;
  }
};

std::vector<ComparedFigure> figures_of(const Beat& beat) {
  const sim::RunHeader& header = beat.run.header();
  const int port = header.valve->ventricle_port;
  const std::string flow = port >= 0 ? "port." + header.ports.at(static_cast<std::size_t>(port)) + ".flow" : "";
  const bool closes = beat.moments.closing < beat.time.back();
  return {{"largest orifice", "cm2", {1e4 * beat.moments.largest_area}},
          {"opens (half of it) at", "ms", {1e3 * beat.moments.opened}},
          {"closes (half of it) at", "ms", {closes ? 1e3 * beat.moments.closing : none}},
          {"orifice left when closed", "cm2", {closes ? 1e4 * beat.while_closed("orifice_area") : none}},
          {"stress, valve open", "kPa", {1e-3 * beat.while_open("leaflet_stress_p99")}},
          {"stress, valve closed", "kPa", {closes ? 1e-3 * beat.while_closed("leaflet_stress_p99") : none}},
          {"stress, largest", "kPa", {1e-3 * beat.largest("leaflet_stress_p99")}},
          {"blood back after closing", "mL", {closes && !flow.empty() ? 1e6 * beat.flowed_back(flow) : none}},
          {"jet speed, largest", "m/s", {beat.largest("jet_speed")}},
          {"time spent", "s", {beat.run.wall_seconds()}}};
}

bool is_dry(const sim::RunReader& run) { return run.header().valve && run.header().ports.empty(); }

// The closed valve: of a dry run as it is at the end, of a beat the median of its closed phase.
double when_closed(const sim::RunReader& run, const std::string& column) {
  const std::vector<double> values = run.column(column);
  if (values.empty()) return none;
  if (is_dry(run)) return values.back();
  const std::optional<ValveMoments> moments = valve_moments(run);
  return moments ? Beat{run, run.column("time"), *moments}.while_closed(column) : none;
}

// Where a run among them is dry: the closed valve.
std::vector<ComparedFigure> closed_figures(const std::vector<const sim::RunReader*>& runs) {
  const std::tuple<const char*, const char*, const char*, double> wanted[] = {{"leaflet_stress_p99", "stress, valve closed", "kPa", 1e-3},
                                                                              {"orifice_area", "orifice left when closed", "cm2", 1e4},
                                                                              {"coaptation_area", "coaptation area", "cm2", 1e4},
                                                                              {"coaptation_height", "coaptation height", "mm", 1e3}};
  std::vector<ComparedFigure> figures;
  for (const auto& [column, name, units, factor] : wanted) {
    ComparedFigure figure{name, units, {}};
    for (const sim::RunReader* run : runs) figure.values.push_back(factor * when_closed(*run, column));
    figures.push_back(std::move(figure));
  }
  figures.push_back({"time spent", "s", {}});
  for (const sim::RunReader* run : runs) figures.back().values.push_back(run->wall_seconds());
  return figures;
}

std::vector<ComparedFigure> last_values(const std::vector<const sim::RunReader*>& runs) {
  std::vector<ComparedFigure> figures;
  const sim::RunHeader& header = runs.front()->header();
  for (std::size_t c = 1; c < header.columns.size(); ++c) {
    ComparedFigure figure{"last " + header.columns[c], header.units[c], {}};
    for (const sim::RunReader* run : runs) {
      const std::vector<double> column = run->column(header.columns[c]);
      figure.values.push_back(column.empty() ? none : column.back());
    }
    const bool same = std::all_of(figure.values.begin(), figure.values.end(), [&](double v) { return v == figure.values.front(); });
    if (!same) figures.push_back(std::move(figure));
  }
  return figures;
}

std::string value_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::isfinite(value) ? text : "-";
}

double change(const ComparedFigure& figure) { return figure.values.back() - figure.values.front(); }

}  // namespace

std::vector<ComparedFigure> compare_runs(const std::vector<const sim::RunReader*>& runs) {
  if (std::any_of(runs.begin(), runs.end(), [](const sim::RunReader* run) { return is_dry(*run); })) return closed_figures(runs);
  std::vector<Beat> beats;
  for (const sim::RunReader* run : runs)
    if (const std::optional<ValveMoments> moments = valve_moments(*run)) beats.push_back({*run, run->column("time"), *moments});
  if (beats.size() != runs.size()) return last_values(runs);  // no valve, or one that stays shut: nothing to say about a beat
  std::vector<ComparedFigure> all = figures_of(beats.front());
  for (std::size_t r = 1; r < beats.size(); ++r) {
    const std::vector<ComparedFigure> next = figures_of(beats[r]);
    for (std::size_t k = 0; k < all.size(); ++k) all[k].values.push_back(next[k].values.front());
  }
  std::erase_if(all, [](const ComparedFigure& figure) {
    return std::none_of(figure.values.begin(), figure.values.end(), [](double value) { return std::isfinite(value); });
  });
  return all;
}

std::string comparison_text(const std::vector<ComparedFigure>& figures, const std::vector<std::string>& names) {
  std::string text;
  char cell[96];
  const auto add = [&](const char* format, const auto&... values) {
    std::snprintf(cell, sizeof cell, format, values...);
    text += cell;
  };
  add("%-34s", "");
  for (const std::string& name : names) add(" %16.16s", name.c_str());
  add(" %12s\n", "change");
  for (const ComparedFigure& figure : figures) {
    add("%-28.28s %-5.5s", figure.name.c_str(), figure.units.c_str());
    for (const double value : figure.values) add(" %16s", value_text(value).c_str());
    const double part = change(figure) / std::abs(figure.values.front());
    if (std::isfinite(part))
      add(" %+11.1f%%\n", 100 * part);
    else
      add(" %12s\n", value_text(change(figure)).c_str());
  }
  return text;
}

nlohmann::json comparison_json(const std::vector<ComparedFigure>& figures, const std::vector<std::string>& names) {
  nlohmann::json rows = nlohmann::json::array();
  const auto number = [](double value) { return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr); };
  for (const ComparedFigure& figure : figures) {
    nlohmann::json values = nlohmann::json::array();
    for (const double value : figure.values) values.push_back(number(value));
    rows.push_back({{"name", figure.name}, {"units", figure.units}, {"values", values}, {"change", number(change(figure))}});
  }
  return {{"runs", names}, {"figures", rows}};
}

}  // namespace app
