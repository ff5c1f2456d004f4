#include "sim/scene_description.h"

#include <algorithm>
#include <cmath>

namespace sim {

TimeTable constant_table(double value) { return {{0.0}, {value}, true}; }

double TimeTable::at(double t) const {
  if (time.empty()) return 0;
  if (time.size() == 1) return value.front();
  // A table that repeats has its last row's time as period (counted from 0).
  if (repeat && t > time.back() && time.back() > 0) t -= std::floor(t / time.back()) * time.back();
  if (t <= time.front()) return value.front();
  if (t >= time.back()) return value.back();
  const std::size_t upper = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double share = (t - time[upper - 1]) / (time[upper] - time[upper - 1]);
  return value[upper - 1] + share * (value[upper] - value[upper - 1]);
}

template <int D>
double load_factor(const Load<D>& load, double time) {
  if (load.factor) return load.factor->at(time);
  if (load.ramp <= 0) return 1;
  return std::clamp(time / load.ramp, 0.0, 1.0);
}
template double load_factor<2>(const Load<2>&, double);
template double load_factor<3>(const Load<3>&, double);

}  // namespace sim
