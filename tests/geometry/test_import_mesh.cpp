// Every shared mesh imports with a right report, or is refused for the right reason (compare the meshes' provenance notes).
#include "geometry/import_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>

#include "geometry/cut_domain.h"
#include "geometry/mesh_makers.h"
#include "geometry/root_frame.h"
#include "geometry/synthetic_aorta.h"

namespace {

using namespace geometry;
using Eigen::Vector3d;
using test::error_of;
using test::TemporaryFile;

double degrees_between(const Vector3d& a, const Vector3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180 / std::numbers::pi;
}

bool has_defect(const ImportResult& result, const std::string& kind) {
  return std::any_of(result.defects.begin(), result.defects.end(), [&](const Defect& d) { return d.kind == kind; });
}

const OpenEnd* end_named(const ImportResult& result, const std::string& name) {
  const auto found = std::find_if(result.open_ends.begin(), result.open_ends.end(), [&](const OpenEnd& e) { return e.name == name; });
  return found == result.open_ends.end() ? nullptr : &*found;
}

void expect_closed_lumen(const ImportResult& result) {
  const MeshTopology topology = measure_topology(result.lumen);
  EXPECT_TRUE(topology.closed());
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.mismatched_edges, 0u);
  EXPECT_GT(signed_volume(result.lumen), 0);
  EXPECT_EQ(result.cap_of_triangle.size(), result.lumen.triangles.size());
  EXPECT_EQ(result.triangles_out, result.lumen.triangles.size());
}

std::string patient_stl(double units_per_metre) { return test::stl_bytes(make_synthetic_patient().lumen, units_per_metre); }

TEST(ImportMesh, ReadsTheSyntheticPatientInAnyUnits) {
  for (const auto& [unit, scale] : {std::pair{"mm", 1e3}, {"cm", 1e2}, {"m", 1.0}}) {
    const TemporaryFile file(".stl", patient_stl(scale));
    const ImportResult result = import_mesh(file.path());
    EXPECT_EQ(result.units, unit);
    EXPECT_TRUE(result.units_proposed);
    ASSERT_FALSE(result.warnings.empty());
    EXPECT_NE(result.warnings[0].find("units taken as"), std::string::npos);
    expect_closed_lumen(result);
    ASSERT_TRUE(result.root) << result.root_reason;
    EXPECT_LT(result.root->annulus.center.norm(), 0.003);
    ASSERT_EQ(result.open_ends.size(), 2u);
    ASSERT_NE(end_named(result, "ventricle"), nullptr);
    ASSERT_NE(end_named(result, "ascending"), nullptr);
    EXPECT_LT(end_named(result, "ventricle")->normal.z(), -0.99);
    EXPECT_FALSE(end_named(result, "ascending")->open_in_file);
    EXPECT_GT(std::count(result.cap_of_triangle.begin(), result.cap_of_triangle.end(), 0), 0);
    EXPECT_LT(result.centreline.points.front().z(), result.centreline.points.back().z());
  }
}

TEST(ImportMesh, TheUserNamesEndsAndUnits) {
  const TemporaryFile file(".stl", test::stl_bytes(test::make_cylinder(0.011, 0.08), 1e3));
  ImportOptions options;
  options.units = "mm";
  options.ends = {{"outlet", "ascending"}};
  const ImportResult result = import_mesh(file.path(), options);
  EXPECT_FALSE(result.units_proposed);
  EXPECT_NE(end_named(result, "ascending"), nullptr);
  EXPECT_FALSE(result.root);
  EXPECT_NE(result.root_reason.find("--build-root"), std::string::npos);
  options.ends = {{"fourth", "ascending"}};
  EXPECT_NE(error_of([&] { import_mesh(file.path(), options); }).find("no end named \"fourth\""), std::string::npos);
  options = {};
  options.units = "mm";
  options.build_root = true;
  const ImportResult built = import_mesh(file.path(), options);
  ASSERT_TRUE(built.root) << built.root_reason;
  EXPECT_TRUE(built.root->built);
  EXPECT_EQ(measure_topology(cut_domain(built.lumen, built.centreline, *built.root).surface).closed(), true);
}

TEST(ImportMesh, RefusesPiecesAndUnknownParts) {
  TriangleMesh two = test::make_cylinder(0.011, 0.08);
  test::append(two, test::make_cylinder(0.011, 0.08), {0.05, 0, 0});
  const TemporaryFile file(".stl", test::stl_bytes(two, 1e3));
  const std::string error = error_of([&] { import_mesh(file.path()); });
  EXPECT_NE(error.find("2 separate surfaces"), std::string::npos) << error;
  ImportOptions options;
  options.part = "aorta";
  EXPECT_NE(error_of([&] { import_mesh(file.path(), options); }).find("no part \"aorta\""), std::string::npos);
}

TEST(ImportMesh, IsDeterministic) {
  const TemporaryFile file(".stl", patient_stl(1e3));
  const ImportResult one = import_mesh(file.path()), two = import_mesh(file.path());
  EXPECT_EQ(one.lumen.vertices, two.lumen.vertices);
  EXPECT_EQ(one.root->annulus.center, two.root->annulus.center);
  EXPECT_EQ(one.centreline.points, two.centreline.points);
}

// --- the shared meshes
// ---------------------------------------------------------------------------------------------------------------------

ImportResult import_shared(const std::string& path, const ImportOptions& options = {}) {
  const std::clock_t start = std::clock();  // processor time: the machine may be busy with other things
  ImportResult result = import_mesh(path, options);
  EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 60) << path;
  expect_closed_lumen(result);
  return result;
}

#define SHARED_MESH(variable, name)                     \
  const std::string variable = test::shared_mesh(name); \
  if (variable.empty()) GTEST_SKIP() << "the shared mesh " << name << " is not here; set CUSP_SHARED"

TEST(SharedMeshes, CtLumenHasItsRoot) {
  SHARED_MESH(path, "ctroot/lv_aorta_lumen_smooth_closed.stl");
  const ImportResult result = import_shared(path);
  EXPECT_EQ(result.triangles_in, 31744u);
  EXPECT_EQ(result.units, "mm");
  EXPECT_TRUE(result.defects.empty());
  ASSERT_TRUE(result.root) << result.root_reason;
  const AorticRoot& root = *result.root;
  EXPECT_LT((root.annulus.center - 1e-3 * Vector3d(-12.8, 0.9, -95.5)).norm(), 0.003);
  EXPECT_LT(degrees_between(root.annulus.normal, {0.85, 0.31, 0.42}), 15);
  EXPECT_NEAR(root.sinuses.mean_diameter, 0.032, 0.0032);
  EXPECT_NEAR(root.sinotubular_junction.mean_diameter, 0.027, 0.0027);
  const RootFrame frame = make_root_frame(root);
  const Vector3d above = root.sinotubular_junction.center + 0.03 * frame.axis;
  double ascending = 0;  // the widest bore of the ascending aorta
  for (std::size_t i = 0; i < result.centreline.size(); ++i) {
    if ((result.centreline.points[i] - above).norm() > 0.02) continue;
    ascending = std::max(ascending, section_around(result.lumen, result.centreline.points[i], result.centreline.tangents[i]).diameter());
  }
  EXPECT_NEAR(ascending, 0.031, 0.0031);
  const CutDomain domain = cut_domain(result.lumen, result.centreline, root);
  EXPECT_TRUE(measure_topology(domain.surface).closed());
  EXPECT_TRUE(self_intersections(domain.surface).empty());
  EXPECT_NEAR(signed_volume(domain.surface), 55e-6, 15e-6);
  EXPECT_TRUE(domain.warnings.empty());
}

TEST(SharedMeshes, CtRootStandsNoiseAndCutEnds) {
  SHARED_MESH(path, "ctroot/lv_aorta_lumen_smooth_closed.stl");
  const ImportResult reference = import_mesh(path);
  ASSERT_TRUE(reference.root);
  TriangleMesh noisy = reference.lumen;
  std::uint32_t state = 1;
  for (Vector3d& v : noisy.vertices)
    for (int k = 0; k < 3; ++k) v[k] += 0.4e-3 * (double((state = state * 1664525u + 1013904223u) >> 8) / (1 << 23) - 1);
  const CutDomain domain = cut_domain(reference.lumen, reference.centreline, *reference.root);
  for (const TriangleMesh* mesh : std::initializer_list<const TriangleMesh*>{&noisy, &domain.surface}) {
    const TemporaryFile file(".stl", test::stl_bytes(*mesh, 1e3));
    const ImportResult result = import_mesh(file.path());
    ASSERT_TRUE(result.root) << result.root_reason;
    EXPECT_LT((result.root->annulus.center - reference.root->annulus.center).norm(), 0.0008);
    EXPECT_LT(degrees_between(result.root->annulus.normal, reference.root->annulus.normal), 3);
    EXPECT_LT((result.root->sinotubular_junction.center - reference.root->sinotubular_junction.center).norm(), 0.001);
  }
}

TEST(SharedMeshes, CtAortaWithoutVentricleIsToldUnresolved) {
  for (const char* name : {"ctroot/aorta_root_smooth_closed.stl", "ctroot/aorta_root_staircase.stl"}) {
    SHARED_MESH(path, name);
    const ImportResult result = import_shared(path);
    EXPECT_FALSE(result.root) << "a wrong annulus in silence";
    EXPECT_NE(result.root_reason.find("three sinuses found"), std::string::npos) << result.root_reason;
    EXPECT_NE(result.root_reason.find("annulus is unresolved"), std::string::npos) << result.root_reason;
    ImportOptions options;  // the user's plane settles it
    options.root.annulus = PlaneOverride{1e-3 * Vector3d(-12.8, 0.9, -95.5), {0.85, 0.31, 0.42}};
    const ImportResult settled = import_mesh(path, options);
    ASSERT_TRUE(settled.root) << settled.root_reason;
    EXPECT_FALSE(settled.root->built);
    EXPECT_LT((settled.root->annulus.center - options.root.annulus->center).norm(), 0.010);
    EXPECT_NEAR(settled.root->sinuses.mean_diameter, 0.032, 0.0032);
    EXPECT_NEAR(settled.root->sinotubular_junction.mean_diameter, 0.027, 0.0027);
    EXPECT_TRUE(measure_topology(cut_domain(settled.lumen, settled.centreline, *settled.root).surface).closed());
    options = {};
    options.build_root = true;
    const ImportResult built = import_mesh(path, options);
    ASSERT_TRUE(built.root) << built.root_reason;
    EXPECT_TRUE(built.root->built);
  }
}

TEST(SharedMeshes, CtVentricleHasNoRoot) {
  SHARED_MESH(path, "ctroot/lv_cavity_smooth_closed.stl");
  const ImportResult result = import_shared(path);
  EXPECT_EQ(result.triangles_in, 16888u);
  EXPECT_FALSE(result.root);
  EXPECT_NEAR(signed_volume(result.lumen), 49e-6, 1e-6);
}

TEST(SharedMeshes, CoarctationHasFiveEndsAndNoRoot) {
  SHARED_MESH(path, "coa/wall_aorta.stl");
  const ImportResult result = import_shared(path);
  EXPECT_EQ(result.triangles_in, 76968u);
  EXPECT_FALSE(result.root);
  EXPECT_NE(result.root_reason.find("no root"), std::string::npos) << result.root_reason;
  ASSERT_EQ(result.open_ends.size(), 5u);
  for (const char* cap : {"inlet", "outlet1", "outlet2", "outlet3", "outlet4"}) {
    LoadedMesh supplied = load_mesh(test::shared_mesh(std::string("coa/") + cap + ".stl"));
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& v : supplied.mesh.vertices) middle += 1e-3 * v / double(supplied.mesh.vertices.size());
    const double area = 1e-6 * surface_area(supplied.mesh);
    const auto nearest = std::min_element(result.open_ends.begin(), result.open_ends.end(), [&](const OpenEnd& a, const OpenEnd& b) {
      return (a.center - middle).norm() < (b.center - middle).norm();
    });
    EXPECT_LT((nearest->center - middle).norm(), 0.001) << cap;
    EXPECT_NEAR(nearest->area, area, 0.03 * area) << cap;
    const std::string role = std::string(cap) == "inlet" ? "ascending" : std::string(cap) == "outlet4" ? "descending" : "branch";
    EXPECT_EQ(nearest->role, role) << cap;
    EXPECT_TRUE(nearest->open_in_file);
  }
}

TEST(SharedMeshes, AbdominalAortaIsTurnedOutAndHasNoRoot) {
  SHARED_MESH(path, "abdominal/aorta-surface-open-ends.stl");
  const ImportResult result = import_shared(path);
  EXPECT_EQ(result.triangles_in, 11887u);
  EXPECT_FALSE(result.root);
  ASSERT_TRUE(has_defect(result, "inward_normals"));
  for (const Defect& defect : result.defects) EXPECT_TRUE(defect.repaired) << defect.kind;
  std::vector<double> diameters;
  for (const OpenEnd& end : result.open_ends) diameters.push_back(2e3 * end.radius);
  std::sort(diameters.begin(), diameters.end());
  ASSERT_EQ(diameters.size(), 3u);
  EXPECT_NEAR(diameters[0], 8.8, 0.1);
  EXPECT_NEAR(diameters[1], 8.8, 0.1);
  EXPECT_NEAR(diameters[2], 15.4, 0.1);
  ImportOptions options;
  options.build_root = true;
  const ImportResult built = import_shared(path, options);
  ASSERT_TRUE(built.root);
  EXPECT_TRUE(built.root->built);
}

TEST(SharedMeshes, NormalisedHeartAsksForUnits) {
  for (const char* name : {"leftheart/lv_template.vtp", "leftheart/lv_template_normalised.obj"}) {
    SHARED_MESH(path, name);
    const std::string error = error_of([&] { import_mesh(path); });
    EXPECT_NE(error.find("units"), std::string::npos) << error;
    EXPECT_NE(error.find("--units"), std::string::npos) << error;
    const LoadedMesh loaded = load_mesh(path);
    EXPECT_EQ(loaded.mesh.triangles.size(), 22608u);
    ASSERT_EQ(loaded.group_names.size(), 3u);
    EXPECT_EQ(std::count(loaded.group_of_triangle.begin(), loaded.group_of_triangle.end(), 1), 2342);  // mitral stump
    EXPECT_EQ(std::count(loaded.group_of_triangle.begin(), loaded.group_of_triangle.end(), 2), 1004);  // aortic outlet
    ImportOptions options;
    options.units = "240 mm";
    EXPECT_EQ(import_shared(path, options).open_ends.size(), 2u);
  }
}

TEST(SharedMeshes, VisibleHumanWallsAreReducedOrRefused) {
  for (const char* name : {"vhf/vhf_aortic_valve_m.stl", "vhf/vhf_aorta_assembly_m.stl"}) {
    SHARED_MESH(path, name);
    EXPECT_NE(error_of([&] { import_mesh(path); }).find("double wall"), std::string::npos) << name;
  }
  const std::pair<const char*, std::size_t> vessels[] = {{"vhf/vhf_ascending_aorta_m.stl", 2u}, {"vhf/vhf_aortic_arch_m.stl", 5u}};
  for (const auto& [name, ends] : vessels) {
    SHARED_MESH(path, name);
    const ImportResult result = import_shared(path);
    EXPECT_EQ(result.units, "m");
    EXPECT_TRUE(has_defect(result, "double_wall"));
    EXPECT_EQ(result.open_ends.size(), ends) << name;
    EXPECT_FALSE(result.root);
    double widest = 0;
    for (const OpenEnd& end : result.open_ends) widest = std::max(widest, 2 * end.radius);
    EXPECT_NEAR(widest, 0.02197, 2e-4) << "the inner rim, not the outer one of 27.2 mm";
  }
  SHARED_MESH(descending, "vhf/vhf_descending_aorta_a_m.stl");
  EXPECT_EQ(import_shared(descending).open_ends.size(), 2u);
  SHARED_MESH(ventricle, "vhf/vhf_left_ventricle_m.stl");
  EXPECT_FALSE(import_shared(ventricle).root);
}

TEST(SharedMeshes, AWholeHeartAsksForOnePart) {
  SHARED_MESH(path, "vhf/VH_F_Heart_v1.0.glb");
  const std::string error = error_of([&] { import_mesh(path); });
  EXPECT_NE(error.find("separate surfaces"), std::string::npos) << error;
  EXPECT_NE(error.find("VHF_ascending_aorta"), std::string::npos) << error;
  ImportOptions options;
  options.part = "VHF_ascending_aorta";
  const ImportResult result = import_shared(path, options);
  EXPECT_EQ(result.units, "m");
  EXPECT_EQ(result.triangles_in, 5344u);
  EXPECT_EQ(result.open_ends.size(), 2u);
}

}  // namespace
