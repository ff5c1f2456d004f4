// A sampled curve over time: what the clinical figures read times, means and volumes from. Linear between samples. Pure functions.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace sim {

struct Curve {
  std::vector<double> time, value;  // same length; time increasing
  bool empty() const { return time.empty(); }
};

Curve cut(const Curve& curve, double from, double to);        // with interpolated ends; empty where from >= to or out of range
double value_at(const Curve& curve, double time);             // held beyond the ends
double integral(const Curve& curve, double from, double to);  // exact for the piecewise linear curve; 0 where nothing is within
double mean(const Curve& curve, double from, double to);      // integral over duration; 0 where nothing is within
struct Extreme {
  double time = 0, value = 0;
};
Extreme largest(const Curve& curve, double from, double to);  // of the samples and the interpolated ends
Extreme smallest(const Curve& curve, double from, double to);
double median(const Curve& curve, double from, double to);       // of the samples within; their time is taken as even
double half_spread(const Curve& curve, double from, double to);  // half the interquartile range of the samples within
// Standard deviation of the noise of single samples, from second differences (a smooth curve has none): rms of
// x[i-1] - 2 x[i] + x[i+1] over sqrt(6).
double noise(const Curve& curve, double from, double to);
// First time in [from, to] at which the curve passes `level` upwards (rising) or downwards; none where it does not.
std::optional<double> crossing(const Curve& curve, double level, bool rising, double from, double to);
// Where the curve between two times is farthest above the straight line that joins its ends: the corner at which a slow fall turns into a
// fast one (Satopaa et al. 2011).
double knee(const Curve& curve, double from, double to);

}  // namespace sim
