// Bodies of a scene file: shapes, materials, what holds and moves them.
#include <cmath>

#include "app/blood.h"
#include "app/scene_parts.h"

namespace app {
namespace {

const std::vector<std::string> shape_types{"box", "sphere", "cylinder", "polygon", "mesh", "shell", "patient"};

std::vector<std::string> shape_keys(const std::string& type) {
  std::vector<std::string> keys{"type", "subtract", "intersect"};
  const auto add = [&](std::initializer_list<const char*> more) { keys.insert(keys.end(), more.begin(), more.end()); };
  if (type == "box") add({"min", "max"});
  if (type == "sphere") add({"center", "radius"});
  if (type == "cylinder") add({"from", "to", "radius", "inner_radius"});
  if (type == "polygon") add({"points", "from", "to"});
  if (type == "mesh") add({"file", "units"});
  if (type == "shell") add({"file", "units", "thickness", "layers"});
  if (type == "patient") add({"part"});
  return keys;
}

void read_box(const TableReader& reader, const SceneContext& context, bool region, ShapeSpec& shape) {
  shape.min = reader.vector("min", context.dimension);
  shape.max = reader.vector("max", context.dimension);
  for (int axis = 0; axis < context.dimension; ++axis)
    if (shape.min[axis] > shape.max[axis] || (!region && shape.min[axis] == shape.max[axis]))
      refuse(reader.spot("max"), "is not above min along " + std::string(1, "xyz"[axis]), "swap them or give the box an extent");
}

void read_polygon(const TableReader& reader, const SceneContext& context, ShapeSpec& shape) {
  for (const toml::node& entry : reader.array("points")) {
    const toml::array* pair = entry.as_array();
    if (!pair || pair->size() != 2 || !pair->get(0)->is_number() || !pair->get(1)->is_number())
      refuse(reader.spot("points"), "holds something that is no point", "give points as [[x, y], [x, y], ...]");
    shape.points.emplace_back(*pair->get(0)->value<double>(), *pair->get(1)->value<double>());
  }
  if (shape.points.size() < 3) refuse(reader.spot("points"), "has fewer than three points", "give the corners in order");
  if (context.dimension == 2) return;
  shape.height_from = reader.number("from");
  shape.height_to = reader.number("to");
  if (shape.height_to <= shape.height_from) refuse(reader.spot("to"), "is not above from", "give the two heights along z");
}

void read_cylinder(const TableReader& reader, const SceneContext& context, ShapeSpec& shape) {
  shape.from = reader.vector("from", context.dimension);
  shape.to = reader.vector("to", context.dimension);
  if ((shape.to - shape.from).norm() == 0) refuse(reader.spot("to"), "is the same point as from", "give the cylinder a length");
  shape.radius = reader.number("radius", positive);
  shape.inner_radius = reader.number("inner_radius", not_negative, 0);
  if (shape.inner_radius >= shape.radius)
    refuse(reader.spot("inner_radius"), "is not below radius", "give the bore of the tube, or leave it out");
}

ShapeType shape_type(const std::string& name) {
  for (std::size_t i = 0; i < shape_types.size(); ++i)
    if (shape_types[i] == name) return static_cast<ShapeType>(i);
  return ShapeType::box;
}

sim::ElasticLaw elastic_law(const std::string& name) {
  if (name == "linear") return sim::ElasticLaw::linear;
  if (name == "corotated") return sim::ElasticLaw::corotated;
  if (name == "st-venant-kirchhoff") return sim::ElasticLaw::st_venant_kirchhoff;
  if (name == "fibre-reinforced") return sim::ElasticLaw::fibre_reinforced;
  return sim::ElasticLaw::neo_hookean;
}

void read_elastic_material(const TableReader& reader, const SceneContext& context, BodySpec& body) {
  sim::ElasticMaterial& material = body.elastic;
  material.density = context.statics ? reader.number("density", positive, 1000) : reader.number("density", positive);
  material.law =
      elastic_law(reader.choice("law", {"linear", "corotated", "st-venant-kirchhoff", "neo-hookean", "fibre-reinforced"}, "neo-hookean"));
  material.youngs_modulus = reader.number("youngs_modulus", positive);
  material.poisson_ratio =
      reader.number("poisson_ratio", {-1, 0.5, true, true, "a number above -1 and below 0.5 (0.49 is nearly incompressible)"});
  const bool fibres = material.law == sim::ElasticLaw::fibre_reinforced;
  for (const char* key : {"fibre_modulus", "fibre_stiffening", "fibre_limit", "fibre_direction"})
    if (reader.has(key) && !fibres) refuse(reader.spot(key), "belongs to another law", "set law = \"fibre-reinforced\", or take it out");
  material.fibre_modulus = reader.number("fibre_modulus", not_negative, material.fibre_modulus);
  material.fibre_stiffening = reader.number("fibre_stiffening", not_negative, material.fibre_stiffening);
  material.fibre_limit = reader.number("fibre_limit", positive, material.fibre_limit);
  if (reader.has("fibre_direction")) {
    body.fibre_direction = reader.vector("fibre_direction", context.dimension);
    if (body.fibre_direction->norm() == 0) refuse(reader.spot("fibre_direction"), "has no length", "give a direction");
    body.fibre_direction->normalize();
  }
  material.thickness = reader.number("thickness", positive, 0);
  material.bending_thickness_ratio = reader.number("bending_thickness_ratio", {0, 1, true, false, "a number above 0 and at most 1"}, 1);
}

std::uint8_t read_directions(const TableReader& reader, int dimension) {
  if (!reader.has("directions")) return static_cast<std::uint8_t>((1 << dimension) - 1);
  std::uint8_t mask = 0;
  for (const std::string& name : reader.texts("directions")) {
    const std::size_t axis = name.size() == 1 ? std::string("xyz").find(name) : std::string::npos;
    if (axis == std::string::npos || static_cast<int>(axis) >= dimension)
      refuse(reader.spot("directions"), "\"" + name + "\" is no direction",
             dimension == 2 ? "give \"x\" or \"y\"" : "give \"x\", \"y\" or \"z\"");
    mask |= static_cast<std::uint8_t>(1 << axis);
  }
  if (mask == 0) refuse(reader.spot("directions"), "is empty", "name the directions that are held, or leave it out to hold all");
  return mask;
}

void read_stiffness_map(const TableReader& reader, const SceneContext& context, BodySpec& body) {
  const auto entries = reader.tables("stiffness_map");
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string path = entry_path(reader.path() + ".stiffness_map", *entries[i], i);
    const TableReader entry(*entries[i], path, {"name", "region", "scale"});
    body.stiffness_map.push_back({read_shape(entry.table("region"), path + ".region", context, true), entry.number("scale", positive)});
  }
}

}  // namespace

ShapeSpec read_shape(const toml::table& table, const std::string& path, const SceneContext& context, bool region) {
  std::vector<std::string> all_keys{"type"};
  for (const std::string& type : shape_types)
    for (const std::string& key : shape_keys(type)) all_keys.push_back(key);
  for (const char* key : {"directions", "name"}) all_keys.push_back(key);
  const std::string type = TableReader(table, path, all_keys).choice("type", shape_types);
  std::vector<std::string> keys = shape_keys(type);
  if (region) keys.insert(keys.end(), {"directions", "name"});
  const TableReader reader(table, path, keys);
  ShapeSpec shape;
  shape.spot = reader.spot();
  shape.type = shape_type(type);
  if (type == "polygon") read_polygon(reader, context, shape);
  if (type == "box") read_box(reader, context, region, shape);
  if (type == "cylinder") read_cylinder(reader, context, shape);
  if (type == "sphere") shape.center = reader.vector("center", context.dimension), shape.radius = reader.number("radius", positive);
  if (type == "mesh" || type == "shell") {
    if (context.dimension == 2) refuse(reader.spot("type"), "a " + type + " needs dimension = 3", "use a polygon in 2-D");
    shape.file = existing_file(reader, "file", context);
    shape.unit = read_unit(reader, 1e-3);
  }
  if (type == "shell") {
    shape.thickness = reader.number("thickness", positive);
    shape.layers = static_cast<int>(reader.integer("layers", {1, 100, false, false, "a whole number from 1"}, 1));
  }
  if (type == "patient") shape.part = reader.choice("part", {"leaflets", "blood", "aorta"});
  for (const char* key : {"subtract", "intersect"}) {
    const auto entries = reader.tables(key);
    for (std::size_t i = 0; i < entries.size(); ++i)
      (key[0] == 's' ? shape.subtract : shape.intersect)
          .push_back(read_shape(*entries[i], path + "." + key + "." + std::to_string(i), context, region));
  }
  return shape;
}

sim::FluidMaterial read_fluid_material(const toml::table& table, const std::string& path) {
  const TableReader reader(table, path, {"density", "rheology", "viscosity", "consistency", "index", "yield_stress", "hematocrit"});
  const std::string rheology = reader.choice("rheology", {"newtonian", "herschel-bulkley", "casson", "blood"}, "newtonian");
  const auto only = [&](std::initializer_list<const char*> wanted) {
    for (const char* key : {"viscosity", "consistency", "index", "yield_stress", "hematocrit"}) {
      if (!reader.has(key)) continue;
      bool allowed = false;
      for (const char* one : wanted) allowed = allowed || std::string(one) == key;
      if (!allowed) refuse(reader.spot(key), "does not belong to rheology \"" + rheology + "\"", "take it out or choose another rheology");
    }
  };
  sim::FluidMaterial material;
  if (rheology == "newtonian") {
    only({"viscosity"});
    material.rheology =
        sim::Newtonian{reader.has("rheology") ? reader.number("viscosity", not_negative) : reader.number("viscosity", not_negative, 0)};
  } else if (rheology == "herschel-bulkley") {
    only({"consistency", "index", "yield_stress"});
    material.rheology = sim::HerschelBulkley{reader.number("consistency", positive), reader.number("index", positive),
                                             reader.number("yield_stress", not_negative, 0)};
  } else if (rheology == "casson") {
    only({"viscosity", "yield_stress"});
    material.rheology = sim::Casson{reader.number("viscosity", positive), reader.number("yield_stress", not_negative)};
  } else {
    only({"hematocrit"});
    const double hematocrit = reader.number("hematocrit", {0, 75, false, false, "per cent of cells, 0 to 75"});
    if (hematocrit > 0 && hematocrit < 1) refuse(reader.spot("hematocrit"), "looks like a fraction", "give per cent, as in 45");
    material.rheology = blood_rheology(hematocrit);
    material.density = reader.number("density", positive, blood_density(hematocrit));
    return material;
  }
  material.density = reader.number("density", positive);
  return material;
}

BodySpec read_body(const toml::table& table, const std::string& path, const SceneContext& context) {
  const TableReader reader(table, path,
                           {"name", "kind", "shape", "material", "velocity", "fixed", "plane", "stiffness_map", "damping", "motion"});
  BodySpec body;
  body.spot = reader.spot();
  body.name = reader.text("name");
  if (!usable_name(body.name)) refuse(reader.spot("name"), "\"" + body.name + "\" can't be a name", "use letters, digits, - and _");
  const std::string kind = reader.choice("kind", {"fluid", "elastic", "wall"});
  body.kind = kind == "fluid" ? sim::Kind::fluid : kind == "wall" ? sim::Kind::wall : sim::Kind::elastic;
  body.shape = read_shape(reader.table("shape"), path + ".shape", context);
  const auto belongs = [&](std::initializer_list<const char*> keys, const char* wanted) {
    for (const char* key : keys)
      if (reader.has(key) && kind != wanted)
        refuse(reader.spot(key), std::string("a ") + kind + " body has no " + key, std::string("it belongs to kind = \"") + wanted + "\"");
  };
  belongs({"fixed", "plane", "stiffness_map", "damping"}, "elastic");
  belongs({"motion"}, "wall");
  if (kind == "wall") {
    if (reader.has("material")) refuse(reader.spot("material"), "a wall has no material", "take it out, or make the body elastic");
    if (reader.has("velocity")) refuse(reader.spot("velocity"), "a wall does not drift", "use motion = { velocity = [...] }");
    return body;
  }
  if (reader.has("velocity")) body.velocity = read_vector_formula(reader, "velocity", context, false);
  if (kind == "fluid") {
    body.fluid = read_fluid_material(reader.table("material"), path + ".material");
    return body;
  }
  const TableReader material(reader.table("material"), path + ".material",
                             {"density", "law", "youngs_modulus", "poisson_ratio", "fibre_modulus", "fibre_stiffening", "fibre_limit",
                              "fibre_direction", "damping", "stiffness_map", "plane", "thickness", "bending_thickness_ratio"});
  read_elastic_material(material, context, body);
  for (const TableReader* place : {&material, &reader}) {
    body.elastic.damping = place->number("damping", not_negative, body.elastic.damping);
    if (place->has("plane")) {
      if (context.dimension == 3) refuse(place->spot("plane"), "has no meaning in 3-D", "take it out");
      body.elastic.plane_stress = place->choice("plane", {"strain", "stress"}) == "stress";
    }
    read_stiffness_map(*place, context, body);
  }
  const auto regions = reader.tables("fixed");
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const std::string region_path = entry_path(path + ".fixed", *regions[i], i);
    FixedSpec fixed;
    fixed.region = read_shape(*regions[i], region_path, context, true);
    std::vector<std::string> anything;
    for (const auto& [key, value] : *regions[i]) anything.emplace_back(key.str());
    fixed.directions = read_directions(TableReader(*regions[i], region_path, anything), context.dimension);
    body.fixed.push_back(fixed);
  }
  return body;
}

MotionSpec read_motion(const toml::table& table, const std::string& path, const SceneContext& context) {
  const TableReader reader(table, path, {"velocity", "angular_velocity", "center", "axis", "table", "surface_velocity"});
  MotionSpec motion;
  motion.spot = reader.spot();
  if (reader.has("surface_velocity")) {
    for (const char* key : {"velocity", "angular_velocity", "center", "axis", "table"})
      if (reader.has(key)) refuse(reader.spot(key), "does not go with surface_velocity", "a wall either moves or stands and drags");
    motion.surface_velocity = reader.vector("surface_velocity", context.dimension);
    return motion;
  }
  if (reader.has("center")) motion.center = reader.vector("center", context.dimension);
  if (reader.has("axis")) {
    motion.axis = reader.vector("axis", 3);
    if (motion.axis.norm() == 0) refuse(reader.spot("axis"), "has no length", "give the axis of rotation");
    motion.axis.normalize();
  }
  const Eigen::Vector3d velocity = reader.has("velocity") ? reader.vector("velocity", context.dimension) : Eigen::Vector3d::Zero();
  const double turn = reader.number("angular_velocity", any_number, 0);
  std::vector<std::vector<double>> rows{{0.0, 1.0}};
  if (reader.has("table")) {
    rows = read_number_table(existing_file(reader, "table", context), reader.spot("table"));
  } else if (!reader.has("velocity") && !reader.has("angular_velocity")) {
    refuse(reader.spot(), "says nothing that moves", "give velocity, angular_velocity, table or surface_velocity");
  }
  const std::size_t columns = rows.front().size(), axes = static_cast<std::size_t>(context.dimension);
  const bool factor = columns == 2;
  if (!factor && columns != axes + 1 && columns != axes + 2)
    refuse(reader.spot("table"), "has " + std::to_string(columns) + " columns",
           "give time and a factor, or time, the velocity along each axis and, if it turns, the angular velocity");
  for (std::size_t axis = 0; axis < axes; ++axis)
    for (const auto& row : rows) {
      if (factor && velocity[axis] == 0) break;
      motion.velocity[axis].time.push_back(row[0]);
      motion.velocity[axis].value.push_back(factor ? row[1] * velocity[axis] : row[axis + 1]);
    }
  for (const auto& row : rows) {
    if (factor ? turn == 0 : columns != axes + 2) break;
    motion.angular_velocity.time.push_back(row[0]);
    motion.angular_velocity.value.push_back(factor ? row[1] * turn : row[axes + 1]);
  }
  return motion;
}

}  // namespace app
