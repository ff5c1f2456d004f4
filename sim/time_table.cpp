#include "sim/time_table.h"

#include <algorithm>
#include <cmath>

namespace sim {

double integral(const TimeTable& table, double t) {
  const std::vector<double>&time = table.time, &value = table.value;
  if (time.empty()) return 0;
  if (time.size() == 1) return value.front() * t;
  const auto between = [&](std::size_t row, double at) {  // on the line from `row` to the next; the last row's value is held
    if (row + 1 >= time.size()) return value.back();
    return value[row] + (at - time[row]) / (time[row + 1] - time[row]) * (value[row + 1] - value[row]);
  };
  const auto first_period = [&](double until) {
    double sum = 0, from = 0;
    for (std::size_t k = 0; k <= time.size() && from < until; ++k) {  // up to row k; beyond the last row the value is held
      const double to = std::max(from, k < time.size() ? std::min(until, time[k]) : until);
      if (to == from) continue;
      const double left = k == 0 ? value.front() : between(k - 1, from), right = k == 0 ? value.front() : between(k - 1, to);
      sum += 0.5 * (left + right) * (to - from);
      from = to;
    }
    return sum;
  };
  const double period = table.repeat ? time.back() : 0;
  if (!(period > 0) || t <= period) return first_period(t);
  const double passed = std::floor(t / period);
  return passed * first_period(period) + first_period(t - passed * period);
}

}  // namespace sim
