#include "app/stage_trace.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace {

TEST(StageTrace, NotesIntervalsAndWritesThemAsTraceEvents) {
  sim::StageTimes times, untraced;
  times.trace.reserve(3);
  for (int k = 0; k < 5; ++k) sim::timed(times, k % 2 ? sim::Stage::pressure_solve : sim::Stage::neighbors, [] {});
  sim::timed(untraced, sim::Stage::motion, [] {});
  ASSERT_EQ(times.trace.size(), 3u);    // what there is room for
  EXPECT_TRUE(untraced.trace.empty());  // and nothing where nobody asked
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "cusp_test_trace.json";
  app::write_stage_trace(times.trace, file);
  const nlohmann::json trace = nlohmann::json::parse(std::ifstream(file));
  std::filesystem::remove(file);
  ASSERT_EQ(trace["traceEvents"].size(), 4u);  // and the process's name
  const nlohmann::json& second = trace["traceEvents"][2];
  EXPECT_EQ(second["name"], "pressure solve");
  EXPECT_EQ(second["ph"], "X");
  EXPECT_GE(second["ts"].get<double>(), trace["traceEvents"][1]["ts"].get<double>());
  EXPECT_DOUBLE_EQ(second["dur"].get<double>(), 1e6 * times.trace[1].duration);
}

}  // namespace
