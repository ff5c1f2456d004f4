#include "sim/valve_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sim {
namespace {

constexpr double mmHg = 133.322;
const double none = std::numeric_limits<double>::quiet_NaN();

std::string text(const char* format, double value) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// The figures of one beat as they are put together.
struct Beat {
  const ValveSeries& series;
  const SummaryOptions& options;
  double from, to;
  ValveTimes times;
  double ejection_start = 0, reversal = 0, closed = 0;  // s: windows, always finite
  std::vector<Figure> figures;

  Curve curve(const std::string& column) const { return series.curve(column); }
  Figure& add(const std::string& key, const std::string& label, const std::string& units, double value, double uncertainty = none) {
    Figure figure;
    figure.key = key, figure.label = label, figure.units = units, figure.value = value, figure.uncertainty = uncertainty;
    figures.push_back(std::move(figure));
    return figures.back();
  }
};

// Forward flow from the opening to its first lasting reversal: the flow's last fall through zero before its most backward moment, or
// the first after the peak.
void find_windows(Beat& beat) {
  const Curve flow = beat.curve("valve_flow");
  beat.times = valve_times(beat.curve("orifice_area"), beat.from, beat.to);
  beat.ejection_start = std::isfinite(beat.times.opens) ? beat.times.opens : beat.from;
  const double peak = largest(flow, beat.from, std::isfinite(beat.times.closed) ? beat.times.closed : beat.to).time;
  beat.reversal = crossing(flow, 0, false, peak, beat.to).value_or(std::isfinite(beat.times.closed) ? beat.times.closed : beat.to);
  beat.closed = std::isfinite(beat.times.closed) ? std::max(beat.times.closed, beat.reversal) : beat.to;
}

// Resolution of an edge between rows l0 apart: its place is uniform within a row, standard deviation l0 / sqrt(12), all around alike.
double area_uncertainty(double area, double spacing) { return std::sqrt(4 * M_PI * area) * spacing / std::sqrt(12.0); }

void add_orifice(Beat& beat) {
  const Extreme top = largest(beat.curve("orifice_area"), beat.from, beat.to);
  Figure& largest_area =
      beat.add("orifice_area", "Geometric orifice area, largest", "m2", top.value, area_uncertainty(top.value, beat.options.spacing));
  largest_area.time = top.time;
  const double across = std::sqrt(4 * top.value / M_PI) / beat.options.spacing;
  if (across < 8) largest_area.warnings.push_back(text("only %.1f particles across: refine the spacing", across));
  if (beat.options.annulus_radius > 0)
    beat.add("orifice_use", "Largest orifice / annulus area", "1", top.value / (M_PI * std::pow(beat.options.annulus_radius, 2)));
}

void add_times(Beat& beat) {
  const ValveTimes& t = beat.times;
  const double step = beat.options.output;
  beat.add("rapid_opening_time", "Rapid opening time (RVOT)", "s", t.open - t.opens, step);
  if (t.starts_open) beat.figures.back().warnings.push_back("the record begins with the valve partly open: counted from there");
  if (std::isfinite(t.open) && t.open - t.opens < 5 * step)
    beat.figures.back().warnings.push_back("fewer than 5 outputs in it: lower time.output");
  beat.add("ejection_time", "Ejection time (ET)", "s", t.closed - t.opens, step);
  beat.add("rapid_closing_time", "Rapid closing time (RVCT)", "s", t.closed - t.closing, step);
  if (std::isfinite(t.closed) && t.closed - t.closing < 5 * step)
    beat.figures.back().warnings.push_back("fewer than 5 outputs in it: lower time.output");
  beat.add("slow_closing", "Slow closing displacement / largest opening", "1", t.slow_closing);
  if (!std::isfinite(t.closed))
    for (auto figure = beat.figures.end() - 3; figure != beat.figures.end(); ++figure)
      figure->warnings.push_back("the valve does not close within the record");
  const Curve tip = beat.curve("tip_speed");
  const double opened = std::isfinite(t.open) ? t.open : beat.to, closing = std::isfinite(t.closing) ? t.closing : beat.from;
  const Extreme opening = largest(tip, beat.ejection_start, opened);
  beat.add("tip_opening_speed", "Leaflet tip speed, opening", "m/s", opening.value, noise(tip, beat.ejection_start, opened)).time =
      opening.time;
  if (!std::isfinite(t.closed)) return;
  const Extreme shutting = smallest(tip, closing, t.closed);
  beat.add("tip_closing_speed", "Leaflet tip speed, closing", "m/s", -shutting.value, noise(tip, closing, t.closed)).time = shutting.time;
}

void add_flow_figures(Beat& beat) {
  const double from = beat.ejection_start, to = beat.reversal, duration = to - from;
  const Curve jet = beat.curve("jet_speed"), difference = beat.curve("pressure_difference"), flow = beat.curve("valve_flow");
  if (duration <= 0 || flow.empty()) return;
  const Extreme fastest = largest(jet, from, to), steepest = largest(difference, from, to);
  const double jet_noise = noise(jet, from, to), pressure_noise = noise(difference, from, to);
  const double samples = std::max(1.0, duration / std::max(1e-12, beat.options.output));
  beat.add("peak_jet_speed", "Peak jet speed", "m/s", fastest.value, jet_noise).time = fastest.time;
  beat.add("peak_pressure_difference", "Peak pressure difference (ventricle - aorta)", "Pa", steepest.value, pressure_noise).time =
      steepest.time;
  const double mean_difference = mean(difference, from, to);
  beat.add("mean_pressure_difference", "Mean pressure difference during ejection", "Pa", mean_difference,
           pressure_noise / std::sqrt(samples));
  Curve bernoulli = jet;  // 4 V^2 mmHg, V in m/s
  for (double& value : bernoulli.value) value = 4 * mmHg * value * value;
  beat.add("bernoulli_peak", "4 V² of the peak jet speed", "Pa", 4 * mmHg * fastest.value * fastest.value,
           8 * mmHg * fastest.value * jet_noise);
  beat.add("bernoulli_mean", "4 V² averaged over ejection", "Pa", mean(bernoulli, from, to));
  const double forward = integral(flow, from, to), distance = integral(jet, from, to);
  Figure& continuity =
      beat.add("effective_orifice_area", "Effective orifice area (continuity)", "m2", distance > 0 ? forward / distance : none);
  if (distance > 0) continuity.uncertainty = continuity.value * jet_noise / std::max(1e-12, distance / duration);
  Figure& gorlin = beat.add("gorlin_area", "Effective orifice area (Gorlin)", "m2", none);
  if (mean_difference > 0)  // A [cm2] = flow [mL/s] / (44.3 sqrt(dp [mmHg]))
    gorlin.value = 1e-4 * (1e6 * forward / duration) / (44.3 * std::sqrt(mean_difference / mmHg));
  gorlin.warnings.push_back(mean_difference > 0
                                ? mean_difference < 10 * mmHg ? "Gorlin's formula is made for stenoses: mean difference below 10 mmHg" : ""
                                : "no mean pressure difference to work with");
  if (gorlin.warnings.back().empty()) gorlin.warnings.clear();
}

void add_volumes(Beat& beat) {
  const Curve flow = beat.curve("valve_flow"), in = beat.curve("port." + beat.options.ventricle + ".flow"),
              out = beat.curve("port." + beat.options.aorta + ".flow");
  if (flow.empty()) return;
  // Rigid walls: what comes in leaves; half the difference of both ends is the flow's error.
  const auto error = [&](double from, double to) {
    return in.empty() || out.empty() ? none : 0.5 * std::abs(integral(in, from, to) + integral(out, from, to));
  };
  const double opens = beat.ejection_start, back = beat.reversal, shut = beat.closed;
  const double forward = integral(flow, opens, back), closing = -integral(flow, back, shut);
  const double leak = -integral(flow, shut, beat.to) - integral(flow, beat.from, opens), backward = closing + leak;
  beat.add("stroke_volume", "Stroke volume (net forward)", "m3", forward - backward, error(beat.from, beat.to));
  beat.add("forward_volume", "Forward volume", "m3", forward, error(opens, back));
  beat.add("closing_volume", "Closing volume", "m3", closing, error(back, shut));
  Figure& leaked = beat.add("leak_volume", "Leak through the closed valve", "m3", leak, error(shut, beat.to));
  const double closed_time = beat.to - shut;
  if (closed_time < 0.1 * (beat.to - beat.from)) leaked.warnings.push_back("hardly any of the record has a closed valve");
  beat.add("regurgitant_volume", "Regurgitant volume (closing + leak)", "m3", backward, error(back, beat.to));
  Figure& fraction = beat.add("regurgitant_fraction", "Regurgitant fraction", "1", forward > 0 ? backward / forward : none,
                              forward > 0 ? error(back, beat.to) / forward : none);
  if (forward > 0 && std::abs(leak) > 0.1 * forward)
    fraction.warnings.push_back(
        text("the closed valve passes %.0f %% of the forward volume: it does not seal at this resolution", 100 * leak / forward));
}

void add_closed_shape(Beat& beat) {
  if (!std::isfinite(beat.times.closed) || beat.closed >= beat.to) return;
  for (const auto& [column, label, units] :
       {std::tuple{"coaptation_area", "Coaptation area, valve closed", "m2"},
        std::tuple{"coaptation_height", "Coaptation height, mean along the free edges", "m"},
        std::tuple{"central_coaptation", "Central coaptation depth", "m"}, std::tuple{"effective_height", "Effective height", "m"}}) {
    const Curve curve = beat.curve(column);
    Figure& figure = beat.add(column, label, units, median(curve, beat.closed, beat.to), half_spread(curve, beat.closed, beat.to));
    if (units == std::string("m")) figure.uncertainty = std::max(figure.uncertainty, beat.options.spacing / std::sqrt(12.0));
    if (figure.uncertainty > 0.5 * std::abs(figure.value)) figure.warnings.push_back("fluctuates by more than half its size while closed");
  }
}

void add_stress(Beat& beat) {
  const auto extreme = [&](const std::string& key, const std::string& label, const char* column, double from, double to) {
    const Curve curve = beat.curve(column);
    const Extreme top = largest(curve, from, to);
    beat.add(key, label, "Pa", top.value, noise(curve, from, to)).time = top.time;
  };
  extreme("stress_systole", "Leaflet stress (von Mises, 99th percentile), systole", "leaflet_stress_p99", beat.ejection_start,
          beat.reversal);
  extreme("principal_systole", "Leaflet stress (largest principal, 99th percentile), systole", "leaflet_principal_p99", beat.ejection_start,
          beat.reversal);
  if (std::isfinite(beat.times.closed) && beat.closed < beat.to) {
    extreme("stress_diastole", "Leaflet stress (von Mises, 99th percentile), diastole", "leaflet_stress_p99", beat.closed, beat.to);
    extreme("principal_diastole", "Leaflet stress (largest principal, 99th percentile), diastole", "leaflet_principal_p99", beat.closed,
            beat.to);
    const Curve stress = beat.curve("leaflet_stress_p99");
    beat.add("stress_diastole_median", "the same, median over diastole", "Pa", median(stress, beat.closed, beat.to),
             half_spread(stress, beat.closed, beat.to));
  }
  const Extreme strain = largest(beat.curve("leaflet_strain_p99"), beat.from, beat.to);
  Figure& stretched = beat.add("leaflet_strain", "Leaflet membrane strain (99th percentile)", "1", strain.value);
  stretched.time = strain.time;
  if (strain.value > 0.3) stretched.warnings.push_back("beyond what human leaflets bear (18 to 30 %): stress there is not physiology");
  const Extreme shear = largest(beat.curve("leaflet_wall_shear_p99"), beat.from, beat.to);
  Figure& wall = beat.add("wall_shear", "Wall shear stress on leaflets (99th percentile), largest", "Pa", shear.value);
  wall.time = shear.time;
  wall.warnings.push_back(text("a boundary layer is thinner than the spacing of %.2g mm: a lower bound", 1e3 * beat.options.spacing));
  beat.add("wall_shear_mean", "Wall shear stress on leaflets, mean over leaflets and beat", "Pa",
           mean(beat.curve("leaflet_wall_shear_mean"), beat.from, beat.to));
}

std::vector<LeafletStress> leaflet_table(const Beat& beat) {
  std::vector<LeafletStress> table;
  for (int leaflet = 1;; ++leaflet)
    for (const LeafletRegion region : reported_regions) {
      const std::string name = "leaflet_" + std::to_string(leaflet) + "." + region_name(region);
      const Curve von_mises = beat.curve(name + ".von_mises"), principal = beat.curve(name + ".principal");
      if (von_mises.empty()) return table;
      const Extreme a = largest(von_mises, beat.from, beat.to), b = largest(principal, beat.from, beat.to);
      table.push_back({leaflet, region, a.value, b.value, a.time, b.time});
    }
}

void say_where(ValveSummary& summary) {
  const LeafletStress* worst = nullptr;
  for (const LeafletStress& one : summary.leaflets)
    if (!worst || one.von_mises > worst->von_mises) worst = &one;
  if (!worst) return;
  Figure figure;
  figure.key = "stress_peak", figure.label = "Largest regional leaflet stress (von Mises)", figure.units = "Pa";
  figure.value = worst->von_mises, figure.time = worst->von_mises_time;
  figure.note = "leaflet " + std::to_string(worst->leaflet) + ", " + region_name(worst->region);
  std::replace(figure.note.begin(), figure.note.end(), '_', ' ');
  double lowest = worst->von_mises;  // the same region on the other leaflets: how symmetric the valve is
  for (const LeafletStress& one : summary.leaflets)
    if (one.region == worst->region) lowest = std::min(lowest, one.von_mises);
  figure.uncertainty = 0.5 * (worst->von_mises - lowest);
  summary.figures.push_back(figure);
}

Beat beat_of(const ValveSeries& series, const SummaryOptions& options, double from, double to) {
  Beat beat{series, options, from, to, {}, 0, 0, 0, {}};
  find_windows(beat);
  add_orifice(beat), add_flow_figures(beat), add_times(beat), add_volumes(beat), add_closed_shape(beat), add_stress(beat);
  return beat;
}

void warn_about_run(ValveSummary& summary, const ValveSeries& series, double covered, const SummaryOptions& options) {
  if (covered < 0.98 * options.period)
    summary.warnings.push_back(text("the record covers %.0f %% of a beat only", 100 * covered / options.period));
  if (series.from_frames) summary.warnings.push_back("an older run file: the figures were computed from its frames");
  const Curve crossings = series.curve("sheet_crossings");
  if (!crossings.empty() && crossings.value.back() > 0)
    summary.warnings.push_back(text("%.0f blood particles were put back that had passed through a leaflet", crossings.value.back()));
}

// With several beats the spread over those after the first, a transient, is the uncertainty (of two: their difference).
void compare_beats(ValveSummary& summary, const std::vector<Beat>& beats) {
  if (beats.size() < 2) return;
  for (Figure& figure : summary.figures) {
    double low = figure.value, high = figure.value;
    for (std::size_t k = beats.size() > 2 ? 1 : 0; k < beats.size(); ++k)
      for (const Figure& other : beats[k].figures)
        if (other.key == figure.key && std::isfinite(other.value)) low = std::min(low, other.value), high = std::max(high, other.value);
    if (std::isfinite(figure.value))
      figure.uncertainty = std::max(std::isfinite(figure.uncertainty) ? figure.uncertainty : 0, 0.5 * (high - low));
  }
}

}  // namespace

ValveSummary summarise_valve(const ValveSeries& series, const SummaryOptions& options) {
  ValveSummary summary;
  if (series.rows.size() < 3) {
    summary.warnings.push_back("fewer than three outputs: no figures");
    return summary;
  }
  const double start = series.rows.front()[0], end = series.rows.back()[0], covered = end - start;
  const int whole = std::max(1, static_cast<int>(std::floor(covered / options.period + 0.02)));
  std::vector<Beat> beats;
  for (int k = 0; k < whole; ++k)
    beats.push_back(beat_of(series, options, start + k * options.period, std::min(end, start + (k + 1) * options.period)));
  const Beat& last = beats.back();
  summary.figures = last.figures, summary.times = last.times, summary.beats = whole;
  summary.beat_start = last.from, summary.beat_end = last.to;
  summary.leaflets = leaflet_table(last);
  say_where(summary);
  compare_beats(summary, beats);
  warn_about_run(summary, series, covered, options);
  return summary;
}

}  // namespace sim
