#include "sim/scene_description.h"

#include <gtest/gtest.h>

#include "sim/time_table.h"

namespace {

TEST(TimeTable, IsLinearBetweenRowsAndConstantBeforeTheFirst) {
  const sim::TimeTable table{{0.1, 0.2, 0.4}, {1, 3, 5}, false};
  EXPECT_EQ(table.at(0), 1);
  EXPECT_DOUBLE_EQ(table.at(0.15), 2);
  EXPECT_DOUBLE_EQ(table.at(0.3), 4);
  EXPECT_EQ(table.at(9), 5);  // held
}

TEST(TimeTable, RepeatsWithItsLastRowsTime) {
  const sim::TimeTable table{{0, 0.25, 1}, {0, 10, 0}, true};
  EXPECT_DOUBLE_EQ(table.at(0.125), 5);
  EXPECT_NEAR(table.at(7.125), 5, 1e-12);
  EXPECT_DOUBLE_EQ(table.at(1), 0);
}

TEST(TimeTable, IntegralIsExactOverBendsRepeatsAndBeyondTheLastRow) {
  const sim::TimeTable wave{{0, 0.25, 1}, {0, 10, 0}, true};  // triangle of area 5 a period
  EXPECT_DOUBLE_EQ(sim::integral(wave, 0.125), 0.5 * 0.125 * 5);
  EXPECT_DOUBLE_EQ(sim::integral(wave, 1), 5);
  EXPECT_NEAR(sim::integral(wave, 7.125), 35 + 0.5 * 0.125 * 5, 1e-12);
  const sim::TimeTable late{{0.1, 0.2, 0.4}, {1, 3, 5}, false};
  EXPECT_DOUBLE_EQ(sim::integral(late, 0.1), 0.1);
  EXPECT_DOUBLE_EQ(sim::integral(late, 1), 0.1 + 0.2 + 0.8 + 5 * 0.6);
  EXPECT_EQ(sim::integral(sim::constant_table(4), 3), 12);
  EXPECT_EQ(sim::integral(sim::TimeTable{}, 1), 0);
}

TEST(TimeTable, OneRowIsAConstantAndNoneIsZero) {
  EXPECT_EQ(sim::constant_table(4).at(-1), 4);
  EXPECT_EQ(sim::constant_table(4).at(100), 4);
  EXPECT_EQ(sim::TimeTable{}.at(1), 0);
}

TEST(LoadFactor, RampsOrFollowsItsTable) {
  sim::Load<2> load;
  EXPECT_EQ(sim::load_factor(load, 0), 1);
  load.ramp = 0.2;
  EXPECT_DOUBLE_EQ(sim::load_factor(load, 0.05), 0.25);
  EXPECT_EQ(sim::load_factor(load, 1), 1);
  load.factor = sim::TimeTable{{0, 1}, {0, 4}, false};
  EXPECT_DOUBLE_EQ(sim::load_factor(load, 0.5), 2);
}

}  // namespace
