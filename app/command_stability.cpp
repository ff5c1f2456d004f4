#include "app/command_stability.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>

#include "app/assets.h"
#include "app/case_grid.h"
#include "app/scene_table.h"
#include "app/stability_measures.h"
#include "sim/run_file.h"

namespace app {
namespace {

using nlohmann::json;

// What is varied, and what has to hold. Limits are those of the scene's [bounds] unless the cell has its own.
struct Cell {
  std::string name, scene, vary, value, expect;
  std::vector<std::string> set, twin_set;  // twin: a second run that has to end alike
  bool fast = false, twin = false, restart = false;
  bool slow = false;                // run only where it is named
  bool overloaded = false;          // has to be told: the load is more than the law bears
  double speed = infinite;          // m/s, any particle at any row
  double end_speed = infinite;      // m/s at the end (rest)
  double density_error = 0.05;      // rms
  double penetration = 0.5;         // l0
  double energy = 0.05;             // growth beyond the work done, share of the energy that went through; infinite: not judged
  double twin_apart = 1e-6;         // l0, between the runs' last frames
  double leaflet_speed = infinite;  // m/s, any leaflet particle in the last frame
  double repeat = infinite;         // beats_apart of orifice and flow through the valve
  double leak = infinite;           // through the closed valve over the run's second half, share of 70 ml a beat of 0.8 s
};

Cell read_cell(const toml::table& table, const std::string& path) {
  const TableReader reader(table, path,
                           {"name",          "scene", "vary",       "value",         "expect",        "set",         "twin",   "twin_set",
                            "restart",       "fast",  "speed",      "end_speed",     "density_error", "penetration", "energy", "twin_apart",
                            "leaflet_speed", "leak",  "overloaded", "energy_judged", "repeat",        "slow"});
  Cell cell;
  cell.name = reader.text("name"), cell.scene = reader.text("scene"), cell.vary = reader.text("vary"), cell.value = reader.text("value");
  cell.expect = reader.choice("expect", {"holds", "refused"}, "holds");
  if (reader.has("set")) cell.set = reader.texts("set");
  if (reader.has("twin_set")) cell.twin_set = reader.texts("twin_set");
  cell.twin = reader.flag("twin", reader.has("twin_set")), cell.restart = reader.flag("restart", false);
  cell.fast = reader.flag("fast", false), cell.overloaded = reader.flag("overloaded", false);
  cell.slow = reader.flag("slow", false), cell.repeat = reader.number("repeat", positive, cell.repeat);
  cell.leaflet_speed = reader.number("leaflet_speed", positive, cell.leaflet_speed), cell.leak = reader.number("leak", positive, cell.leak);
  cell.speed = reader.number("speed", positive, cell.speed), cell.end_speed = reader.number("end_speed", positive, cell.end_speed);
  cell.density_error = reader.number("density_error", positive, cell.density_error);
  cell.penetration = reader.number("penetration", positive, cell.penetration);
  cell.energy = reader.flag("energy_judged", true) ? reader.number("energy", positive, cell.energy) : infinite;
  cell.twin_apart = reader.number("twin_apart", not_negative, cell.twin_apart);
  return cell;
}

std::vector<Cell> read_cells() {
  const toml::table table = toml::parse_file(asset("scenes/stability/cells.toml").string());
  const TableReader top(table, "", {"cell"});
  std::vector<Cell> cells;
  const auto tables = top.tables("cell");
  for (std::size_t i = 0; i < tables.size(); ++i) cells.push_back(read_cell(*tables[i], entry_path("cell", *tables[i], i)));
  return cells;
}

std::string last_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line, last;
  while (std::getline(stream, line))
    if (!line.empty()) last = line;
  return last;
}

std::string number(double value, int digits = 3) {
  std::ostringstream out;
  out.precision(digits);
  out << value;
  return out.str();
}

// The measured invariants, and what is wrong with them ("" = nothing).
std::string judge(const Cell& cell, const sim::RunReader& run, json& result) {
  const Series series(run);
  const double spacing = run.header().spacing;
  const double penetration = series.last("deepest_penetration") / spacing, error = series.largest("density_error");
  const double speed = series.largest("maximum_speed"), end_speed = series.last("maximum_speed"),
               growth = energy_growth(series, energy_at_rest(run));
  result["steps"] = run.steps(), result["time"] = series.last("time"), result["seconds"] = run.wall_seconds();
  result["refused_steps"] = series.last("refused_steps"), result["limiter_hits"] = series.last("limiter_hits");
  result["particles_lost"] = series.last("particles_lost"), result["penetration_l0"] = penetration;
  result["crossings"] = series.last("sheet_crossings"), result["density_error"] = error, result["largest_speed"] = speed;
  result["end_speed"] = end_speed, result["energy_growth"] = growth;
  std::string wrong;
  const auto bound = [&](const char* what, double value, double limit) {
    if (value > limit || !std::isfinite(value))
      wrong += (wrong.empty() ? "" : "; ") + std::string(what) + " " + number(value) + " over " + number(limit);
  };
  for (std::size_t k = 0; k < run.frame_count(); ++k)
    if (!finite(run.frame(k))) return "a value that is not finite in frame " + std::to_string(k);
  bound("particles lost", series.largest("particles_lost"), 0);
  bound("penetration in l0", penetration, cell.penetration);
  bound("density error", error, std::max(cell.density_error, 1.05 * series.first("density_error")));
  bound("largest speed in m/s", speed, cell.speed);
  bound("speed at the end in m/s", end_speed, cell.end_speed);
  bound("energy growth beyond the work done", growth, cell.energy);
  if (std::isfinite(cell.leaflet_speed)) {
    result["leaflet_speed"] = leaflet_speed(run.frame(run.frame_count() - 1));
    bound("leaflets' speed at the end in m/s", result["leaflet_speed"], cell.leaflet_speed);
  }
  if (std::isfinite(cell.repeat)) {
    constexpr double beat = 0.8;  // s, of the default patient
    result["orifice_repeat"] = beats_apart(series, "orifice_area", beat), result["flow_repeat"] = beats_apart(series, "valve_flow", beat);
    bound("orifice from beat to beat", result["orifice_repeat"], cell.repeat);
    bound("flow from beat to beat", result["flow_repeat"], cell.repeat);
  }
  if (std::isfinite(cell.leak)) {
    result["leak"] = leak(series);
    bound("leak as a share of a stroke", result["leak"], cell.leak);
  }
  return wrong;
}

json evaluate(const Cell& cell, int code, int twin_code, const std::filesystem::path& folder) {
  json result{{"name", cell.name}, {"vary", cell.vary}, {"value", cell.value}, {"scene", cell.scene}, {"status", "fail"}, {"cause", ""}};
  const std::filesystem::path run_file = folder / "run.h5";
  const std::string said = last_line(folder / "log.txt");
  if (code == 2) {
    result["status"] = cell.expect == "refused" ? "refused" : "fail", result["cause"] = said;
    return result;
  }
  try {
    const sim::RunReader run(run_file);
    const std::string wrong = judge(cell, run, result);
    if (run.status() != "finished") {
      const bool no_answer = cell.expect == "refused" && run.status().rfind("failed: ", 0) == 0;
      result["status"] = no_answer ? "refused" : "fail", result["cause"] = run.status();
    } else if (!wrong.empty()) {
      result["cause"] = wrong;
    } else if (code != 0) {
      result["cause"] = "ended with " + std::to_string(code) + ": " + said;
    } else if (cell.expect == "refused") {
      result["cause"] = "was not refused";
    } else if (const std::string told = overload_told(run); !told.empty() || cell.overloaded) {
      result["status"] = told.empty() ? "fail" : "degraded", result["cause"] = told.empty() ? "was not found overloaded" : told;
    } else {
      const bool adapted = result["refused_steps"].get<double>() > 0 || result["limiter_hits"].get<double>() > 0;
      result["status"] = adapted ? "degraded" : "pass";
      if (adapted)
        result["cause"] = number(result["refused_steps"].get<double>(), 9) + " steps taken again smaller, " +
                          number(result["limiter_hits"].get<double>(), 9) + " stretches limited";
    }
    if (cell.twin || cell.restart) {
      const double distance = twin_code == 0 ? apart(run_file, folder / "twin" / "run.h5") / run.header().spacing : infinite;
      result["apart_l0"] = std::isfinite(distance) ? json(distance) : json("not comparable");
      if (!(distance <= cell.twin_apart)) {
        result["status"] = "fail";
        result["cause"] = "ends " + number(distance) + " l0 apart from its twin, over " + number(cell.twin_apart);
      }
    }
  } catch (const std::exception& error) {
    result["cause"] = code < 0 ? "was not started" : "ended with " + std::to_string(code) + ": " + (said.empty() ? error.what() : said);
  }
  return result;
}

std::string upper_fail(const std::string& status) { return status == "fail" ? "FAIL" : status; }

std::string table_row(const json& one) {
  const auto value = [&](const char* name, double scale, const char* units) {
    return one.contains(name) ? number(one[name].get<double>() * scale) + units : std::string();
  };
  const std::string growth = one.contains("energy_growth") ? number(100 * one["energy_growth"].get<double>(), 2) + " %" : "";
  std::string apart_text = one.contains("apart_l0")
                               ? (one["apart_l0"].is_string() ? one["apart_l0"].get<std::string>() : number(one["apart_l0"].get<double>()))
                               : "";
  std::string cause = one["cause"];
  std::replace(cause.begin(), cause.end(), '|', '/');
  return "| " + one["name"].get<std::string>() + " | " + one["vary"].get<std::string>() + " | " + one["value"].get<std::string>() + " | " +
         upper_fail(one["status"]) + " | " + value("steps", 1, "") + " | " + value("time", 1, "") + " | " + value("refused_steps", 1, "") +
         " | " + value("particles_lost", 1, "") + " | " + value("penetration_l0", 1, "") + " | " + value("density_error", 100, " %") +
         " | " + value("largest_speed", 1, "") + " | " + value("end_speed", 1, "") + " | " + growth + " | " + apart_text + " | " + cause +
         " | " + value("seconds", 1, "") + " |\n";
}

void write_report(const json& all, const std::filesystem::path& folder) {
  std::ofstream(folder / "stability.json") << all.dump(2) << "\n";
  std::ofstream md(folder / "stability.md");
  md << "# Stability matrix\n\nWritten by `cusp validate --stability` (version " << CUSP_VERSION << "). Each cell is a small scene of\n"
     << "`assets/scenes/stability` with the settings that `cells.toml` there names; `cusp run SCENE --set …` repeats it.\n\n"
     << "pass: all bounds held and nothing had to be adapted. degraded: held after a named adaptive action. refused: stopped with a "
        "message where\n"
     << "physics has no answer. FAIL: a bound broken, or stopped without that.\n\n";
  md << "In all " << all["cases"].size() << " cells: " << all["counts"]["pass"] << " pass, " << all["counts"]["degraded"] << " degraded, "
     << all["counts"]["refused"] << " refused, " << all["counts"]["fail"] << " FAIL.\n\n"
     << "Columns: steps and simulated time (s) reached; steps refused and taken again smaller; particles lost; deepest place of blood "
        "behind a\n"
     << "leaflet before it was put back (l0); largest rms error of the particle density (bound: 5 % or what it was at the start); largest "
        "speed and speed at the end (m/s); largest "
        "growth\n"
     << "of energy beyond the work done (share of the energy there was, at least that of all blood at 1 cm/s); distance of the last frame "
        "from a twin run's (l0); wall time (s).\n\n"
     << "| cell | varied | value | result | steps | time | refused | lost | penetration | density error | speed | end speed | energy | "
        "twin | cause | wall s "
        "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const json& one : all["cases"]) md << table_row(one);
}

// Runs `cells` (all of one scene) and their twins; exit codes by cell name, twins under "NAME/twin".
void run_cells(const std::vector<const Cell*>& cells, const StabilityOptions& options, std::map<std::string, int>& codes) {
  GridOptions grid;
  grid.scene = asset("scenes/stability/" + cells.front()->scene + ".toml");
  grid.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  grid.threads = 1, grid.quiet = options.quiet;
  const auto pass = [&](const std::vector<GridCase>& cases, const std::vector<std::string>& names, int threads) {
    GridOptions chosen = grid;
    chosen.threads = threads;
    const std::vector<int> found = run_grid(cases, chosen);
    for (std::size_t k = 0; k < names.size(); ++k) codes[names[k]] = found[k];
  };
  std::vector<GridCase> plain, twins, threaded, broken;
  std::vector<std::string> plain_names, twin_names, threaded_names, broken_names;
  for (const Cell* cell : cells) {
    const std::filesystem::path folder = options.output / cell->name;
    plain.push_back({folder, cell->set}), plain_names.push_back(cell->name);
    std::vector<std::string> settings = cell->set;
    settings.insert(settings.end(), cell->twin_set.begin(), cell->twin_set.end());
    const bool more_threads = cell->twin && cell->twin_set.empty();  // a twin without settings of its own differs by its threads
    if (cell->twin || cell->restart) {
      (more_threads ? threaded : twins).push_back({folder / "twin", settings});
      (more_threads ? threaded_names : twin_names).push_back(cell->name + "/twin");
    }
    if (cell->restart) {  // stopped after a moment, then continued by the twins' pass
      settings.push_back("limits.wall_time=0.5");
      broken.push_back({folder / "twin", settings}), broken_names.push_back(cell->name + "/broken");
    }
  }
  pass(plain, plain_names, plain.size() == 1 ? grid.jobs : 1);  // the results do not depend on it
  if (!broken.empty()) pass(broken, broken_names, 1);
  if (!twins.empty()) pass(twins, twin_names, 1);
  if (!threaded.empty()) pass(threaded, threaded_names, 2);
}

}  // namespace

json run_stability(const StabilityOptions& options) {
  std::vector<Cell> cells = read_cells();
  std::vector<std::string> names;
  for (const Cell& cell : cells) names.push_back(cell.name);
  for (const std::string& name : options.cells)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw SceneError("cusp validate --stability: no cell \"" + name + "\"; --list shows them");
  const auto left_out = [&](const Cell& cell) {
    const bool named = std::find(options.cells.begin(), options.cells.end(), cell.name) != options.cells.end();
    return (options.fast && !cell.fast) || (cell.slow && !named && !options.list) || (!options.cells.empty() && !named);
  };
  cells.erase(std::remove_if(cells.begin(), cells.end(), left_out), cells.end());
  json all{{"cases", json::array()}, {"counts", {{"pass", 0}, {"degraded", 0}, {"refused", 0}, {"fail", 0}}}};
  if (options.list) {
    for (const Cell& cell : cells) all["cases"].push_back({{"name", cell.name}, {"vary", cell.vary}, {"value", cell.value}});
    return all;
  }
  for (const Cell& cell : cells) std::filesystem::remove_all(options.output / cell.name);
  std::filesystem::create_directories(options.output);
  std::map<std::string, std::vector<const Cell*>> by_scene;
  for (const Cell& cell : cells) by_scene[cell.scene].push_back(&cell);
  std::map<std::string, int> codes;
  for (const auto& [scene, own] : by_scene) run_cells(own, options, codes);
  for (const Cell& cell : cells) {
    const json one =
        evaluate(cell, codes[cell.name], codes.count(cell.name + "/twin") ? codes[cell.name + "/twin"] : -1, options.output / cell.name);
    all["counts"][one["status"].get<std::string>()] = all["counts"][one["status"].get<std::string>()].get<int>() + 1;
    if (!options.quiet)
      std::printf("%-9s %-32s %s = %s  %s\n", upper_fail(one["status"]).c_str(), cell.name.c_str(), cell.vary.c_str(), cell.value.c_str(),
                  one["cause"].get<std::string>().c_str());
    all["cases"].push_back(one);
  }
  write_report(all, options.output);
  return all;
}

}  // namespace app
