#include "app/scene_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "app/scene_parts.h"

namespace app {
namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw SceneError(path.string() + ": can't be read; give the path of a scene file (.toml)");
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

toml::table parse(const std::string& text, const std::filesystem::path& path) {
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    std::string what(error.description());
    std::replace(what.begin(), what.end(), '\n', ' ');
    throw SceneError(path.string() + ":" + std::to_string(error.source().begin.line) + ": is not TOML: " + what + "; mend the line");
  }
}

std::vector<std::string> names_in(const toml::table& scene, const char* list) {
  std::vector<std::string> names;
  if (const toml::array* entries = scene[list].as_array())
    for (const toml::node& entry : *entries)
      if (const toml::table* table = entry.as_table()) names.push_back((*table)["name"].value_or(std::string()));
  return names;
}

void refuse_twins(const TableReader& top, const char* list, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  const auto entries = top.tables(list);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!names[i].empty() && !seen.insert(names[i]).second)
      refuse(TableReader(*entries[i], list,
                         [&] {
                           std::vector<std::string> keys;
                           for (const auto& [key, value] : *entries[i]) keys.emplace_back(key.str());
                           return keys;
                         }())
                 .spot("name"),
             "\"" + names[i] + "\" is used twice", "give each " + std::string(list) + " its own name");
}

void read_domain(const TableReader& top, SceneFile& scene) {
  if (!top.has("domain")) return;
  const TableReader reader(top.table("domain"), "domain", {"min", "max", "periodic"});
  scene.domain.present = true;
  scene.domain.min = reader.vector("min", scene.dimension);
  scene.domain.max = reader.vector("max", scene.dimension);
  for (int axis = 0; axis < scene.dimension; ++axis)
    if (scene.domain.min[axis] >= scene.domain.max[axis]) refuse(reader.spot("max"), "is not above min", "swap them");
  if (!reader.has("periodic")) return;
  for (const std::string& name : reader.texts("periodic")) {
    const std::size_t axis = name.size() == 1 ? std::string("xyz").find(name) : std::string::npos;
    if (axis == std::string::npos || static_cast<int>(axis) >= scene.dimension)
      refuse(reader.spot("periodic"), "\"" + name + "\" is no direction",
             "name any of x, y" + std::string(scene.dimension == 3 ? ", z" : ""));
    scene.domain.periodic[axis] = true;
    const double cells = (scene.domain.max[axis] - scene.domain.min[axis]) / scene.spacing;
    if (cells < 7.5)
      refuse(reader.spot("periodic"), "the domain is shorter than 8 spacings along " + name, "make it longer or the spacing smaller");
  }
}

void read_limits(const TableReader& top, SceneFile& scene) {
  if (!top.has("limits")) return;
  const TableReader reader(top.table("limits"), "limits", {"particles", "memory", "wall_time", "lost", "penetration", "density_error"});
  scene.limits.particles = reader.integer("particles", {1, 1e12, false, false, "a whole number from 1"}, scene.limits.particles);
  scene.limits.memory = reader.integer("memory", not_negative, 0);
  scene.limits.wall_time = reader.number("wall_time", not_negative, 0);
  scene.limits.lost = reader.integer("lost", not_negative, scene.limits.lost);
  scene.limits.penetration = reader.number("penetration", not_negative, scene.limits.penetration);
  scene.limits.density_error = reader.number("density_error", not_negative, scene.limits.density_error);
}

void read_start(const TableReader& top, SceneFile& scene) {
  if (!top.has("start")) return;
  const TableReader reader(top.table("start"), "start", {"jitter", "seed"});
  scene.start.jitter = reader.number("jitter", {0, 0.3, false, false, "0 to 0.3 spacings"}, 0);
  scene.start.seed = static_cast<std::uint64_t>(reader.integer("seed", {0, 1e15, false, false, "a whole number from 0"}, 1));
}

void read_lists(const TableReader& top, SceneContext& context, SceneFile& scene) {
  refuse_twins(top, "body", context.body_names);
  refuse_twins(top, "port", context.port_names);
  refuse_twins(top, "probe", context.probe_names);
  const auto bodies = top.tables("body"), loads = top.tables("load"), ports = top.tables("port"), probes = top.tables("probe");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::string path = entry_path("body", *bodies[i], i);
    scene.bodies.push_back(read_body(*bodies[i], path, context));
    if (const toml::table* motion = (*bodies[i])["motion"].as_table()) {
      scene.motions.push_back(read_motion(*motion, path + ".motion", context));
      scene.motions.back().body = static_cast<int>(i);
    }
  }
  if (scene.bodies.empty()) refuse(top.spot(), "the scene has no body", "add a [[body]], or [patient] for a valve");
  for (std::size_t i = 0; i < loads.size(); ++i)
    scene.loads.push_back(read_load(*loads[i], entry_path("load", *loads[i], i), context, scene.bodies));
  for (std::size_t i = 0; i < ports.size(); ++i) scene.ports.push_back(read_port(*ports[i], entry_path("port", *ports[i], i), context));
  for (std::size_t i = 0; i < probes.size(); ++i)
    scene.probes.push_back(read_probe(*probes[i], entry_path("probe", *probes[i], i), context, scene.bodies));
}

SceneFile read_table(const toml::table& table, const std::filesystem::path& path, const SceneContext& start) {
  const TableReader top(table, "",
                        {"title", "dimension", "spacing", "domain", "time", "scheme", "gravity", "body", "load", "port", "probe",
                         "reference", "patient", "limits", "valve", "start"});
  SceneFile scene;
  scene.path = path;
  scene.title = top.text("title", path.stem().string());
  scene.dimension =
      static_cast<int>(top.has("patient") ? top.integer("dimension", any_number, 3) : top.integer("dimension", any_number, -1));
  if (!top.has("dimension") && !top.has("patient")) top.node("dimension");
  if (scene.dimension != 2 && scene.dimension != 3) refuse(top.spot("dimension"), "has to be 2 or 3", "give 2 or 3");
  if (top.has("patient") && scene.dimension == 2)
    refuse(top.spot("dimension"), "a patient's valve is simulated in 3-D", "set dimension = 3");
  scene.spacing = top.number("spacing", positive);
  scene.spacing_spot = top.spot("spacing");
  SceneContext context = start;
  context.dimension = scene.dimension;
  read_domain(top, scene);
  scene.time = read_time(top.table("time"));
  context.statics = scene.time.mode == sim::TimeMode::static_equilibrium;
  if (top.has("scheme")) scene.scheme = read_scheme(top.table("scheme"));
  if (top.has("gravity")) {
    const TableReader gravity(top.table("gravity"), "gravity", {"acceleration"});
    scene.gravity = gravity.vector("acceleration", scene.dimension);
    if (scene.gravity->norm() == 0) scene.gravity.reset();
  }
  read_limits(top, scene);
  read_start(top, scene);
  context.body_names = names_in(table, "body");
  context.port_names = names_in(table, "port");
  context.probe_names = names_in(table, "probe");
  context.patient = top.has("patient");
  if (context.patient) scene.patient = read_patient(top.table("patient"), context);
  read_lists(top, context, scene);
  if (top.has("reference")) scene.references = read_references(top.table("reference"), context);
  if (top.has("valve")) scene.valve = read_valve(top.table("valve"), context);
  if (context.statics)
    for (const BodySpec& body : scene.bodies)
      if (body.kind == sim::Kind::fluid && !scene.patient)
        refuse(body.spot, "a fluid can't be in a static scene", "set time.mode = \"dynamic\", or take the fluid out");
  return scene;
}

}  // namespace

int index_of(const std::string& name, const std::vector<std::string>& names, const Spot& spot, const char* what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end() && !name.empty()) return static_cast<int>(found - names.begin());
  const std::string near = nearest_word(name, names);
  std::string all;
  for (const std::string& one : names) all += (all.empty() ? "" : ", ") + one;
  refuse(spot, "there is no " + std::string(what) + " \"" + name + "\"",
         near.empty() ? (all.empty() ? "the scene has none" : "there are: " + all) : "did you mean \"" + near + "\"?");
}

std::filesystem::path existing_file(const TableReader& reader, const std::string& key, const SceneContext& context) {
  const std::filesystem::path file = context.resolve(reader.text(key));
  if (!std::filesystem::is_regular_file(file)) refuse(reader.spot(key), "no file " + file.string(), "paths are relative to the scene file");
  return file;
}

double read_unit(const TableReader& reader, double fallback) {
  if (!reader.has("units")) return fallback;
  const std::string name = reader.choice("units", {"m", "cm", "mm", "um", "in"});
  return name == "m" ? 1 : name == "cm" ? 1e-2 : name == "mm" ? 1e-3 : name == "um" ? 1e-6 : 0.0254;
}

VectorFormula read_vector_formula(const TableReader& reader, const std::string& key, const SceneContext& context, bool with_time) {
  VectorFormula result;
  const toml::array& entries = reader.array(key);
  if (static_cast<int>(entries.size()) != context.dimension)
    refuse(reader.spot(key), "has " + std::to_string(entries.size()) + " components",
           "give " + std::to_string(context.dimension) + ", one an axis");
  for (std::size_t axis = 0; axis < entries.size(); ++axis) {
    const toml::node& entry = *entries.get(axis);
    std::ostringstream shown;
    shown.precision(17);
    if (entry.is_number()) {
      shown << *entry.value<double>();
    } else if (entry.is_string()) {
      shown << *entry.value<std::string>();
    } else {
      refuse(reader.spot(key), "holds something that is neither number nor formula", "as in [\"sin(2*pi*x)\", 0]");
    }
    result.text[axis] = shown.str();
    try {
      const auto formula = compile_formula(result.text[axis]);
      if (!with_time && formula({0.1, 0.2, 0.3}, 0) != formula({0.1, 0.2, 0.3}, 1))
        refuse(reader.spot(key), "depends on t", "an initial velocity is a formula in x, y, z alone");
    } catch (const std::invalid_argument& error) {
      refuse(reader.spot(key), error.what(), "mend the formula");
    }
  }
  return result;
}

sim::TimeTable read_number_or_table(const TableReader& reader, const std::string& key, const SceneContext& context, Range range) {
  if (reader.node(key).is_string()) return read_time_table(existing_file(reader, key, context), reader.spot(key));
  return sim::constant_table(reader.number(key, range));
}

int read_axis(const TableReader& reader, const std::string& key, const SceneContext& context) {
  const std::string name =
      reader.choice(key, context.dimension == 2 ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x", "y", "z"});
  return name[0] - 'x';
}

sim::TimeSettings read_time(const toml::table& table) {
  const TableReader reader(table, "time", {"mode", "end", "step", "output"});
  sim::TimeSettings time;
  const bool statics = reader.choice("mode", {"dynamic", "static"}, "dynamic") == "static";
  time.mode = statics ? sim::TimeMode::static_equilibrium : sim::TimeMode::dynamic;
  time.end = statics ? reader.number("end", positive, 1) : reader.number("end", positive);
  if (reader.has("step")) {
    if (reader.node("step").is_string()) {
      reader.choice("step", {"adaptive"});
    } else {
      time.step = reader.number("step", positive);
    }
  }
  time.output = reader.number("output", positive, statics ? time.end : time.end / 100);
  return time;
}

sim::SchemeSettings read_scheme(const toml::table& table) {
  using S = sim::SchemeSettings;
  struct Knob {
    const char* key;
    double S::*number;
    Range range;
  };
  static const std::vector<Knob> knobs{
      {"kernel_radius", &S::kernel_radius, {1.5, 6, false, false, "1.5 to 6 spacings"}},
      {"elastic_kernel_radius", &S::elastic_kernel_radius, {1.5, 6, false, false, "1.5 to 6 spacings"}},
      {"cfl", &S::cfl, {0, 1, true, false, "a number above 0, at most 1"}},
      {"maximum_step", &S::maximum_step, not_negative},
      {"pressure_tolerance", &S::pressure_tolerance, {0, 0.1, true, false, "a number above 0, at most 0.1"}},
      {"density_blend", &S::density_blend, {0, 1, false, false, "0 to 1"}},
      {"density_tolerance", &S::density_tolerance, {0, 0.1, false, false, "0 (off) to 0.1"}},
      {"shifting", &S::shifting, {0, 10, false, false, "0 (off) to 10"}},
      {"subparticle_dissipation", &S::subparticle_dissipation, {0, 10, false, false, "0 (off) to 10"}},
      {"projection_filter", &S::projection_filter, {0, 0.5, false, false, "0 (off) to 0.5"}},
      {"viscosity_limit", &S::viscosity_limit, positive},
      {"elastic_substep", &S::elastic_substep, {0, 0.5, true, false, "a number above 0, at most 0.5"}},
      {"added_mass", &S::added_mass, {0, 10, false, false, "0 to 10"}},
      {"resolved_mass", &S::resolved_mass, {0, 10, false, false, "0 to 10"}},
      {"leaflet_relaxation", &S::leaflet_relaxation, {0, 1, false, false, "0 to 1"}},
      {"bending_viscosity", &S::bending_viscosity, not_negative},
      {"film_resistance", &S::film_resistance, not_negative},
      {"elastic_tolerance", &S::elastic_tolerance, {0, 0.1, true, false, "a number above 0, at most 0.1"}}};
  std::vector<std::string> known{"name", "pressure_iterations", "outer_iterations", "elastic_explicit_limit", "literal_weight"};
  for (const Knob& knob : knobs) known.push_back(knob.key);
  const TableReader reader(table, "scheme", known);
  S scheme;
  scheme.name = reader.choice("name", {"accurate", "paper"}, "accurate") == "paper" ? sim::Scheme::paper : sim::Scheme::accurate;
  for (const Knob& knob : knobs)
    if (reader.has(knob.key)) scheme.*knob.number = reader.number(knob.key, knob.range);
  const Range counts{1, 1e6, false, false, "a whole number from 1"};
  scheme.pressure_iterations = static_cast<int>(reader.integer("pressure_iterations", counts, scheme.pressure_iterations));
  scheme.outer_iterations = static_cast<int>(reader.integer("outer_iterations", counts, scheme.outer_iterations));
  scheme.elastic_explicit_limit = static_cast<int>(reader.integer("elastic_explicit_limit", counts, scheme.elastic_explicit_limit));
  scheme.literal_weight = reader.flag("literal_weight", false);
  if (scheme.literal_weight && scheme.name != sim::Scheme::paper)
    refuse(reader.spot("literal_weight"), "belongs to the paper's scheme", "set scheme.name = \"paper\"");
  return scheme;
}

SceneFile parse_scene_text(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& settings) {
  toml::table table = parse(text, path);
  SceneContext context;
  context.folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  std::vector<Override> later;
  const bool patient = table.contains("patient");
  for (const std::string& setting : settings) {
    Override parsed = parse_override(setting);
    if (patient && (parsed.path.front() == "body" || parsed.path.front() == "port")) {
      later.push_back(std::move(parsed));
    } else {
      apply_override(table, parsed);
    }
  }
  if (table.contains("patient")) expand_patient(table);
  for (const Override& setting : later) apply_override(table, setting);
  SceneFile scene = read_table(table, path, context);
  scene.text = text;
  scene.settings = settings;
  return scene;
}

SceneFile read_scene_file(const std::filesystem::path& path, const std::vector<std::string>& settings) {
  return parse_scene_text(read_text(path), path, settings);
}

std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file, const Spot& asked_by) {
  std::ifstream stream(file);
  if (!stream) refuse(asked_by, "can't read " + file.string(), "give a CSV file");
  std::vector<std::vector<double>> rows;
  std::string line;
  bool heading_seen = false;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#' || line.find_first_not_of(" \t,") == std::string::npos) continue;
    std::vector<double> row;
    std::stringstream cells(line);
    bool numbers = true;
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      const double value = std::strtod(cell.c_str(), &end);
      numbers = numbers && end != cell.c_str() &&
                cell.find_first_not_of(" \t", static_cast<std::size_t>(end - cell.c_str())) == std::string::npos && std::isfinite(value);
      row.push_back(value);
    }
    if (!numbers && rows.empty() && !heading_seen) {
      heading_seen = true;
      continue;
    }
    const Spot spot{file.string(), number, ""};
    if (!numbers) refuse(spot, "is no row of numbers", "one row a line, numbers separated by commas");
    if (row.size() < 2 || (!rows.empty() && row.size() != rows.front().size()))
      refuse(spot, "has another number of columns", "all rows alike, two or more");
    rows.push_back(std::move(row));
  }
  if (rows.empty()) refuse(asked_by, file.string() + " holds no row of numbers", "give rows as in 0.1, 250");
  return rows;
}

sim::TimeTable read_time_table(const std::filesystem::path& file, const Spot& asked_by) {
  sim::TimeTable table;
  for (const auto& row : read_number_table(file, asked_by)) {
    if (!table.time.empty() && row[0] <= table.time.back())
      refuse(asked_by, "the times in " + file.string() + " do not grow", "sort its rows by time");
    table.time.push_back(row[0]);
    table.value.push_back(row[1]);
  }
  return table;
}

}  // namespace app
