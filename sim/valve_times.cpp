// When the valve opens and closes.
#include <algorithm>
#include <cmath>

#include "sim/valve_summary.h"

namespace sim {

// Levels of the opening's range (closed = smallest, open = largest): 10 % and 95 % on the way up, 10 % on the way down. The straight line
// through the two rising crossings is extended to 0 and 100 %, the one from the knee through the falling crossing to 0 %: exact for a
// straight rise and fall, and blind to the flicker of a closed valve.
ValveTimes valve_times(const Curve& area, double from, double to) {
  constexpr double low = 0.10, high = 0.95;
  const double none = std::numeric_limits<double>::quiet_NaN();
  ValveTimes times{none, none, none, none, none, false};
  const Curve beat = cut(area, from, to);
  if (beat.empty()) return times;
  const double closed = smallest(beat, from, to).value, range = largest(beat, from, to).value - closed;
  if (range <= 0) return times;
  const double low_level = closed + low * range, high_level = closed + high * range, top = largest(beat, from, to).time;
  // Backwards from the top to where the area last passed the low level on its way up.
  double rise = beat.time.front();
  times.starts_open = beat.value.front() > low_level;
  for (std::size_t i = 1; i < beat.time.size() && beat.time[i] <= top; ++i) {
    const double before = beat.value[i - 1], after = beat.value[i];
    if (before >= low_level || after < low_level) continue;
    rise = beat.time[i - 1] + (low_level - before) / (after - before) * (beat.time[i] - beat.time[i - 1]);
    times.starts_open = false;
  }
  const double full = crossing(beat, high_level, true, rise, top).value_or(top);
  const double rise_level = value_at(beat, rise), done = (rise_level - closed) / range;
  const double pace = high - done > 1e-9 ? (full - rise) / (high - done) : 0;  // s for the whole range
  times.open = full + (1 - high) * pace;
  times.opens = times.starts_open ? rise : std::max(rise - low * pace, beat.time.front());
  const std::optional<double> fall = crossing(beat, low_level, false, top, beat.time.back());
  if (!fall) return times;
  const double last_high = crossing(beat, high_level, false, top, *fall).value_or(top);
  times.closing = knee(beat, std::min(full, last_high), *fall);
  const double knee_share = (value_at(beat, times.closing) - closed) / range;
  times.slow_closing = 1 - knee_share;
  times.closed = knee_share > low + 1e-9 ? *fall + low / (knee_share - low) * (*fall - times.closing) : *fall;
  return times;
}

}  // namespace sim
