// The same run again with something changed: what `cusp replay` and the window's Replay do.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/run_case.h"
#include "app/scene_file.h"
#include "sim/run_file.h"

namespace app {

// The scene that a run file was made from, with `settings` on top; its relative paths start where they started then.
SceneFile scene_of_run(const std::filesystem::path& run, const sim::RunHeader& header, const std::vector<std::string>& settings);

// Whether a setting "key=value" changes where particles lie (mesh, template, placement); stiffness, pressures, times and the like do not.
// Keys that are not known to be harmless count as changing it.
bool moves_particles(const std::string& setting);

// One figure of several runs of a valve: "largest orifice", in a unit people use.
struct ComparedFigure {
  std::string name, units;
  std::vector<double> values;  // one a run; NaN where a run lacks it
};
// Orifice, opening and closing, stress open and closed, leak, speed, time spent: what the runs' series hold of it. Where one of them is a
// dry preview: the closed valve alone. Runs without a valve: the last value of every column in which they differ.
std::vector<ComparedFigure> compare_runs(const std::vector<const sim::RunReader*>& runs);
// The table as text: a heading of `names`, one line a figure, with the change of the last run against the first.
std::string comparison_text(const std::vector<ComparedFigure>& figures, const std::vector<std::string>& names);
nlohmann::json comparison_json(const std::vector<ComparedFigure>& figures, const std::vector<std::string>& names);

// "KEY=V1,V2,V3" as one setting for each value. Throws SceneError where there is no value.
std::vector<std::string> spelt_out_settings(const std::string& vary);

}  // namespace app
