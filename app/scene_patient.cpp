// [patient]: the short form for a valve case, and the bodies and ports it stands for.
#include <cmath>

#include "app/scene_parts.h"
#include "sim/lumped_heart.h"

namespace app {
namespace {

const std::vector<std::string> material_keys{
    "density",          "law",         "youngs_modulus", "poisson_ratio", "fibre_modulus",
    "fibre_stiffening", "fibre_limit", "damping",        "thickness",     "bending_thickness_ratio"};

std::vector<std::string> valve_keys() {
  std::vector<std::string> keys = material_keys;
  keys.insert(keys.end(), {"template", "file", "units", "coaptation", "over_closure"});
  return keys;
}

// Adds what `defaults` has and `own` lacks, table by table.
void fill_in(toml::table& own, const toml::table& defaults) {
  for (const auto& [key, value] : defaults) {
    toml::node* present = own.get(key.str());
    if (!present) {
      own.insert(key.str(), value);
    } else if (present->is_table() && value.is_table()) {
      fill_in(*present->as_table(), *value.as_table());
    }
  }
}

void add_entry(toml::table& scene, const char* list, const toml::table& defaults) {
  if (!scene.contains(list)) scene.insert(list, toml::array{});
  toml::array* entries = scene[list].as_array();
  if (!entries) return;  // refused by the reader, with its line
  for (toml::node& entry : *entries)
    if (toml::table* table = entry.as_table();
        table && (*table)["name"].value_or(std::string()) == defaults["name"].value_or(std::string("?"))) {
      fill_in(*table, defaults);
      return;
    }
  entries->push_back(defaults);
}

// Defaults: the paper's 1 MPa, of a fibre-reinforced leaflet that of the matrix alone: fibres carry diastole. Tissue is no solid sheet: the
// layers of a leaflet (fibrosa, spongiosa, ventricularis: about 0.45, 0.35, 0.2 of its thickness) slide on one another, so that it bends as
// a solid sheet of sqrt(0.45^3 + 0.35^3 + 0.2^3) = 0.38 of its thickness. A solid sheet of 1 MPa hardly opens.
toml::table leaflet_material(const toml::table& valve) {
  toml::table material{
      {"density", 1060.0}, {"law", "fibre-reinforced"}, {"youngs_modulus", 1e6}, {"poisson_ratio", 0.49}, {"thickness", 0.5e-3}};
  const std::string law = valve["law"].value_or(std::string("fibre-reinforced"));
  if (law == "fibre-reinforced")
    fill_in(material,
            toml::table{{"fibre_modulus", 0.8e6}, {"fibre_stiffening", 5.0}, {"fibre_limit", 0.35}, {"bending_thickness_ratio", 0.38}});
  for (const std::string& key : material_keys)
    if (const toml::node* given = valve.get(key)) material.insert_or_assign(key, *given);
  return material;
}

PlaneSpec read_plane_spec(const TableReader& reader) {
  PlaneSpec plane{reader.vector("center", 3), reader.vector("normal", 3)};
  if (plane.normal.norm() == 0) refuse(reader.spot("normal"), "has no length", "point it from the ventricle to the aorta");
  plane.normal.normalize();
  return plane;
}

void read_root(const TableReader& top, PatientSpec& patient) {
  if (!top.has("root")) return;
  const TableReader root(top.table("root"), "patient.root", {"annulus", "sinotubular_junction", "commissures", "build"});
  patient.build_root = root.flag("build", false);
  for (const char* key : {"annulus", "sinotubular_junction"}) {
    if (!root.has(key)) continue;
    const TableReader ring(root.table(key), std::string("patient.root.") + key, {"center", "normal", "diameter"});
    const bool annulus = key[0] == 'a';
    if (ring.has("diameter")) (annulus ? patient.annulus_diameter : patient.junction_diameter) = ring.number("diameter", positive);
    if (ring.has("center") || ring.has("normal")) (annulus ? patient.annulus : patient.sinotubular_junction) = read_plane_spec(ring);
  }
  if (!root.has("commissures")) return;
  for (const toml::node& entry : root.array("commissures")) {
    const toml::array* point = entry.as_array();
    if (!point || point->size() != 3)
      refuse(root.spot("commissures"), "holds something that is no point", "give three points [[x, y, z], ...] in m");
    Eigen::Vector3d where;
    for (int axis = 0; axis < 3; ++axis) where[axis] = point->get(axis)->value<double>().value_or(NAN);
    if (!where.allFinite()) refuse(root.spot("commissures"), "holds something that is no point", "give three points [[x, y, z], ...] in m");
    patient.commissures.push_back(where);
  }
  if (patient.commissures.size() != 3) refuse(root.spot("commissures"), "needs three points", "one where each two leaflets meet");
}

WaveSpec read_wave(const TableReader& top, const std::string& key, const SceneContext& context) {
  WaveSpec wave;
  if (!top.has(key)) return wave;
  if (top.node(key).is_string()) {
    wave.table = read_time_table(existing_file(top, key, context), top.spot(key));
    return wave;
  }
  const TableReader reader(top.table(key), "patient." + key, {"systolic", "diastolic"});
  wave.systolic = reader.number("systolic");
  wave.diastolic = reader.number("diastolic");
  if (*wave.systolic <= *wave.diastolic) refuse(reader.spot("systolic"), "is not above diastolic", "give both in Pa");
  return wave;
}

// Both waves from a heart fitted to cuff readings (sim/lumped_heart.h).
void read_cuff(const TableReader& top, PatientSpec& patient) {
  constexpr double pascals_per_mmHg = 133.322, millilitres_per_m3 = 1e6;
  const TableReader cuff(top.table("cuff"), "patient.cuff", {"systolic", "diastolic", "stroke_volume"});
  for (const char* key : {"ventricle_pressure", "aortic_pressure"})
    if (top.has(key)) refuse(top.spot("cuff"), std::string("does not go with ") + key, "give one of them");
  const sim::CuffReadings readings{patient.heart_rate, cuff.number("systolic", positive) / pascals_per_mmHg,
                                   cuff.number("diastolic", positive) / pascals_per_mmHg,
                                   millilitres_per_m3 * cuff.number("stroke_volume", positive)};
  try {
    const sim::PortWaves waves = sim::port_waves(sim::simulate_heart(sim::fit_heart(readings)));
    sim::TimeTable table;
    table.time = waves.time, table.value = waves.ventricle;
    patient.ventricle_pressure.table = table;
    table.value = waves.aorta;
    patient.aortic_pressure.table = table;
  } catch (const std::invalid_argument& error) {
    refuse(top.spot("cuff"), error.what(), "systolic and diastolic are in Pa, stroke_volume in m3");
  }
}

void check_valve(const TableReader& top, const SceneContext& context, PatientSpec& patient) {
  if (!top.has("valve")) return;
  const TableReader valve(top.table("valve"), "patient.valve", valve_keys());
  if (valve.has("template")) valve.choice("template", {"tricuspid"});
  if (valve.has("template") && valve.has("file")) refuse(valve.spot("file"), "does not go with template", "give one of them");
  if (valve.has("file")) patient.leaflets = existing_file(valve, "file", context), patient.leaflets_unit = read_unit(valve, 1e-3);
  for (const char* key : {"density", "youngs_modulus", "thickness", "fibre_limit"}) valve.number(key, positive, 1);
  for (const char* key : {"fibre_modulus", "fibre_stiffening", "damping"}) valve.number(key, not_negative, 1);
  valve.number("bending_thickness_ratio", {0, 1, true, false, "a number above 0 and at most 1"}, 1);
  valve.number("poisson_ratio", {-1, 0.5, true, true, "a number above -1 and below 0.5"}, 0);
  valve.choice("law", {"linear", "corotated", "st-venant-kirchhoff", "neo-hookean", "fibre-reinforced"}, "neo-hookean");
  if (valve.has("coaptation")) patient.coaptation = valve.number("coaptation", positive);
  if (valve.has("over_closure")) patient.over_closure = valve.number("over_closure", not_negative);
}

}  // namespace

PatientSpec read_patient(const toml::table& table, const SceneContext& context) {
  const TableReader reader(table, "patient",
                           {"aorta", "valve", "root", "heart_rate", "ventricle_pressure", "aortic_pressure", "cuff", "blood",
                            "below_annulus", "above_junction", "extension"});
  PatientSpec patient;
  patient.spot = reader.spot();
  if (reader.has("aorta")) {
    const TableReader aorta(reader.table("aorta"), "patient.aorta", {"file", "units"});
    patient.aorta = existing_file(aorta, "file", context);
    patient.aorta_unit = read_unit(aorta, 1e-3);
  }
  check_valve(reader, context, patient);
  read_root(reader, patient);
  patient.heart_rate = reader.number("heart_rate", {20, 300, false, false, "beats a minute, 20 to 300"}, 75);
  patient.ventricle_pressure = read_wave(reader, "ventricle_pressure", context);
  patient.aortic_pressure = read_wave(reader, "aortic_pressure", context);
  if (reader.has("cuff")) read_cuff(reader, patient);
  if (reader.has("blood")) {
    const TableReader blood(reader.table("blood"), "patient.blood", {"hematocrit", "density"});
    const double hematocrit = blood.number("hematocrit", {0, 75, false, false, "per cent of cells, 0 to 75"}, 45);
    if (hematocrit > 0 && hematocrit < 1) refuse(blood.spot("hematocrit"), "looks like a fraction", "give per cent, as in 45");
    blood.number("density", positive, 1060);
  }
  patient.below_annulus = reader.number("below_annulus", positive, patient.below_annulus);
  patient.above_junction = reader.number("above_junction", positive, patient.above_junction);
  patient.extension = reader.number("extension", not_negative, patient.extension);
  return patient;
}

void expand_patient(toml::table& scene) {
  const toml::table* found = scene["patient"].as_table();
  if (!found) return;  // refused by the reader
  const toml::table patient = *found;
  const toml::table none;
  const toml::table& valve = patient["valve"].is_table() ? *patient["valve"].as_table() : none;
  toml::table blood_material{{"rheology", "blood"}, {"hematocrit", 45.0}};
  if (const toml::table* blood = patient["blood"].as_table())
    for (const auto& [key, value] : *blood) blood_material.insert_or_assign(key.str(), value);
  const auto shape = [](const char* part) { return toml::table{{"type", "patient"}, {"part", part}}; };
  add_entry(scene, "body",
            toml::table{{"name", "leaflets"}, {"kind", "elastic"}, {"shape", shape("leaflets")}, {"material", leaflet_material(valve)}});
  add_entry(scene, "body", toml::table{{"name", "blood"}, {"kind", "fluid"}, {"shape", shape("blood")}, {"material", blood_material}});
  add_entry(scene, "body", toml::table{{"name", "aorta"}, {"kind", "wall"}, {"shape", shape("aorta")}});
  add_entry(scene, "port", toml::table{{"name", "ventricle"}});
  add_entry(scene, "port", toml::table{{"name", "aorta"}});
  const double beat = 60 / patient["heart_rate"].value_or(75.0);
  if (!scene.contains("time")) scene.insert("time", toml::table{});
  if (toml::table* time = scene["time"].as_table()) fill_in(*time, toml::table{{"end", beat}, {"output", beat / 100}});
}

}  // namespace app
