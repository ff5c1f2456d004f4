#include "app/accuracy_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "app/clinical.h"

namespace app {
namespace {

constexpr double not_told = std::numeric_limits<double>::quiet_NaN();

// One quantity of one run: a number, or a curve over time or along a line.
struct Answer {
  std::string quantity;
  double value = not_told, scale = 0;  // scale: what a difference is measured against; 0: the finest run's value
  std::vector<double> at, curve;
};

double rms(const std::vector<double>& values) {
  double square = 0;
  for (double value : values) square += value * value;
  return values.empty() ? 0 : std::sqrt(square / static_cast<double>(values.size()));
}

double interpolated(const std::vector<double>& at, const std::vector<double>& value, double x) {
  const std::size_t upper = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  if (upper == 0) return value.front();
  if (upper == at.size()) return value.back();
  return value[upper - 1] + (x - at[upper - 1]) / (at[upper] - at[upper - 1]) * (value[upper] - value[upper - 1]);
}

// Every probe: its curve over time (its end in a static scene), and of a line its values at the end.
std::vector<Answer> probe_answers(const sim::RunReader& run) {
  std::vector<Answer> answers;
  const std::vector<double> times = run.column("time");
  for (const std::string& name : run.header().columns) {
    if (name == "time") continue;
    if (name == "maximum_speed") break;  // the probes stand before the metrics
    Answer one{name, not_told, 0, {}, {}};
    const std::vector<double> values = run.column(name);
    if (values.empty()) continue;
    one.value = values.back();
    if (!run.header().statics && values.size() > 2) one.at = times, one.curve = values;
    answers.push_back(std::move(one));
  }
  for (const auto& line : run.header().lines) {
    const std::vector<std::vector<double>> rows = run.line(line.name);
    if (rows.empty()) continue;
    Answer one{line.name, not_told, 0, {}, rows.back()};
    for (std::size_t k = 0; k < rows.back().size(); ++k) one.at.push_back(static_cast<double>(k));
    one.value = rms(rows.back());
    answers.push_back(std::move(one));
  }
  return answers;
}

// The clinical axis: orifice, opening time, peak stress, gradient, leak. What a run does not tell is left out.
std::vector<Answer> clinical_answers(const sim::RunReader& run, const std::filesystem::path& file) {
  std::vector<Answer> answers;
  const auto clinical = clinical_figures(run, file);
  if (!clinical) return answers;
  const auto add = [&](const char* name, double value, double scale) {
    if (std::isfinite(value)) answers.push_back({name, value, scale, {}, {}});
  };
  const auto figure = [&](const char* key) {
    const sim::Figure* found = clinical->summary.find(key);
    return found ? found->value : not_told;
  };
  const sim::Curve area = clinical->series.curve("orifice_area");
  if (!area.empty()) {
    const double from = area.time.front(), to = area.time.back();
    const sim::Extreme widest = sim::largest(area, from, to);
    add("largest orifice", widest.value, 0);
    if (const auto half = sim::crossing(area, 0.5 * widest.value, true, from, to)) add("half-opening time", *half, 0);
  }
  add("peak stress", figure("stress_peak"), 0);
  const double mean_gradient = figure("mean_pressure_difference");
  if (std::isfinite(mean_gradient))
    add("mean gradient", mean_gradient, 0);
  else
    add("peak gradient", figure("peak_pressure_difference"), 0);
  if (const double forward = figure("forward_volume"); forward > 0) {
    add("forward volume", forward, 0);
    add("leak (share of forward volume)", figure("leak_volume"), forward);
  }
  return answers;
}

// One run's answers beside the finest run's; quantities that either does not tell are not compared.
std::vector<Comparison> against(const std::vector<Answer>& mine, const std::vector<Answer>& finest, const std::string& source) {
  std::vector<Comparison> result;
  for (const Answer& best : finest) {
    Comparison one;
    one.quantity = best.quantity, one.source = source, one.measured = not_told, one.reference = best.value, one.error = not_told;
    one.scale = best.scale;
    const auto found = std::find_if(mine.begin(), mine.end(), [&](const Answer& a) { return a.quantity == best.quantity; });
    if (found != mine.end()) {
      one.measured = found->value;
      if (!best.curve.empty() && !found->curve.empty()) {
        std::vector<double> difference;
        one.at = best.at, one.reference_curve = best.curve;
        for (std::size_t k = 0; k < best.at.size(); ++k) {
          one.measured_curve.push_back(interpolated(found->at, found->curve, best.at[k]));
          difference.push_back(one.measured_curve.back() - best.curve[k]);
        }
        one.measured = rms(one.measured_curve), one.reference = rms(best.curve);
        one.error = rms(difference) / (one.reference > 0 ? one.reference : 1);
      } else {
        const double scale = best.scale > 0 ? best.scale : std::abs(best.value);
        one.error = std::abs(found->value - best.value) / (scale > 0 ? scale : 1);
      }
    }
    result.push_back(std::move(one));
  }
  return result;
}

double magnitude(const Comparison& c) { return c.scale > 0 ? c.scale : std::abs(c.reference) > 0 ? std::abs(c.reference) : 1; }

std::vector<std::vector<Comparison>> with_references(const SceneFile& scene, const std::vector<std::filesystem::path>& files,
                                                     AccuracyStudy& study) {
  std::vector<std::vector<Comparison>> all;
  for (const auto& file : files) all.push_back(compare_with_references(scene, sim::RunReader(file)));
  study.against = "[reference]";
  for (const Comparison& c : all.front()) {
    study.quantities.push_back(c.quantity), study.sources.push_back(c.source);
    study.uncertainty.push_back(c.uncertainty / magnitude(c));
  }
  return all;
}

std::vector<std::vector<Comparison>> with_finest(const std::vector<std::filesystem::path>& files, AccuracyStudy& study) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < files.size(); ++k)
    if (study.points[k].spacing < study.points[best].spacing) best = k;
  const auto answers_of = [&](const std::filesystem::path& file) {
    const sim::RunReader run(file);
    std::vector<Answer> answers = run.header().valve ? clinical_answers(run, file) : std::vector<Answer>{};
    return answers.empty() ? probe_answers(run) : answers;
  };
  const std::vector<Answer> finest = answers_of(files[best]);
  char words[80];
  std::snprintf(words, sizeof words, "the finest run, spacing %.4g m", study.points[best].spacing);
  study.against = words, study.against_finest = true;
  std::vector<std::vector<Comparison>> all;
  for (std::size_t k = 0; k < files.size(); ++k) {
    all.push_back(against(k == best ? finest : answers_of(files[k]), finest, study.against));
    if (k == best)
      for (Comparison& c : all.back()) c.error = not_told;  // against itself
  }
  for (std::size_t q = 0; q < finest.size(); ++q) study.quantities.push_back(finest[q].quantity), study.sources.push_back(study.against);
  return all;
}

// The finest run's own error: with order p and errors e(h) = C h^p the run at h2 differs from the finest at h1 by C (h2^p - h1^p), so the
// finest is C h1^p = difference / ((h2/h1)^p - 1) off.
double finest_uncertainty(const AccuracyStudy& study, std::size_t q) {
  std::vector<double> spacing, error;
  for (std::size_t k : ladder_of(study))
    if (std::isfinite(study.points[k].error[q])) spacing.push_back(study.points[k].spacing), error.push_back(study.points[k].error[q]);
  if (error.empty()) return 0;
  const double finest = study.points[ladder_of(study).back()].spacing;
  const auto order = observed_order(spacing, error);
  const double p = order ? std::clamp(order->exponent, 0.5, 2.0) : 1;
  return error.back() / (std::pow(spacing.back() / finest, p) - 1);
}

}  // namespace

double relative_spread(const std::vector<std::vector<Comparison>>& answers, std::size_t q) {
  const Comparison& first = answers.front()[q];
  const std::size_t points = first.measured_curve.size();
  const auto n = static_cast<double>(answers.size());
  const auto variance = [&](const auto& value) {
    double mean = 0, square = 0;
    for (const auto& one : answers) mean += value(one[q]) / n;
    for (const auto& one : answers) square += std::pow(value(one[q]) - mean, 2) / (n - 1);
    return square;
  };
  if (points == 0) return std::sqrt(variance([](const Comparison& c) { return c.measured; })) / magnitude(first);
  double sum = 0;
  for (std::size_t k = 0; k < points; ++k) sum += variance([k](const Comparison& c) { return c.measured_curve[k]; });
  return std::sqrt(sum / static_cast<double>(points)) / magnitude(first);
}

double relative_change(const Comparison& a, const Comparison& b) {
  if (a.measured_curve.empty() || a.measured_curve.size() != b.measured_curve.size())
    return std::abs(a.measured - b.measured) / magnitude(a);
  std::vector<double> difference;
  for (std::size_t k = 0; k < a.measured_curve.size(); ++k) difference.push_back(a.measured_curve[k] - b.measured_curve[k]);
  return rms(difference) / magnitude(a);
}

std::vector<std::vector<Comparison>> compare_all(const SceneFile& scene, const std::vector<std::filesystem::path>& files,
                                                 AccuracyStudy& study) {
  auto all = scene.references.empty() ? with_finest(files, study) : with_references(scene, files, study);
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const Comparison& c : all[k]) study.points[k].error.push_back(c.error);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (study.points[k].curve == "spacing") continue;
    for (std::size_t base : ladder_of(study))
      if (study.points[base].spacing == study.points[k].spacing)
        for (std::size_t q = 0; q < all[k].size(); ++q) study.points[k].change.push_back(relative_change(all[base][q], all[k][q]));
  }
  if (study.against_finest)
    for (std::size_t q = 0; q < study.quantities.size(); ++q)
      study.uncertainty.push_back(ladder_of(study).size() > 1 ? finest_uncertainty(study, q) : 0);
  return all;
}

}  // namespace app
