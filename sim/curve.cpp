#include "sim/curve.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

std::vector<double> samples_within(const Curve& curve, double from, double to) {
  std::vector<double> values;
  for (std::size_t i = 0; i < curve.time.size(); ++i)
    if (curve.time[i] >= from && curve.time[i] <= to) values.push_back(curve.value[i]);
  std::sort(values.begin(), values.end());
  return values;
}

double sorted_quantile(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return 0;
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

double value_at(const Curve& curve, double time) {
  if (curve.empty()) return 0;
  if (time <= curve.time.front()) return curve.value.front();
  if (time >= curve.time.back()) return curve.value.back();
  const auto after = static_cast<std::size_t>(std::upper_bound(curve.time.begin(), curve.time.end(), time) - curve.time.begin());
  const double share = (time - curve.time[after - 1]) / (curve.time[after] - curve.time[after - 1]);
  return curve.value[after - 1] + share * (curve.value[after] - curve.value[after - 1]);
}

Curve cut(const Curve& curve, double from, double to) {
  if (curve.empty()) return {};
  from = std::max(from, curve.time.front()), to = std::min(to, curve.time.back());
  if (from >= to) return {};
  Curve part{{from}, {value_at(curve, from)}};
  for (std::size_t i = 0; i < curve.time.size(); ++i)
    if (curve.time[i] > from && curve.time[i] < to) part.time.push_back(curve.time[i]), part.value.push_back(curve.value[i]);
  part.time.push_back(to), part.value.push_back(value_at(curve, to));
  return part;
}

double integral(const Curve& curve, double from, double to) {
  const Curve part = cut(curve, from, to);
  double sum = 0;
  for (std::size_t i = 1; i < part.time.size(); ++i) sum += 0.5 * (part.value[i] + part.value[i - 1]) * (part.time[i] - part.time[i - 1]);
  return sum;
}

double mean(const Curve& curve, double from, double to) {
  const Curve part = cut(curve, from, to);
  return part.empty() ? 0 : integral(curve, from, to) / (part.time.back() - part.time.front());
}

Extreme largest(const Curve& curve, double from, double to) {
  const Curve part = cut(curve, from, to);
  if (part.empty()) return {from, value_at(curve, from)};
  const auto at = std::max_element(part.value.begin(), part.value.end()) - part.value.begin();
  return {part.time[static_cast<std::size_t>(at)], part.value[static_cast<std::size_t>(at)]};
}

Extreme smallest(const Curve& curve, double from, double to) {
  Curve negative = curve;
  for (double& value : negative.value) value = -value;
  const Extreme found = largest(negative, from, to);
  return {found.time, -found.value};
}

double median(const Curve& curve, double from, double to) { return sorted_quantile(samples_within(curve, from, to), 0.5); }

double half_spread(const Curve& curve, double from, double to) {
  const std::vector<double> sorted = samples_within(curve, from, to);
  return 0.5 * (sorted_quantile(sorted, 0.75) - sorted_quantile(sorted, 0.25));
}

double noise(const Curve& curve, double from, double to) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1; i + 1 < curve.time.size(); ++i) {
    if (curve.time[i - 1] < from || curve.time[i + 1] > to) continue;
    const double second = curve.value[i - 1] - 2 * curve.value[i] + curve.value[i + 1];
    sum += second * second, ++count;
  }
  return count > 0 ? std::sqrt(sum / (6 * count)) : 0;
}

std::optional<double> crossing(const Curve& curve, double level, bool rising, double from, double to) {
  const Curve part = cut(curve, from, to);
  for (std::size_t i = 1; i < part.time.size(); ++i) {
    const double before = part.value[i - 1] - level, after = part.value[i] - level;
    if (rising ? before < 0 && after >= 0 : before > 0 && after <= 0)
      return part.time[i - 1] + before / (before - after) * (part.time[i] - part.time[i - 1]);
  }
  return std::nullopt;
}

double knee(const Curve& curve, double from, double to) {
  const Curve part = cut(curve, from, to);
  if (part.empty()) return from;
  double best = part.time.front(), farthest = 0;
  const double slope = (part.value.back() - part.value.front()) / (part.time.back() - part.time.front());
  for (std::size_t i = 0; i < part.time.size(); ++i) {
    const double above = part.value[i] - part.value.front() - slope * (part.time[i] - part.time.front());
    if (above > farthest) farthest = above, best = part.time[i];
  }
  return best;
}

}  // namespace sim
