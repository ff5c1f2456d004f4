// The clinical figures of a run beside the corridors they are held against: for info, report, export and sweep.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/valve_summary.h"

namespace app {

struct Corridor {  // one row of assets/corridors/valve.csv
  std::string figure, unit, kind, source;
  double factor = 1;                // from SI to `unit`
  std::optional<double> low, high;  // in `unit`
};
// Throws std::runtime_error where the file is missing or a row is no corridor.
std::vector<Corridor> read_corridors(const std::filesystem::path& file);

enum class Verdict { none, inside, borderline, below, above };  // borderline: outside, but not by more than the uncertainty
// none where there is no corridor, no value, or the corridor is for orientation only.
Verdict verdict(const sim::Figure& figure, const Corridor& corridor);

struct ClinicalFigures {
  sim::ValveSeries series;
  sim::ValveSummary summary;
  std::vector<Corridor> corridors;  // one a figure of the summary, in its order
  double period = 0;                // s
};
// Of a run file that holds a valve; none of one that does not. The heart rate and the blood come from the scene in it.
std::optional<ClinicalFigures> clinical_figures(const sim::RunReader& run, const std::filesystem::path& file);

nlohmann::json clinical_json(const ClinicalFigures& figures);
// The table as text, one line a figure: value, uncertainty, unit, corridor, verdict; warnings beneath.
std::string clinical_text(const ClinicalFigures& figures);

inline constexpr const char* standing_notice = "for planning research, not for clinical decisions";

}  // namespace app
