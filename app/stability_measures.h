// What the stability matrix measures in a finished run.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "sim/run_file.h"

namespace app {

// The series by column name; 0 for a column that is not there.
struct Series {
  std::map<std::string, std::vector<double>> columns;
  explicit Series(const sim::RunReader& run);
  double first(const std::string& name) const;
  double last(const std::string& name) const;
  double largest(const std::string& name) const;
};

// Kinetic energy of all blood at a centimetre a second, J (2-D: J/m): motion that counts as rest.
double energy_at_rest(const sim::RunReader& run);

// Largest growth of kinetic and elastic energy beyond the work of ports and loads, as a share of the largest energy or work there was, at
// least `rest` (of a state of rest anything would be a large share).
double energy_growth(const Series& series, double rest);

// The fastest leaflet particle of a frame, m/s.
double leaflet_speed(const sim::RunFrame& frame);

// What leaks back through a patient's closed valve in the second half of a run, as a share of a stroke of 70 ml, for a beat of 0.8 s.
double leak(const Series& series);

// Whether all of a frame's values are numbers.
bool finite(const sim::RunFrame& frame);

// Largest distance between the same particles in the last frames of two runs, m; infinite where they do not hold the same.
double apart(const std::filesystem::path& first, const std::filesystem::path& second);

// What the run's warnings say of overloaded leaflets; "" where they are not.
std::string overload_told(const sim::RunReader& run);

// How far the beats from the third on are from their mean: the worst beat's rms difference as a share of the mean curve's largest value.
// beat: s; infinite with fewer than four beats.
double beats_apart(const Series& series, const std::string& column, double beat);

}  // namespace app
