#include "app/work_precision.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace app {
namespace {

constexpr double not_told = std::numeric_limits<double>::quiet_NaN();

constexpr double shortest_cost_that_tells = 0.1;  // s: below it starting the program takes longer than the run

}  // namespace

double AccuracyPoint::worst_error() const {
  double worst = not_told;
  for (double one : error)
    if (std::isfinite(one) && !(worst >= one)) worst = one;
  return worst;
}

double median(std::vector<double> values) {
  if (values.empty()) return not_told;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double cost_of(const AccuracyPoint& point, CostClock clock) { return median(clock == CostClock::wall ? point.wall : point.processor); }

std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < cost.size(); ++k)
    if (std::isfinite(cost[k]) && cost[k] > 0 && std::isfinite(error[k]) && error[k] > 0) order.push_back(k);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] != cost[b] ? cost[a] < cost[b] : error[a] != error[b] ? error[a] < error[b] : a < b;
  });
  std::vector<std::size_t> front;
  for (std::size_t k : order)
    if (front.empty() || error[k] < error[front.back()]) front.push_back(k);
  return front;
}

std::optional<double> cost_to_reach(const std::vector<double>& cost, const std::vector<double>& error, double wanted) {
  for (std::size_t k = 0; k < cost.size(); ++k) {
    if (error[k] > wanted) continue;
    if (k == 0 || error[k] == wanted) return cost[k];
    const double share = std::log(error[k - 1] / wanted) / std::log(error[k - 1] / error[k]);
    return cost[k - 1] * std::pow(cost[k] / cost[k - 1], share);
  }
  return std::nullopt;
}

double PowerFit::at(double x) const { return factor * std::pow(x, exponent); }

std::optional<PowerFit> power_fit(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double mean_a = 0, mean_b = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!(x[k] > 0) || !(y[k] > 0) || !std::isfinite(x[k]) || !std::isfinite(y[k])) return std::nullopt;
    mean_a += std::log(x[k]) / n, mean_b += std::log(y[k]) / n;
  }
  double aa = 0, ab = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double a = std::log(x[k]) - mean_a;
    aa += a * a, ab += a * (std::log(y[k]) - mean_b);
  }
  if (x.size() < 2 || !(aa > 1e-12)) return std::nullopt;
  PowerFit fit;
  fit.exponent = ab / aa, fit.factor = std::exp(mean_b - fit.exponent * mean_a);
  double square = 0;
  for (std::size_t k = 0; k < x.size(); ++k) square += std::pow(std::log(y[k] / fit.at(x[k])), 2);
  fit.scatter = std::sqrt(square / n);
  return fit;
}

std::optional<PowerFit> observed_order(const std::vector<double>& spacing, const std::vector<double>& error) {
  std::vector<std::size_t> order(spacing.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return spacing[a] > spacing[b]; });
  for (std::size_t k = 1; k < order.size(); ++k)
    if (!(error[order[k]] < error[order[k - 1]])) return std::nullopt;
  return power_fit(spacing, error);
}

std::vector<std::size_t> ladder_of(const AccuracyStudy& study) {
  std::vector<std::size_t> ladder;
  for (std::size_t k = 0; k < study.points.size(); ++k)
    if (study.points[k].curve == "spacing") ladder.push_back(k);
  std::sort(ladder.begin(), ladder.end(), [&](std::size_t a, std::size_t b) { return study.points[a].spacing > study.points[b].spacing; });
  return ladder;
}

CostError cost_and_error(const AccuracyStudy& study, int quantity) {
  CostError all;
  for (const AccuracyPoint& point : study.points) {
    const auto q = static_cast<std::size_t>(quantity);
    const bool seeded = point.curve == "seed";  // another start of the same settings: noise, no choice of a user's
    all.cost.push_back(cost_of(point, study.clock));
    all.error.push_back(seeded ? not_told : quantity < 0 ? point.worst_error() : q < point.error.size() ? point.error[q] : not_told);
  }
  return all;
}

namespace {

// Cost of the scene's own settings over the front's for an error smaller by `margin`; `otherwise` where the front has none.
std::optional<double> over_front(const AccuracyStudy& study, int quantity, double margin, std::optional<double> otherwise) {
  const CostError all = cost_and_error(study, quantity);
  std::vector<double> cost, error;
  for (std::size_t k : pareto_front(all.cost, all.error)) cost.push_back(all.cost[k]), error.push_back(all.error[k]);
  for (std::size_t k = 0; k < study.points.size(); ++k) {
    if (!study.points[k].scene_itself || !(all.error[k] > 0) || !(all.cost[k] > 0)) continue;
    if (const auto best = cost_to_reach(cost, error, all.error[k] - margin)) return all.cost[k] / *best;
    return otherwise;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> default_over_front(const AccuracyStudy& study, int quantity) { return over_front(study, quantity, 0, std::nullopt); }

std::optional<double> default_over_front_beyond_noise(const AccuracyStudy& study, std::size_t quantity) {
  const double noise = quantity < study.noise.size() ? study.noise[quantity] : not_told;
  const int index = static_cast<int>(quantity);
  if (!(noise > 0)) return default_over_front(study, index);
  const auto over = over_front(study, index, std::sqrt(2.0) * noise, 1.0);
  return over ? std::optional(std::max(*over, 1.0)) : std::nullopt;
}

std::vector<FreeKnob> free_knobs(const AccuracyStudy& study) {
  std::vector<FreeKnob> found;
  for (const AccuracyPoint& point : study.points) {
    const bool step_or_tolerance = point.curve == "time.step" || point.curve == "scheme.cfl" || point.curve == "scheme.maximum_step" ||
                                   point.curve == "scheme.elastic_substep" || point.curve.find("tolerance") != std::string::npos;
    if (!step_or_tolerance || point.change.empty()) continue;
    const AccuracyPoint* base = nullptr;
    for (std::size_t k : ladder_of(study))
      if (study.points[k].spacing == point.spacing) base = &study.points[k];
    if (!base) continue;
    bool harmless = true;
    for (std::size_t q = 0; q < point.change.size(); ++q) {
      if (!std::isfinite(point.change[q])) continue;
      const double error = q < base->error.size() && std::isfinite(base->error[q]) ? base->error[q] : 0;
      const double noise = q < study.noise.size() && std::isfinite(study.noise[q]) ? study.noise[q] : 0;
      harmless = harmless && point.change[q] <= std::max(0.1 * error, noise);
    }
    const double before = cost_of(*base, study.clock), factor = cost_of(point, study.clock) / before;
    const bool less_work =
        point.steps < base->steps || point.pressure_products < base->pressure_products || point.elastic_substeps < base->elastic_substeps;
    if (!harmless || !less_work || !(factor <= 0.95) || before < shortest_cost_that_tells) continue;
    FreeKnob knob{point.curve, point.value, {}, factor};
    for (const std::string& setting : point.settings)
      if (setting.rfind("spacing=", 0) != 0) knob.settings.push_back(setting);
    const auto same = std::find_if(found.begin(), found.end(), [&](const FreeKnob& other) { return other.curve == knob.curve; });
    if (same == found.end())
      found.push_back(std::move(knob));
    else if (knob.cost_factor < same->cost_factor)
      *same = std::move(knob);
  }
  return found;
}

}  // namespace app
