// The parts of the scene reader: one function per kind of table. Internal to app/scene_*.cpp.
#pragma once

#include "app/scene_file.h"
#include "app/scene_table.h"

namespace app {

// What every part needs to know while it reads.
struct SceneContext {
  int dimension = 3;
  bool statics = false, patient = false;
  std::filesystem::path folder;  // relative paths start here
  std::vector<std::string> body_names, port_names, probe_names;
  std::filesystem::path resolve(const std::string& file) const { return std::filesystem::weakly_canonical(folder / file); }
};

int index_of(const std::string& name, const std::vector<std::string>& names, const Spot& spot, const char* what);
std::filesystem::path existing_file(const TableReader& reader, const std::string& key, const SceneContext& context);
double read_unit(const TableReader& reader, double fallback);
VectorFormula read_vector_formula(const TableReader& reader, const std::string& key, const SceneContext& context, bool with_time);
// A number, or the name of a table file.
sim::TimeTable read_number_or_table(const TableReader& reader, const std::string& key, const SceneContext& context,
                                    Range range = any_number);
int read_axis(const TableReader& reader, const std::string& key, const SceneContext& context);

ShapeSpec read_shape(const toml::table& table, const std::string& path, const SceneContext& context, bool region = false);
sim::FluidMaterial read_fluid_material(const toml::table& table, const std::string& path);
BodySpec read_body(const toml::table& table, const std::string& path, const SceneContext& context);
MotionSpec read_motion(const toml::table& table, const std::string& path, const SceneContext& context);
LoadSpec read_load(const toml::table& table, const std::string& path, const SceneContext& context, const std::vector<BodySpec>& bodies);
PortSpec read_port(const toml::table& table, const std::string& path, const SceneContext& context);
ProbeSpec read_probe(const toml::table& table, const std::string& path, const SceneContext& context, const std::vector<BodySpec>& bodies);
std::vector<ReferenceSpec> read_references(const toml::table& table, const SceneContext& context);
ValveSpec read_valve(const toml::table& table, const SceneContext& context);
sim::SchemeSettings read_scheme(const toml::table& table);
sim::TimeSettings read_time(const toml::table& table);

// [patient]: its own settings, and the bodies and ports it stands for, added to `scene` as tables that the user's own entries override.
PatientSpec read_patient(const toml::table& table, const SceneContext& context);
void expand_patient(toml::table& scene);

// --set: splits "a.b.c=value" and puts the value there. Throws SceneError.
struct Override {
  std::vector<std::string> path;
  std::string text;  // as typed, for messages
  std::string value;
};
Override parse_override(const std::string& text);
void apply_override(toml::table& scene, const Override& setting);

}  // namespace app
