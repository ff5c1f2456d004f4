#include "sim/contact.h"

#include <gtest/gtest.h>

#include "tests/sim/shell_scenes.h"

namespace {

using namespace shell_scenes;

// Two free sheets, the second `gap` above the first and shifted by a third of a spacing.
sim::SceneDescription<3> two_sheets(double gap, int held = 0) {
  auto scene = strip(6e-3, 6e-3, 1e-3, held, tissue(0.45));
  const std::size_t count = scene.particles.size();
  for (std::size_t i = 0; i < count; ++i)
    append<3>(scene, scene.particles.position[i] + Eigen::Vector3d(0.33e-3, 0.2e-3, gap), {0, 0, 1}, 1e-6,
              held > 0 && scene.particles.fixed[i]);
  close_body(scene, tissue(0.45), "upper");
  return scene;
}

struct Evaluated {
  sim::ContactReport report;
  std::vector<Eigen::Vector3d> force;
};
Evaluated evaluate(sim::Contact<3>& contact, const sim::ShellElasticity<3>& shells, const std::vector<Eigen::Vector3d>& x) {
  std::vector<Eigen::Vector3d> still(x.size(), Eigen::Vector3d::Zero()), normal(x.size());
  std::vector<double> area(x.size());
  sim::shell_normals_and_areas<3>(shells, x, normal, area);
  Evaluated result;
  result.force.assign(x.size(), Eigen::Vector3d::Zero());
  result.report = sim::add_contact_forces<3>(contact, shells, x, still, normal, result.force);
  return result;
}

// Moves the upper sheet to a given height above the lower one.
std::vector<Eigen::Vector3d> at_gap(const sim::ShellElasticity<3>& shells, double gap) {
  auto x = shells.rest_position;
  for (std::size_t i = x.size() / 2; i < x.size(); ++i) x[i].z() = gap;
  return x;
}

// No force at the contact distance; below it the pressure is k o (1 + (o/d)^2) with both halves of k, also when pushed through; momentum
// is conserved.
TEST(Contact, SignedPenaltyBetweenSheets) {
  const auto scene = two_sheets(2e-3);
  const auto shells = sim::build_shells(scene);
  auto contact = sim::build_contact<3>(scene, shells);
  const double d = contact.settings.distance;
  EXPECT_NEAR(d, 0.5e-3, 1e-12);
  EXPECT_EQ(evaluate(contact, shells, at_gap(shells, 1.01 * d)).report.contacts, 0);
  for (double gap : {0.5 * d, 0.1 * d, -0.3 * d}) {
    const Evaluated found = evaluate(contact, shells, at_gap(shells, gap));
    EXPECT_NEAR(found.report.deepest_overlap, d - gap, 1e-9);
    EXPECT_EQ(found.report.crossed > 0, gap < 0);
    Eigen::Vector3d total = Eigen::Vector3d::Zero(), upper = total;
    for (std::size_t i = 0; i < found.force.size(); ++i) {
      total += found.force[i];
      if (i >= found.force.size() / 2) upper += found.force[i];
    }
    const double relative = (d - gap) / d, pressure = 5e7 * (d - gap) * (1 + relative * relative);
    EXPECT_LT(total.norm(), 1e-12 * upper.norm());
    EXPECT_GT(upper.z(), 0);                                    // always back to its own side
    EXPECT_NEAR(upper.z() / 36e-6, pressure, 0.25 * pressure);  // the rim, which looks past the other's edge, counts less
    const std::size_t inner = found.force.size() / 2 + 2 * 6 + 2;
    EXPECT_NEAR(found.force[inner].z() / 1e-6, pressure, 0.05 * pressure);
  }
}

// The film's pressure on sheets that part or close at speed u, full below the contact distance and none beyond 1.5 of it, is film * u.
TEST(Contact, FilmResistsPartingAndClosing) {
  const auto scene = two_sheets(2e-3);
  const auto shells = sim::build_shells(scene);
  sim::ContactSettings settings;
  settings.film = 3000;
  auto contact = sim::build_contact<3>(scene, shells, settings);
  const double d = contact.settings.distance, speed = 0.1;
  for (double share : {1.0, 0.5, 0.0}) {
    const auto x = at_gap(shells, d * (1.5 - 0.5 * share) + 1e-9);
    std::vector<Eigen::Vector3d> velocity(x.size(), Eigen::Vector3d::Zero()), normal(x.size()), force(x.size(), Eigen::Vector3d::Zero());
    for (std::size_t i = x.size() / 2; i < x.size(); ++i) velocity[i].z() = speed;
    std::vector<double> area(x.size());
    sim::shell_normals_and_areas<3>(shells, x, normal, area);
    sim::add_contact_forces<3>(contact, shells, x, velocity, normal, force);
    const std::size_t inner = x.size() / 2 + 2 * 6 + 2;
    EXPECT_NEAR(force[inner].z() / 1e-6, -share * settings.film * speed, 0.05 * settings.film * speed) << share;
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (const auto& f : force) total += f;
    EXPECT_LT(total.norm(), 1e-12);
  }
}

// What lies nearer than the contact distance at the start does not push.
TEST(Contact, InitialGapsDoNotPush) {
  const auto scene = two_sheets(0.2e-3);
  const auto shells = sim::build_shells(scene);
  auto contact = sim::build_contact<3>(scene, shells);
  EXPECT_EQ(evaluate(contact, shells, shells.rest_position).report.contacts, 0);
  EXPECT_GT(evaluate(contact, shells, at_gap(shells, 0.05e-3)).report.contacts, 0);
}

// A search kept over motions within its skin gives the forces of a fresh one.
TEST(Contact, KeptSearchEqualsFresh) {
  const auto scene = two_sheets(1e-3);
  const auto shells = sim::build_shells(scene);
  auto kept = sim::build_contact<3>(scene, shells);
  sim::update_contact_search<3>(kept, shells, at_gap(shells, 0.5e-3));
  auto x = at_gap(shells, 0.35e-3);
  for (std::size_t i = 0; i < x.size(); ++i) x[i].x() += 0.05e-3 * std::sin(static_cast<double>(i));
  auto fresh = sim::build_contact<3>(scene, shells);
  const Evaluated a = evaluate(kept, shells, x), b = evaluate(fresh, shells, x);
  ASSERT_GT(a.report.contacts, 0);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((a.force[i] - b.force[i]).norm(), 1e-12);
}

// Two sheets thrown at each other at 3 m/s each never pass through, and bounce.
TEST(Contact, FastSheetsDoNotPassThrough) {
  const auto scene = two_sheets(2e-3);
  const auto shells = sim::build_shells(scene);
  auto contact = sim::build_contact<3>(scene, shells);
  auto x = shells.rest_position;
  std::vector<Eigen::Vector3d> v;
  for (std::size_t i = 0; i < x.size(); ++i) v.emplace_back(0, 0, i < x.size() / 2 ? 3 : -3);
  double nearest = 1;
  for (int step = 0; step < 12; ++step) {
    sim::ShellSubstepInput<3> input;
    input.duration = 1e-4;
    sim::shell_substeps<3>(shells, &contact, input, x, v, {});
    double gap = 0;
    for (std::size_t i = 0; i < x.size() / 2; ++i) gap += (x[i + x.size() / 2].z() - x[i].z()) / (0.5 * static_cast<double>(x.size()));
    nearest = std::min(nearest, gap);
  }
  EXPECT_GT(nearest, 0);
  double apart = 0;
  for (std::size_t i = 0; i < x.size(); ++i) apart += i < x.size() / 2 ? -v[i].z() : v[i].z();
  EXPECT_GT(apart / static_cast<double>(x.size()), 1.0);
}

// A sheet driven into a wall by 16 kPa stops off its true surface; the held rows are exempt.
TEST(Contact, WallHoldsASheet) {
  auto scene = strip(6e-3, 6e-3, 1e-3, 0, tissue(0.45));
  for (int i = -4; i < 10; ++i)
    for (int j = -4; j < 10; ++j) {
      append<3>(scene, {(i + 0.5) * 1e-3, (j + 0.5) * 1e-3, -2e-3}, {0, 0, 1}, 1e-9, false);
      scene.particles.kind.back() = sim::Kind::wall;
      scene.particles.depth.back() = 0.5e-3;
    }
  const auto shells = sim::build_shells(scene);
  auto contact = sim::build_contact<3>(scene, shells);
  auto x = shells.rest_position;
  std::vector<Eigen::Vector3d> v(x.size(), Eigen::Vector3d::Zero()), force;
  for (double a : shells.area) force.emplace_back(0, 0, -16e3 * a);
  auto scene_material = shells;
  scene_material.bodies[0].damping = 5000;
  for (int step = 0; step < 40; ++step) {
    sim::ShellSubstepInput<3> input;
    input.external_force = force;
    input.duration = 1e-4;
    sim::shell_substeps<3>(scene_material, &contact, input, x, v, {});
  }
  for (const auto& p : x) {
    EXPECT_GT(p.z(), -1.5e-3);           // the wall's true surface
    EXPECT_LT(p.z(), -1.5e-3 + 0.5e-3);  // but in contact
  }
}

}  // namespace
