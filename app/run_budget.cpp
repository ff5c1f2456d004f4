#include "app/run_budget.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "app/accuracy.h"
#include "app/assets.h"
#include "app/explain.h"
#include "app/progress.h"
#include "app/scene_table.h"

namespace app {
namespace {

constexpr const char* numeric_keys[] = {"title", "spacing", "time", "scheme", "limits", "probe", "reference", "start"};

// FNV-1a, 64 bits, as 16 hexadecimal digits.
std::string fingerprint(const std::string& text) {
  std::uint64_t hash = 1469598103934665603ull;
  for (unsigned char c : text) hash = (hash ^ c) * 1099511628211ull;
  char digits[20];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
  return digits;
}

std::optional<AccuracyStudy> read_study(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return std::nullopt;
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  try {
    return study_from_json(json);
  } catch (const std::exception& error) {
    throw SceneError(file.string() + ": " + error.what() + "; run cusp accuracy again");
  }
}

// Ladder, coarse to fine, as arrays.
struct Ladder {
  std::vector<double> spacing, cost, error;  // error: worst; NaN on the finest where it is the reference
};
Ladder ladder_arrays(const AccuracyStudy& study) {
  Ladder ladder;
  for (std::size_t k : ladder_of(study)) {
    const AccuracyPoint& point = study.points[k];
    ladder.spacing.push_back(point.spacing), ladder.error.push_back(point.worst_error());
    const double cost = cost_of(point, study.clock);
    ladder.cost.push_back(study.clock == CostClock::processor ? cost / std::max(1, point.threads) : cost);
  }
  if (ladder.spacing.size() < 2)
    throw SceneError(study.scene + ": its study has fewer than two spacings, which is no law; run cusp accuracy with a longer ladder");
  return ladder;
}

// y at x through the points in the logarithms, beyond them by the slope at that end. x falling.
double along(const std::vector<double>& x, const std::vector<double>& y, double at) {
  std::size_t k = 1;
  while (k + 1 < x.size() && at < x[k]) ++k;
  const double slope = std::log(y[k] / y[k - 1]) / std::log(x[k] / x[k - 1]);
  return y[k] * std::pow(at / x[k], slope);
}

// The errors that stand for the ladder's: known ones, never growing towards finer spacings (a finer run that is worse by luck or noise is
// no reason to choose a coarser one, nor to promise more).
struct ErrorLaw {
  std::vector<double> spacing, error;
  double at(double h) const {
    if (spacing.empty()) return std::nan("");
    if (spacing.size() == 1 || h >= spacing.front()) return error.front() * (spacing.size() == 1 ? 1 : std::max(1.0, h / spacing.front()));
    const double slope_limited = along(spacing, error, h);
    return h < spacing.back() ? std::max(slope_limited, error.back() * std::pow(h / spacing.back(), 2.0)) : slope_limited;
  }
};
ErrorLaw error_law(const Ladder& ladder) {
  ErrorLaw law;
  double worst = 0;
  for (std::size_t k = ladder.spacing.size(); k-- > 0;) {
    if (!(ladder.error[k] > 0)) continue;
    worst = std::max(worst, ladder.error[k]);
    law.spacing.insert(law.spacing.begin(), ladder.spacing[k]), law.error.insert(law.error.begin(), worst);
  }
  return law;
}

constexpr double finest_share = 0.7;  // of the finest spacing measured: no farther does the law reach

struct Law {
  Ladder ladder;
  ErrorLaw error;
  std::vector<FreeKnob> knobs;
  double factor = 1;  // on the ladder's cost: machine, simulated time, free knobs
  double seconds(double spacing) const { return factor * along(ladder.spacing, ladder.cost, spacing); }
};
Law law_of(const AccuracyStudy& study, double speed, double end) {
  Law law{ladder_arrays(study), {}, free_knobs(study), speed};
  law.error = error_law(law.ladder);
  if (!study.statics && study.end > 0) law.factor *= end / study.end;
  for (const FreeKnob& knob : law.knobs) law.factor *= knob.cost_factor;
  return law;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

BudgetChoice choice_at(const Law& law, const AccuracyStudy& study, double spacing) {
  BudgetChoice choice;
  choice.spacing = spacing;
  char text[40];
  std::snprintf(text, sizeof text, "spacing=%.6g", spacing);
  choice.settings = {text};
  for (const FreeKnob& knob : law.knobs) {
    // A time step was measured at one spacing; what it may be grows with the spacing.
    const bool time_step = knob.curve == "time.step" || knob.curve == "scheme.maximum_step";
    double measured_at = 0;
    for (const AccuracyPoint& point : study.points)
      if (point.curve == knob.curve && point.value == knob.value) measured_at = point.spacing;
    if (time_step && measured_at > 0) {
      std::snprintf(text, sizeof text, "%s=%.4g", knob.curve.c_str(), std::strtod(knob.value.c_str(), nullptr) * spacing / measured_at);
      choice.settings.push_back(text);
    } else {
      choice.settings.insert(choice.settings.end(), knob.settings.begin(), knob.settings.end());
    }
  }
  choice.expected_seconds = law.seconds(spacing), choice.expected_error = law.error.at(spacing);
  for (const std::string& setting : choice.settings) choice.words += (choice.words.empty() ? "" : ", ") + setting;
  choice.words += ": about " + duration_text(choice.expected_seconds) + " expected, error about " + percent(choice.expected_error) +
                  " against " + study.against;
  if (spacing < law.ladder.spacing.back()) choice.words += " (finer than what was measured: by the fitted law)";
  return choice;
}

}  // namespace

double read_duration(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string unit(end);
  const double factor = unit == "s" || unit.empty() ? 1 : unit == "min" ? 60 : unit == "h" ? 3600 : -1;
  if (end == text.c_str() || !(value > 0) || !std::isfinite(value) || factor < 0)
    throw SceneError(option + " " + text + ": is no time; give 90s, 20min or 2h");
  return value * factor;
}

double read_share(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string unit(end);
  const double share = unit == "%" ? value / 100 : unit.empty() ? value : -1;
  if (end == text.c_str() || !(share > 0) || !(share < 1)) throw SceneError(option + " " + text + ": is no error; give 5% or 0.05");
  return share;
}

std::string scene_signature(const SceneFile& scene) {
  toml::table table = toml::parse(scene.text);
  for (const char* key : numeric_keys) table.erase(key);
  std::ostringstream text;
  text << table;
  for (const std::string& setting : scene.settings) {
    const bool numeric = std::any_of(std::begin(numeric_keys), std::end(numeric_keys), [&](const std::string& key) {
      return setting.rfind(key + ".", 0) == 0 || setting.rfind(key + "=", 0) == 0;
    });
    if (!numeric) text << "\n" << setting;
  }
  return fingerprint(text.str());
}

double calibrate(const std::filesystem::path& scene, const std::vector<std::string>& settings, double spacing, int threads) {
  std::vector<std::string> all = settings;
  char text[40];
  std::snprintf(text, sizeof text, "spacing=%.10g", spacing);
  all.push_back(text);
  const SceneFile file = read_scene_file(scene, all);
  if (file.time.mode == sim::TimeMode::static_equilibrium) return 0;
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  constexpr int steps = 8;
  const nlohmann::json explained = explain_scene(file, steps);
  omp_set_num_threads(before);
  return explained["measured"]["microseconds_a_particle_and_step"];
}

std::filesystem::path stored_study_path(const SceneFile& scene) {
  return asset("accuracy") / ((scene.patient ? "patient" : scene.path.stem().string()) + ".json");
}

FoundStudy find_study(const SceneFile& scene, const std::string& option) {
  const std::string stem = scene.path.stem().string(), signature = scene_signature(scene);
  std::vector<std::filesystem::path> places{scene.path.parent_path() / ("accuracy-" + stem) / "accuracy.json",
                                            scene.path.parent_path() / "accuracy.json"};
  try {
    places.push_back(stored_study_path(scene));
  } catch (const std::runtime_error&) {  // no studies come with this program
  }
  for (const auto& place : places) {
    const auto study = read_study(place);
    if (!study) continue;
    if (study->signature == signature) return {*study, place, ""};
    if (scene.patient && study->patient)
      return {*study, place, "measured on another patient's valve (" + study->title + "): take times and errors as estimates"};
  }
  throw SceneError(scene.path.string() + ": " + option +
                   " needs to know what accuracy costs here, and nothing was measured for such a scene; run `cusp accuracy " +
                   scene.path.string() + "` first");
}

BudgetChoice choose_for_time(const AccuracyStudy& study, double seconds, double speed, double end, const FitSpacing& fitted) {
  const Law law = law_of(study, speed, end);
  const double coarsest = law.ladder.spacing.front(), finest = finest_share * law.ladder.spacing.back();
  if (law.seconds(coarsest) > seconds)
    throw SceneError("--time-budget " + duration_text(seconds) + ": even the coarsest run measured takes about " +
                     duration_text(law.seconds(coarsest)) + " here; give more, or shorten time.end");
  double low = finest, high = coarsest;  // the finest spacing whose cost is within the budget
  if (law.seconds(finest) <= seconds) high = finest;
  for (int k = 0; k < 60 && high > low; ++k) {
    const double middle = std::sqrt(low * high);
    (law.seconds(middle) <= seconds ? high : low) = middle;
  }
  const double fit = fitted(high, true);
  return choice_at(law, study, fit <= coarsest * (1 + 1e-9) ? fit : high);
}

BudgetChoice choose_for_error(const AccuracyStudy& study, double error, double speed, double end, const FitSpacing& fitted) {
  const Law law = law_of(study, speed, end);
  const double coarsest = law.ladder.spacing.front(), finest = finest_share * law.ladder.spacing.back();
  if (law.error.spacing.empty()) throw SceneError("--error-target: the study of this scene tells no error; run cusp accuracy again");
  if (law.error.at(finest) > error)
    throw SceneError("--error-target " + percent(error) +
                     ": not reached by what was measured, nor by its law: " + percent(law.error.at(finest)) + " at spacing " +
                     std::to_string(finest) + "; give a larger one, or measure finer: cusp accuracy " + study.scene + " --vary spacing=…");
  double low = finest, high = coarsest;  // the coarsest spacing whose error is within the target
  if (law.error.at(coarsest) <= error) low = coarsest;
  for (int k = 0; k < 60 && high > low; ++k) {
    const double middle = std::sqrt(low * high);
    (law.error.at(middle) <= error ? low : high) = middle;
  }
  const double fit = fitted(low, false);
  return choice_at(law, study, fit >= finest ? fit : low);
}

}  // namespace app
