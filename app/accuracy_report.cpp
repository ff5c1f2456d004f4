// accuracy.csv, accuracy.md: what a study found, in plain words first.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "app/accuracy.h"
#include "app/progress.h"
#include "app/work_precision_picture.h"

namespace app {
namespace {

std::string number(double value, int digits = 3) {
  if (!std::isfinite(value)) return "-";
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}
std::string percent(double share) { return std::isfinite(share) ? number(100 * share, share < 0.1 ? 2 : 3) + " %" : "-"; }

std::string length(double metres) {
  return metres < 1e-3 ? number(1e6 * metres, 4) + " µm" : metres < 1 ? number(1e3 * metres, 4) + " mm" : number(metres, 4) + " m";
}

std::string range(const std::vector<double>& seconds) {
  if (seconds.empty()) return "-";
  if (seconds.size() == 1) return number(seconds.front()) + " s";
  const auto [low, high] = std::minmax_element(seconds.begin(), seconds.end());
  return number(median(seconds)) + " s (" + number(*low) + " to " + number(*high) + ")";
}

struct LadderValues {
  std::vector<double> spacing, cost, error;  // where the error is told
};
LadderValues ladder_values(const AccuracyStudy& study, std::size_t q) {
  LadderValues values;
  for (std::size_t k : ladder_of(study)) {
    const AccuracyPoint& point = study.points[k];
    if (q >= point.error.size() || !std::isfinite(point.error[q])) continue;
    values.spacing.push_back(point.spacing), values.cost.push_back(cost_of(point, study.clock)), values.error.push_back(point.error[q]);
  }
  return values;
}

// "Halving the spacing costs 11 x; it takes tip.y from 9 % to 4 %, …", from the ladder's ends.
void write_plain_words(const AccuracyStudy& study, std::ostream& md) {
  const std::vector<std::size_t> ladder = ladder_of(study);
  std::vector<double> spacing, cost;
  for (std::size_t k : ladder) spacing.push_back(study.points[k].spacing), cost.push_back(cost_of(study.points[k], study.clock));
  const auto law = power_fit(spacing, cost);
  if (!law) return;
  const double factor = std::pow(2.0, -law->exponent);
  if (factor >= 1)
    md << "**Halving the spacing costs " << number(factor, 2) << "×** (fitted over " << ladder.size() << " spacings).";
  else
    md << "Halving the spacing costs nothing that could be measured.";
  std::string told;  // the rungs that the last sentence was about
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const LadderValues v = ladder_values(study, q);
    if (v.error.size() < 2) continue;
    const std::string rungs = " From " + length(v.spacing.front()) + " to " + length(v.spacing.back()) + " (" +
                              number(v.cost.back() / v.cost.front(), 2) + "× the cost) ";
    md << (rungs == told ? ", " : (told.empty() ? "" : ".") + rungs) << study.quantities[q] << " goes from " << percent(v.error.front())
       << " to " << percent(v.error.back());
    told = rungs;
  }
  if (!told.empty()) md << " off.";
  md << "\n\n";
}

void write_ladder(const AccuracyStudy& study, std::ostream& md) {
  md << "| spacing | particles | steps | wall time | processor time | particle-steps | products, pressure | sub-steps, elastic | peak "
        "memory |";
  for (const std::string& quantity : study.quantities) md << " " << quantity << " |";
  md << "\n|---|---|---|---|---|---|---|---|---|";
  for (std::size_t q = 0; q < study.quantities.size(); ++q) md << "---|";
  md << "\n";
  for (std::size_t k : ladder_of(study)) {
    const AccuracyPoint& p = study.points[k];
    md << "| " << length(p.spacing) << (p.scene_itself ? " (the scene's)" : "") << " | " << number(p.particles, 8) << " | "
       << number(p.steps, 8) << " | " << range(p.wall) << " | " << range(p.processor) << " | " << number(p.particle_steps()) << " | "
       << number(p.pressure_products, 8) << " | " << number(p.elastic_substeps, 8) << " | " << number(p.peak_memory / 1048576.0)
       << " MiB |";
    for (double error : p.error) md << " " << percent(error) << " |";
    md << "\n";
  }
  md << "\n";
}

void write_costs(const AccuracyStudy& study, std::ostream& md) {
  md << "| quantity | 5 % | 2 % | 1 % | observed order | noise (jittered starts) | reference known to | scene's own settings |\n"
     << "|---|---|---|---|---|---|---|---|\n";
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const CostError points = cost_and_error(study, static_cast<int>(q));
    std::vector<double> cost, error;
    for (std::size_t k : pareto_front(points.cost, points.error)) cost.push_back(points.cost[k]), error.push_back(points.error[k]);
    md << "| " << study.quantities[q] << " |";
    for (const double wanted : {0.05, 0.02, 0.01}) {
      const auto reached = cost_to_reach(cost, error, wanted);
      md << " " << (reached ? (!cost.empty() && *reached == cost.front() ? "at most " : "") + duration_text(*reached) : "not reached")
         << " |";
    }
    const LadderValues v = ladder_values(study, q);
    const auto order = observed_order(v.spacing, v.error);
    md << " "
       << (order ? number(order->exponent, 2) + (v.error.size() > 2 ? " (scatter " + percent(order->scatter) + ")" : " (two points)")
                 : "no order")
       << " | " << (q < study.noise.size() ? percent(study.noise[q]) : "-") << " | "
       << (q < study.uncertainty.size() && study.uncertainty[q] > 0 ? percent(study.uncertainty[q]) : "-") << " | ";
    const auto over = default_over_front(study, static_cast<int>(q));
    const auto beyond_noise = default_over_front_beyond_noise(study, q);
    md << (over ? number(*over, 2) + "× the front's cost" : "not run");
    if (over && beyond_noise && *over > 2)
      md << (*beyond_noise <= 2 ? "; " + number(*beyond_noise, 2) + "× of what is better by more than the noise" : ", **beyond 2×**");
    md << " |\n";
  }
  md << "\n";
}

void write_knobs(const AccuracyStudy& study, std::ostream& md) {
  bool any = false;
  for (const AccuracyPoint& p : study.points) {
    if (p.curve == "spacing" || p.curve == "seed" || p.change.empty()) continue;
    if (!any) {
      md << "Other knobs, at spacing " << length(p.spacing) << ":\n\n| knob | value | cost |";
      for (const std::string& quantity : study.quantities) md << " " << quantity << ": changes by | error |";
      md << "\n|---|---|---|";
      for (std::size_t q = 0; q < study.quantities.size(); ++q) md << "---|---|";
      md << "\n";
      any = true;
    }
    double base = std::nan("");
    for (std::size_t k : ladder_of(study))
      if (study.points[k].spacing == p.spacing) base = cost_of(study.points[k], study.clock);
    md << "| " << p.curve << " | " << p.value << " | " << number(cost_of(p, study.clock) / base, 2) << "× |";
    for (std::size_t q = 0; q < p.error.size(); ++q) md << " " << percent(p.change[q]) << " | " << percent(p.error[q]) << " |";
    md << "\n";
  }
  if (!any) return;
  md << "\n";
  const std::vector<FreeKnob> knobs = free_knobs(study);
  if (knobs.empty()) {
    md << "None of them can be loosened for nothing: what is cheaper changes an answer by more than a tenth of its error.\n\n";
    return;
  }
  md << "Loosened for nothing (the answers change by less than a tenth of their error, or by less than the noise):";
  for (const FreeKnob& knob : knobs)
    md << " " << knob.curve << " = " << knob.value << " (" << number(knob.cost_factor, 2) << "× the cost);";
  md << "\n\n";
}

void write_csv(const AccuracyStudy& study, std::ostream& csv) {
  csv << "curve,value,settings,threads,spacing,repeats,wall_seconds,wall_lowest,wall_highest,processor_seconds,steps,particles,particle_"
         "steps,"
         "pressure_products,elastic_substeps,peak_memory,quantity,error,change,uncertainty,noise,on_front\n";
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const CostError all = cost_and_error(study, static_cast<int>(q));
    const std::vector<std::size_t> front = pareto_front(all.cost, all.error);
    for (std::size_t k = 0; k < study.points.size(); ++k) {
      const AccuracyPoint& p = study.points[k];
      const auto at = [&](const std::vector<double>& list) { return q < list.size() && std::isfinite(list[q]) ? number(list[q], 8) : ""; };
      std::string settings;
      for (const std::string& setting : p.settings) settings += (settings.empty() ? "" : " ") + setting;
      for (char& c : settings) c = c == '"' ? '\'' : c;
      csv << p.curve << ",\"" << p.value << "\",\"" << settings << "\"," << p.threads << "," << number(p.spacing, 10) << ","
          << p.wall.size() << "," << number(median(p.wall), 8) << "," << number(*std::min_element(p.wall.begin(), p.wall.end()), 8) << ","
          << number(*std::max_element(p.wall.begin(), p.wall.end()), 8) << ","
          << (p.processor.empty() ? "" : number(median(p.processor), 8)) << "," << number(p.steps, 12) << "," << number(p.particles, 12)
          << "," << number(p.particle_steps(), 12) << "," << number(p.pressure_products, 12) << "," << number(p.elastic_substeps, 12) << ","
          << number(p.peak_memory, 12) << ",\"" << study.quantities[q] << "\"," << at(p.error) << "," << at(p.change) << ","
          << at(study.uncertainty) << "," << at(study.noise) << "," << (std::find(front.begin(), front.end(), k) != front.end() ? 1 : 0)
          << "\n";
    }
  }
}

}  // namespace

std::string study_text(const AccuracyStudy& study, const std::string& picture, int heading) {
  std::ostringstream md;
  md << std::string(static_cast<std::size_t>(heading), '#') << " " << (heading == 1 ? "What accuracy costs: " : "") << study.title
     << "\n\n";
  write_plain_words(study, md);
  std::size_t repeats = 0;
  for (const AccuracyPoint& p : study.points) repeats = std::max(repeats, p.wall.size());
  md << "Errors are relative, against " << study.against << "; cost is the median of "
     << (study.clock == CostClock::wall ? "the wall time" : "the processor time of all threads") << " of up to " << repeats << " runs, "
     << study.threads << (study.threads == 1 ? " thread" : " threads") << ".";
  if (study.against_finest)
    md << " The finest run has an error of its own, which stands as the reference's uncertainty (its difference to the next one, taken to "
          "fall "
          "on with the observed order, or in proportion to the spacing where there is none).";
  md << "\n\n";
  if (!picture.empty()) md << "![log error over log cost](" << picture << ")\n\n";
  write_ladder(study, md);
  write_costs(study, md);
  write_knobs(study, md);
  if (!study.left_out.empty()) {
    md << "Planned, but not in these figures:\n\n";
    for (const std::string& line : study.left_out) md << "- " << line << "\n";
    md << "\n";
  }
  return md.str();
}

void write_study(const AccuracyStudy& study, const std::filesystem::path& folder) {
  std::ofstream(folder / "accuracy.json") << study_json(study).dump(1) << "\n";
  std::ofstream csv(folder / "accuracy.csv"), md(folder / "accuracy.md");
  write_csv(study, csv);
  render::write_png(work_precision_picture(study), (folder / "accuracy.png").string());
  md << study_text(study, "accuracy.png");
  if (!csv.flush() || !md.flush()) throw std::runtime_error((folder / "accuracy.md").string() + ": can't be written");
}

}  // namespace app
