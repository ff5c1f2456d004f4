// What accuracy costs, as numbers: points of cost and error, the front of the best of them, orders, and what a given error costs. Pure
// functions; nothing here runs anything.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace app {

// One set of settings that was run, perhaps several times.
struct AccuracyPoint {
  std::string curve;                  // what varies along its curve: "spacing", "scheme.pressure_tolerance", "threads", "seed"
  std::string value;                  // of it
  std::vector<std::string> settings;  // on top of the scene's
  int threads = 1;
  double spacing = 0;                   // m
  bool scene_itself = false;            // the scene's own settings
  std::vector<double> wall, processor;  // s, one a repeat; processor: all threads together
  double steps = 0, particles = 0;
  double pressure_products = 0;  // matrix-vector products of the pressure's conjugate gradients (one an iteration)
  double elastic_substeps = 0;   // explicit sub-steps, or products of implicit solves
  double peak_memory = 0;        // bytes
  std::vector<double> error;     // relative, one a quantity; NaN: not told
  std::vector<double> change;    // of the answer against the ladder's run of the same spacing, relative; empty on the ladder
  double particle_steps() const { return steps * particles; }
  double worst_error() const;  // the largest of its finite errors; NaN where there is none
};

enum class CostClock { wall, processor };

struct AccuracyStudy {
  std::string title, scene, signature;  // file name; of the physics (run_budget.h)
  std::string against;                  // "[reference]" or the finest run, in words
  bool against_finest = false, patient = false, statics = false;
  int dimension = 3, threads = 1;
  double end = 0;          // s simulated
  double calibration = 0;  // microseconds a particle and step, measured beforehand on the coarsest rung; 0 = none (static)
  CostClock clock = CostClock::wall;
  std::vector<std::string> quantities, sources;
  std::vector<double> uncertainty, noise;  // relative, one a quantity: of the reference; spread over jittered starts (NaN: not measured)
  std::vector<AccuracyPoint> points;
  std::vector<std::string> left_out;  // what was planned and not run, with the reason
};

double median(std::vector<double> values);  // NaN where empty
double cost_of(const AccuracyPoint& point, CostClock clock);

// Indices of the points that no other one beats in both, by growing cost (so by falling error). Points that are not finite or not above 0
// are left out.
std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error);

// Cost at which the front (by growing cost, falling error) reaches `error`: interpolated in the logarithms between its points; the
// cheapest point's where that is good enough already; none where no point reaches it.
std::optional<double> cost_to_reach(const std::vector<double>& cost, const std::vector<double>& error, double wanted);

// y = factor x^exponent by least squares in the logarithms; scatter: rms of ln y about the line (0 with two points). None with fewer than
// two different x, or values not above 0.
struct PowerFit {
  double exponent = 0, factor = 0, scatter = 0;
  double at(double x) const;
};
std::optional<PowerFit> power_fit(const std::vector<double>& x, const std::vector<double>& y);

// The same of errors over spacings: none where the error does not fall from each spacing to the next finer one.
std::optional<PowerFit> observed_order(const std::vector<double>& spacing, const std::vector<double>& error);

// The points of the study's ladder (curve "spacing"), coarse to fine.
std::vector<std::size_t> ladder_of(const AccuracyStudy& study);

// How much more the scene's own settings cost than the front at the same error; none where they were not run. `quantity` < 0: the worst
// error of all.
std::optional<double> default_over_front(const AccuracyStudy& study, int quantity);
// The same against what is better by more than the noise of two starts (sqrt 2 of one's, over jittered starts): at least 1. A cheaper run
// that is luckier by less than that is no better choice. As above where the noise was not measured.
std::optional<double> default_over_front_beyond_noise(const AccuracyStudy& study, std::size_t quantity);

// Cost and error of every point with that quantity (< 0: worst), in the study's order.
struct CostError {
  std::vector<double> cost, error;
};
CostError cost_and_error(const AccuracyStudy& study, int quantity);

// The loosest knobs that are free: settings off the ladder that cost less by a twentieth or more and change no answer by more than a tenth
// of its error at that spacing (or by the noise), with fewer steps, products or sub-steps: else it is the clock that was lucky. At most one
// a curve, the cheapest; time steps and tolerances alone.
struct FreeKnob {
  std::string curve, value;
  std::vector<std::string> settings;  // without the spacing
  double cost_factor = 1;
};
std::vector<FreeKnob> free_knobs(const AccuracyStudy& study);

}  // namespace app
