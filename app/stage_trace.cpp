#include "app/stage_trace.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace app {

void write_stage_trace(const std::vector<sim::StageEvent>& events, const std::filesystem::path& file) {
  double begin = events.empty() ? 0 : events.front().start;
  for (const sim::StageEvent& event : events) begin = std::min(begin, event.start);
  nlohmann::json list = nlohmann::json::array();
  list.push_back({{"name", "process_name"}, {"ph", "M"}, {"pid", 1}, {"args", {{"name", "cusp"}}}});
  for (const sim::StageEvent& event : events)
    list.push_back({{"name", sim::stage_names[static_cast<std::size_t>(event.stage)]},
                    {"cat", "stage"},
                    {"ph", "X"},
                    {"ts", 1e6 * (event.start - begin)},
                    {"dur", 1e6 * event.duration},
                    {"pid", 1},
                    {"tid", 1}});
  std::ofstream stream(file);
  stream << nlohmann::json{{"displayTimeUnit", "ms"}, {"traceEvents", list}}.dump() << "\n";
  if (!stream.flush()) throw std::runtime_error(file.string() + ": can't be written");
}

}  // namespace app
