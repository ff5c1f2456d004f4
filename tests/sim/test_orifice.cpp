#include "sim/orifice.h"

#include <gtest/gtest.h>

#include "tests/sim/valve_sheets.h"

namespace {

using namespace valve_sheets;

// What is seen through a round hole in sheets of thickness 2 h is a disc smaller by h, whatever the contact distance.
TEST(Orifice, AreaOfARoundHole) {
  for (double half_thickness : {0.0, 0.25e-3, 0.4e-3}) {
    const sim::ValveSheet sheet = ring(5e-3, 12e-3).build(12e-3, 1e-3, 0.5e-3);
    for (double half_contact : {0.0, 0.6e-3}) {
      const auto found = sim::geometric_orifice_area(sheet, sheet.rest, half_thickness, half_contact);
      const double expected = M_PI * std::pow(5e-3 - half_thickness, 2);
      EXPECT_NEAR(found.area, expected, 0.015 * expected) << half_thickness << " " << half_contact;
      EXPECT_NEAR(found.largest_opening, found.area, 1e-12);
    }
  }
}

TEST(Orifice, HoleNarrowerThanTheContactDistanceIsClosed) {
  const sim::ValveSheet sheet = ring(0.35e-3, 12e-3).build(12e-3, 1e-3, 0.5e-3);
  EXPECT_GT(sim::geometric_orifice_area(sheet, sheet.rest, 0, 0).area, 0.3e-6);
  EXPECT_EQ(sim::geometric_orifice_area(sheet, sheet.rest, 0, 0.4e-3).area, 0);
}

// Planimetry sees along the axis: a hole in a tilted view from the side of a tube does not count. A tube of radius r that stands open is
// seen as its rim: pi r^2, also where its free end flares outwards or bends inwards (then the narrowest place counts).
TEST(Orifice, SeenFromTheAortaTheNarrowestPlaceCounts) {
  for (double lip : {0.0, 2e-3, -2e-3}) {
    Parts parts;
    const int around = 72, rows = 10;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < around; ++i) {
        const double a = 2 * M_PI * i / around, r = 9e-3 + (j >= rows / 2 ? lip * (j - rows / 2) / (rows - 1 - rows / 2) : 0);
        parts.rest.emplace_back(r * std::cos(a), r * std::sin(a), 1e-3 * j);
        parts.leaflet.push_back(0), parts.held.push_back(j == 0);
        if (j + 1 == rows) continue;
        const int b = j * around + i, c = j * around + (i + 1) % around;
        parts.elements.push_back({b, c, c + around}), parts.elements.push_back({b, c + around, b + around});
      }
    const sim::ValveSheet sheet = parts.build(9e-3, 1e-3, 0.5e-3);
    const double narrowest = 9e-3 + std::min(0.0, lip), expected = M_PI * narrowest * narrowest;
    EXPECT_NEAR(sim::geometric_orifice_area(sheet, sheet.rest, 0, 0).area, expected, 0.03 * expected) << lip;
  }
}

// Two strips that overlap by 3 of 8 mm, 0.5 mm apart and five wide: 3 x 5 mm2 on each side, and sqrt(0.6^2 - 0.5^2) = 0.33 mm beyond, where
// the other strip's end is still nearer than 0.6 mm. Between rows 1 mm apart the distance is not quite linear there: to
// within 0.4 of a row.
TEST(Orifice, CoaptationOfOverlappingStrips) {
  for (const double shift : {0.0, 0.3e-3, 0.7e-3}) {
    Parts parts;
    add_sheet(parts, 0, {0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}, 9, 6);
    add_sheet(parts, 1, {5e-3 + shift, 0, 0.5e-3}, {1e-3, 0, 0}, {0, 1e-3, 0}, 9, 6);
    const sim::ValveSheet sheet = parts.build(12e-3, 1e-3, 0.5e-3);
    const auto found = sim::coaptation(sheet, sheet.rest, 0.6e-3);
    EXPECT_NEAR(found.area, (3e-3 - shift + std::sqrt(0.36 - 0.25) * 1e-3) * 5e-3, 0.4e-3 * 5e-3) << shift;
  }
  Parts apart;
  add_sheet(apart, 0, {0, 0, 0}, {1e-3, 0, 0}, {0, 1e-3, 0}, 9, 6);
  add_sheet(apart, 1, {0, 0, 0.7e-3}, {1e-3, 0, 0}, {0, 1e-3, 0}, 9, 6);
  const sim::ValveSheet sheet = apart.build(12e-3, 1e-3, 0.5e-3);
  EXPECT_EQ(sim::coaptation(sheet, sheet.rest, 0.6e-3).area, 0);
  EXPECT_NEAR(sim::coaptation(sheet, sheet.rest, 0.8e-3).area, 40e-6, 1e-12);  // all of both
}

// Two flat leaves that part at the angle a, 2 d apart at the hinge: nearer than D up to (D - 2 d cos a) / sin a of the arm and no farther,
// so that what touches follows the gap and not the rows.
TEST(Orifice, CoaptationEndsWhereTheGapDoes) {
  const double half_angle = 0.1, half_gap = 0.2e-3, reach = 1.2e-3, l0 = 1e-3, length = 20e-3, width = 10e-3;
  Parts parts;
  for (const double sign : {1.0, -1.0})
    add_sheet(parts, sign > 0 ? 0 : 1, {sign * half_gap, -0.5 * width, 0},
              l0 * Vector3d(sign * std::sin(half_angle), 0, std::cos(half_angle)), {0, l0, 0}, 21, 11);
  const sim::ValveSheet sheet = parts.build(12e-3, l0, 0.3e-3);
  const auto found = sim::coaptation(sheet, sheet.rest, reach);
  // A point at s of one arm lies s sin 2a + 2 d cos a from the other's plane, where its foot stays on the arm.
  const double expected = (reach - 2 * half_gap * std::cos(half_angle)) / std::sin(2 * half_angle);
  EXPECT_LT(expected, 0.5 * length);
  EXPECT_NEAR(found.area, expected * width, 0.05 * expected * width);
}

// Doors turned up to the vertical stand `length` over the hinge, which lies 5 mm over the annulus plane.
TEST(Orifice, EffectiveHeightOfStandingDoors) {
  const sim::ValveSheet sheet = doors(10e-3, 9e-3, 8e-3, M_PI / 2, 0.5e-3).build(10e-3, 0.5e-3, 0.5e-3);
  EXPECT_NEAR(sim::coaptation(sheet, sheet.rest, 0.5e-3).effective_height, 14e-3, 1e-9);
  EXPECT_EQ(sim::coaptation(sheet, sheet.rest, 0.5e-3).central, 0);
}

// Two doors whose last 4 mm stand upright face to face, 0.4 mm apart: central coaptation is 4 mm and what of the bend lies nearer than
// 0.45 mm (0.02 mm each). Stretched to twice the length upwards it is 8 mm, stretched sideways it stays: a length, not an area.
TEST(Orifice, CentralCoaptationOfTwoLeaflets) {
  Parts parts;
  const double l0 = 0.5e-3, gap = 0.4e-3;
  for (int k = 0; k < 2; ++k) {
    const double sign = k == 0 ? 1 : -1;
    const int columns = 25, rows = 17;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const double along = i * l0, flat = 8e-3, x = along < flat ? flat + gap / 2 - along : gap / 2, z = along < flat ? 0 : along - flat;
        parts.rest.emplace_back(sign * x, (j - rows / 2) * l0, z);
        parts.leaflet.push_back(k), parts.held.push_back(i == 0);
        if (i + 1 == columns || j + 1 == rows) continue;
        const std::int32_t a = k * columns * rows + j * columns + i;
        parts.elements.push_back({a, a + 1, a + columns + 1}), parts.elements.push_back({a, a + columns + 1, a + columns});
      }
  }
  const sim::ValveSheet sheet = parts.build(8e-3, l0, 0.3e-3);
  EXPECT_NEAR(sim::coaptation(sheet, sheet.rest, 0.45e-3).central, 4e-3, 0.25 * l0);
  std::vector<Vector3d> longer = sheet.rest, wider = sheet.rest;
  for (Vector3d& p : longer) p.z() *= 2;
  for (Vector3d& p : wider) p.y() *= 1.5;
  EXPECT_NEAR(sim::coaptation(sheet, longer, 0.45e-3).central, 8e-3, 0.25 * l0);
  EXPECT_NEAR(sim::coaptation(sheet, wider, 0.45e-3).central, 4e-3, 0.25 * l0);
}

}  // namespace
