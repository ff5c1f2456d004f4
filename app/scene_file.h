// A scene as the user wrote it: the TOML of docs/scene_files.md as plain data, checked but not yet made of particles. SI units; in 2-D the
// third component of every vector is 0. Shapes keep the text's own numbers; build_case turns them into particles.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "app/formula.h"
#include "app/scene_error.h"
#include "sim/scene_description.h"

namespace app {

enum class ShapeType { box, sphere, cylinder, polygon, mesh, shell, patient };
struct ShapeSpec {
  Spot spot;
  ShapeType type = ShapeType::box;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  // box
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                              // sphere
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();  // cylinder
  double radius = 0, inner_radius = 0;                                           // sphere, cylinder
  std::vector<Eigen::Vector2d> points;                                           // polygon
  double height_from = 0, height_to = 0;                                         // polygon in 3-D: extruded along z
  std::filesystem::path file;                                                    // mesh, shell: absolute
  double unit = 1;                                                               // m per unit of the file
  double thickness = 0;                                                          // shell, m
  int layers = 1;                                                                // shell
  std::string part;                                                              // patient: "leaflets", "blood" or "aorta"
  std::vector<ShapeSpec> subtract, intersect;
};

struct FixedSpec {
  ShapeSpec region;
  std::uint8_t directions = 7;  // bit k: axis k
};
struct StiffnessSpec {
  ShapeSpec region;
  double scale = 1;
};

struct BodySpec {
  Spot spot;
  std::string name;
  sim::Kind kind = sim::Kind::fluid;  // fluid, elastic or wall
  ShapeSpec shape;
  sim::FluidMaterial fluid;
  sim::ElasticMaterial elastic;
  std::optional<Eigen::Vector3d> fibre_direction;  // fibre-reinforced; absent: circumferential on leaflets, else along x
  VectorFormula velocity;
  std::vector<FixedSpec> fixed;
  std::vector<StiffnessSpec> stiffness_map;
};

struct MotionSpec {
  Spot spot;
  int body = -1;
  std::array<sim::TimeTable, 3> velocity;
  sim::TimeTable angular_velocity;
  Eigen::Vector3d center = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitZ(), surface_velocity = Eigen::Vector3d::Zero();
};

struct LoadSpec {
  Spot spot;
  std::string name;
  int body = -1;
  std::optional<ShapeSpec> region;
  std::optional<Eigen::Vector3d> force;
  std::optional<VectorFormula> acceleration;
  std::optional<double> pressure;
  double ramp = 0;
  std::optional<sim::TimeTable> factor;
};

struct PortSpec {
  Spot spot;
  sim::Port<3> port;
  bool has_plane = true, has_condition = true;  // false: build_case takes them from the patient
};

struct ProbeSpec {
  Spot spot;
  sim::Probe<3> probe;  // body filled in
};

// What `cusp accuracy` and `cusp validate` compare a probe with.
struct ReferenceSpec {
  Spot spot;
  std::string probe;                                   // name of the probe
  std::vector<std::pair<std::string, double>> values;  // component ("" for a scalar, "x", "von_mises"...) and value
  std::string component;                               // of a table: "x", "von_mises"... ("" for a scalar)
  std::filesystem::path table;                         // or a table, absolute
  std::optional<double> time;                          // s; absent = the end
  std::string source;
  double uncertainty = 0;
  std::optional<double> limit;  // relative error up to which a validation case passes
};

struct PlaneSpec {
  Eigen::Vector3d center, normal;
};
// A pressure over a beat: a table, or two numbers that scale the built-in wave, or nothing (the built-in wave).
struct WaveSpec {
  std::optional<sim::TimeTable> table;        // s, Pa
  std::optional<double> systolic, diastolic;  // Pa
};
struct PatientSpec {
  Spot spot;
  std::filesystem::path aorta;  // empty: the built-in synthetic patient
  double aorta_unit = 1e-3;
  std::filesystem::path leaflets;  // the user's leaflet mesh; empty: the template
  double leaflets_unit = 1e-3;
  bool build_root = false;
  std::optional<double> annulus_diameter, junction_diameter;
  std::optional<PlaneSpec> annulus, sinotubular_junction;
  std::vector<Eigen::Vector3d> commissures;
  std::optional<double> coaptation, over_closure;  // m, of the leaflet template
  double below_annulus = 0.012, above_junction = 0.030,
         extension = 0.010;  // m: where the vessel is cut and how far it is continued straight
  double heart_rate = 75;    // 1/min
  WaveSpec ventricle_pressure, aortic_pressure;
};

// A valve that a scene built from bodies declares, so that it gets clinical metrics.
struct ValveSpec {
  Spot spot;
  Eigen::Vector3d annulus_center, axis;
  double annulus_radius = 0, commissure_height = 0, commissure_radius = 0;
  std::vector<int> leaflets;
  int ventricle_port = -1, aorta_port = -1;
};

// Particles moved from their lattice at the start (jitter.h).
struct StartSpec {
  double jitter = 0;  // spacings
  std::uint64_t seed = 1;
};

struct SceneFile {
  std::filesystem::path path;         // as given; error messages and relative paths
  std::string text;                   // as read
  std::vector<std::string> settings;  // the --set applied on top
  std::string title;
  int dimension = 3;
  double spacing = 0;
  Spot spacing_spot;
  sim::Domain<3> domain;
  sim::TimeSettings time;
  sim::SchemeSettings scheme;
  sim::Limits limits;
  StartSpec start;
  std::optional<Eigen::Vector3d> gravity;
  std::vector<BodySpec> bodies;
  std::vector<LoadSpec> loads;
  std::vector<MotionSpec> motions;
  std::vector<PortSpec> ports;
  std::vector<ProbeSpec> probes;
  std::vector<ReferenceSpec> references;
  std::optional<PatientSpec> patient;
  std::optional<ValveSpec> valve;
};

// Reads `path` with `settings` ("dotted.key=value") applied. Throws SceneError.
SceneFile read_scene_file(const std::filesystem::path& path, const std::vector<std::string>& settings = {});
// The same from text; `path` is for messages and relative paths only.
SceneFile parse_scene_text(const std::string& text, const std::filesystem::path& path, const std::vector<std::string>& settings = {});

// A table of two or more columns of numbers separated by commas; `#` lines and one heading are skipped. Throws SceneError.
std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file, const Spot& asked_by);
// A (time, value) table with increasing times.
sim::TimeTable read_time_table(const std::filesystem::path& file, const Spot& asked_by);

}  // namespace app
