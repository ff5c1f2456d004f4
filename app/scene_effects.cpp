// Loads, ports, probes, references and the valve of a scene file.
#include <algorithm>
#include <cmath>

#include "app/scene_parts.h"

namespace app {
namespace {

// The centre and the unit normal of a plane, and its radius (infinite where absent).
struct PlaneRead {
  Eigen::Vector3d point, normal;
  double radius;
};
PlaneRead read_plane(const TableReader& parent, const SceneContext& context, bool radius_needed) {
  const TableReader reader(parent.table("plane"), parent.path() + ".plane", {"point", "normal", "radius"});
  PlaneRead plane{reader.vector("point", context.dimension), reader.vector("normal", context.dimension), 0};
  if (plane.normal.norm() == 0) refuse(reader.spot("normal"), "has no length", "give the plane's normal");
  plane.normal.normalize();
  plane.radius = radius_needed ? reader.number("radius", positive) : reader.number("radius", positive, infinite / 10);
  if (plane.radius > 1e300) plane.radius = infinite;
  return plane;
}

sim::Quantity read_quantity(const TableReader& reader) {
  static const std::vector<std::string> names{"displacement", "position",  "velocity", "pressure", "stress",
                                              "density",      "flow_rate", "energy",   "volume",   "front"};
  const std::string name = reader.choice("quantity", names);
  return static_cast<sim::Quantity>(std::find(names.begin(), names.end(), name) - names.begin());
}

void read_probe_place(const TableReader& reader, const SceneContext& context, sim::Probe<3>& probe) {
  using sim::Quantity;
  const Quantity quantity = probe.quantity;
  const bool at_a_point =
      quantity != Quantity::flow_rate && quantity != Quantity::energy && quantity != Quantity::volume && quantity != Quantity::front;
  const std::string name = reader.text("quantity");
  const auto needs = [&](const char* key, bool wanted, const char* mend) {
    if (reader.has(key) && !wanted) refuse(reader.spot(key), "has no meaning for " + name, mend);
  };
  needs("at", at_a_point, "take it out");
  needs("line", at_a_point, "take it out");
  needs("plane", quantity == Quantity::flow_rate, "take it out");
  needs("axis", quantity == Quantity::front, "take it out");
  if (at_a_point) {
    if (reader.has("at") == reader.has("line"))
      refuse(reader.spot(), "needs a place", "give either at = [...] or line = { from, to, count }");
    if (reader.has("at")) {
      probe.points = {reader.vector("at", context.dimension)};
    } else {
      const TableReader line(reader.table("line"), reader.path() + ".line", {"from", "to", "count"});
      const Eigen::Vector3d from = line.vector("from", context.dimension), to = line.vector("to", context.dimension);
      const auto count = line.integer("count", {2, 100000, false, false, "a whole number from 2 to 100000"}, 0);
      if (count == 0) refuse(line.spot("count"), "is missing", "say how many points");
      probe.line = true;
      for (std::int64_t i = 0; i < count; ++i)
        probe.points.push_back(from + (to - from) * (static_cast<double>(i) / static_cast<double>(count - 1)));
    }
  } else if (quantity == Quantity::flow_rate) {
    const PlaneRead plane = read_plane(reader, context, false);
    probe.plane_point = plane.point, probe.plane_normal = plane.normal, probe.plane_radius = plane.radius;
  } else if (quantity == Quantity::front) {
    probe.axis = read_axis(reader, "axis", context);
  }
}

}  // namespace

LoadSpec read_load(const toml::table& table, const std::string& path, const SceneContext& context, const std::vector<BodySpec>& bodies) {
  const TableReader reader(table, path, {"name", "body", "region", "force", "acceleration", "pressure", "ramp", "time"});
  LoadSpec load;
  load.spot = reader.spot();
  load.name = reader.text("name", "");
  load.body = index_of(reader.text("body"), context.body_names, reader.spot("body"), "body");
  const sim::Kind kind = bodies[load.body].kind;
  if (reader.has("region")) load.region = read_shape(reader.table("region"), path + ".region", context, true);
  const int given = reader.has("force") + reader.has("acceleration") + reader.has("pressure");
  if (given != 1)
    refuse(reader.spot(), given == 0 ? "says no load" : "says more than one load", "give exactly one of force, acceleration, pressure");
  if (kind == sim::Kind::wall)
    refuse(reader.spot("body"), "is a wall, which no load moves", "use the wall's motion, or make the body elastic");
  if (kind == sim::Kind::fluid && !reader.has("acceleration"))
    refuse(reader.spot("body"), "is a fluid", "a fluid takes acceleration = [...]; pressure belongs to a [[port]]");
  if (reader.has("force")) load.force = reader.vector("force", context.dimension);
  if (reader.has("acceleration")) load.acceleration = read_vector_formula(reader, "acceleration", context, true);
  if (reader.has("pressure")) load.pressure = reader.number("pressure");
  if (reader.has("ramp") && reader.has("time")) refuse(reader.spot("ramp"), "does not go with time", "give one of them");
  load.ramp = reader.number("ramp", not_negative, 0);
  if (reader.has("time")) load.factor = read_time_table(existing_file(reader, "time", context), reader.spot("time"));
  return load;
}

PortSpec read_port(const toml::table& table, const std::string& path, const SceneContext& context) {
  const TableReader reader(table, path, {"name", "plane", "pressure", "velocity", "flow_rate", "windkessel", "impedance", "start_speed"});
  PortSpec spec;
  spec.spot = reader.spot();
  sim::Port<3>& port = spec.port;
  port.name = reader.text("name");
  if (!usable_name(port.name)) refuse(reader.spot("name"), "\"" + port.name + "\" can't be a name", "use letters, digits, - and _");
  const bool of_patient = context.patient && (port.name == "ventricle" || port.name == "aorta");
  spec.has_plane = reader.has("plane") || !of_patient;
  if (spec.has_plane) {
    const PlaneRead plane = read_plane(reader, context, true);
    port.point = plane.point, port.normal = plane.normal, port.radius = plane.radius;
  }
  const int given = reader.has("pressure") + reader.has("velocity") + reader.has("flow_rate") + reader.has("windkessel");
  spec.has_condition = given > 0 || !of_patient;
  if (given > 1 || (given == 0 && spec.has_condition))
    refuse(reader.spot(), given == 0 ? "says no condition" : "says more than one condition",
           "give exactly one of pressure, velocity, flow_rate, windkessel");
  if (reader.has("pressure")) port.condition = sim::PortCondition::pressure, port.table = read_number_or_table(reader, "pressure", context);
  if (reader.has("velocity")) port.condition = sim::PortCondition::velocity, port.table = read_number_or_table(reader, "velocity", context);
  if (reader.has("flow_rate"))
    port.condition = sim::PortCondition::flow_rate, port.table = read_number_or_table(reader, "flow_rate", context);
  if (reader.has("windkessel")) {
    const TableReader inner(reader.table("windkessel"), path + ".windkessel",
                            {"proximal_resistance", "distal_resistance", "compliance", "initial_pressure"});
    port.condition = sim::PortCondition::windkessel;
    port.windkessel = {inner.number("proximal_resistance", not_negative), inner.number("distal_resistance", not_negative),
                       inner.number("compliance", positive), inner.number("initial_pressure", any_number, 0)};
  }
  if (reader.has("impedance") && port.condition != sim::PortCondition::pressure)
    refuse(reader.spot("impedance"), "belongs to a pressure port", "take it out");
  port.impedance = reader.number("impedance", not_negative, 0);
  port.start_speed = reader.number("start_speed", any_number, 0);
  return spec;
}

ProbeSpec read_probe(const toml::table& table, const std::string& path, const SceneContext& context, const std::vector<BodySpec>& bodies) {
  const TableReader reader(table, path, {"name", "quantity", "body", "at", "line", "plane", "axis"});
  ProbeSpec spec;
  spec.spot = reader.spot();
  sim::Probe<3>& probe = spec.probe;
  probe.name = reader.text("name");
  if (!usable_name(probe.name))
    refuse(reader.spot("name"), "\"" + probe.name + "\" can't be the name of a column", "use letters, digits, - and _");
  probe.quantity = read_quantity(reader);
  if (reader.has("body")) probe.body = index_of(reader.text("body"), context.body_names, reader.spot("body"), "body");
  read_probe_place(reader, context, probe);
  using sim::Quantity;
  const bool elastic_scene =
      std::any_of(bodies.begin(), bodies.end(), [](const BodySpec& body) { return body.kind == sim::Kind::elastic; });
  const bool fluid_scene = std::any_of(bodies.begin(), bodies.end(), [](const BodySpec& body) { return body.kind == sim::Kind::fluid; });
  const sim::Kind kind = probe.body >= 0 ? bodies[probe.body].kind : fluid_scene ? sim::Kind::fluid : sim::Kind::elastic;
  if (probe.quantity == Quantity::stress && (probe.body >= 0 ? kind != sim::Kind::elastic : !elastic_scene))
    refuse(reader.spot("quantity"), "only an elastic body has a stress here", "name an elastic body, or ask for pressure or velocity");
  if ((probe.quantity == Quantity::flow_rate || probe.quantity == Quantity::front) &&
      (probe.body >= 0 ? kind != sim::Kind::fluid : !fluid_scene))
    refuse(reader.spot("quantity"), "only a fluid has that", "name a fluid body");
  return spec;
}

std::vector<ReferenceSpec> read_references(const toml::table& table, const SceneContext& context) {
  const TableReader names(table, "reference", context.probe_names);
  std::vector<ReferenceSpec> result;
  for (const auto& [key, value] : table) {
    const std::string name(key.str()), path = "reference." + name;
    std::vector<std::string> known{"value", "x",  "y",  "z",  "von_mises", "principal1", "principal2", "principal3",  "xx",    "yy",
                                   "zz",    "xy", "yz", "xz", "table",     "time",       "source",     "uncertainty", "limit", "component"};
    const TableReader reader(names.table(name), path, known);
    ReferenceSpec reference;
    reference.spot = reader.spot();
    reference.probe = name;
    for (std::size_t i = 0; i < 14; ++i)
      if (reader.has(known[i])) reference.values.emplace_back(i == 0 ? "" : known[i], reader.number(known[i]));
    if (reader.has("table")) reference.table = existing_file(reader, "table", context);
    reference.component = reader.text("component", "");
    if (reference.values.empty() == reference.table.empty())
      refuse(reader.spot(), "says nothing to compare with", "give value, or x/y/z, or a table of the probe's columns");
    if (reader.has("time")) reference.time = reader.number("time", not_negative);
    reference.source = reader.text("source", "");
    reference.uncertainty = reader.number("uncertainty", not_negative, 0);
    if (reader.has("limit")) reference.limit = reader.number("limit", positive);
    result.push_back(std::move(reference));
  }
  return result;
}

ValveSpec read_valve(const toml::table& table, const SceneContext& context) {
  const TableReader reader(
      table, "valve",
      {"annulus_center", "axis", "annulus_radius", "commissure_height", "commissure_radius", "leaflets", "ventricle", "aorta"});
  ValveSpec valve;
  valve.spot = reader.spot();
  valve.annulus_center = reader.vector("annulus_center", context.dimension);
  valve.axis = reader.vector("axis", context.dimension);
  if (valve.axis.norm() == 0) refuse(reader.spot("axis"), "has no length", "point it from the ventricle to the aorta");
  valve.axis.normalize();
  valve.annulus_radius = reader.number("annulus_radius", positive);
  valve.commissure_height = reader.number("commissure_height", positive);
  valve.commissure_radius = reader.number("commissure_radius", positive, valve.annulus_radius);
  for (const std::string& name : reader.texts("leaflets"))
    valve.leaflets.push_back(index_of(name, context.body_names, reader.spot("leaflets"), "body"));
  if (valve.leaflets.empty()) refuse(reader.spot("leaflets"), "is empty", "name the leaflets' bodies");
  if (reader.has("ventricle"))
    valve.ventricle_port = index_of(reader.text("ventricle"), context.port_names, reader.spot("ventricle"), "port");
  if (reader.has("aorta")) valve.aorta_port = index_of(reader.text("aorta"), context.port_names, reader.spot("aorta"), "port");
  return valve;
}

}  // namespace app
