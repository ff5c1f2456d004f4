#include "sim/lumped_heart.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace sim {
namespace {

constexpr double pascals = 133.322;

// State of the circulation between two steps.
struct Circulation {
  double volume = 130;    // mL, ventricle
  double flow = 0;        // mL/s through the aortic valve
  double capacitor = 80;  // mmHg, pressure over the compliance

  // One semi-implicit Euler step. Valve: L dQ/dt = P_LV - P_ao - R Q - B Q |Q|, no back flow. P_ao = Zc Q + P_c, C dP_c/dt = Q - P_c / Rp.
  void advance(const HeartParameters& p, double time, double dt) {
    const double pressure = ventricle(p, time), mitral = std::max(0.0, (p.venous_pressure - pressure) / p.mitral_resistance);
    const double push = pressure - capacitor, drag = p.resistance + p.characteristic + p.bernoulli * std::abs(flow);
    flow = std::max(0.0, (flow + dt / p.inertance * push) / (1 + dt / p.inertance * drag));
    capacitor += dt / p.compliance * (flow - capacitor / p.peripheral);
    volume += dt * (mitral - flow);
  }
  double ventricle(const HeartParameters& p, double time) const {
    return (p.emin + (p.emax - p.emin) * normalised_elastance(time, p.contraction)) * (volume - p.unstressed_volume);
  }
};

}  // namespace

double normalised_elastance(double time, double contraction) {
  const double rise = std::pow(time / contraction / 0.7, 1.9);
  return 1.55 * rise / (1 + rise) / (1 + std::pow(time / contraction / 1.17, 21.9));
}

HeartBeat simulate_heart(const HeartParameters& p, int samples) {
  constexpr int beats = 25, substeps = 50;  // 25 beats: the Windkessel's memory of 1.5 s is gone
  const int steps = samples * substeps;
  const double dt = p.period / steps;
  Circulation heart;
  HeartBeat beat;
  for (int k = 0; k < beats; ++k)
    for (int i = 0; i <= steps; ++i) {
      const double time = i * dt;
      if (k + 1 == beats && i % substeps == 0) {
        beat.time.push_back(time), beat.flow.push_back(heart.flow), beat.volume.push_back(heart.volume);
        beat.ventricle.push_back(heart.ventricle(p, time)), beat.aorta.push_back(heart.capacitor + p.characteristic * heart.flow);
      }
      if (i == steps) break;
      const double before = heart.flow;
      heart.advance(p, time, dt);
      if (k + 1 < beats) continue;
      if (before == 0 && heart.flow > 0 && beat.opens == 0) beat.opens = time;
      if (before > 0 && heart.flow == 0) beat.closes = time;
      beat.stroke_volume += heart.flow * dt;
    }
  beat.systolic = *std::max_element(beat.aorta.begin(), beat.aorta.end());
  beat.diastolic = *std::min_element(beat.aorta.begin(), beat.aorta.end());
  return beat;
}

HeartParameters fit_heart(const CuffReadings& readings) {
  const auto refuse = [&](const char* why) -> void {
    char text[256];
    std::snprintf(text, sizeof text, "no heart beats %g a minute with %g/%g mmHg and %g mL: %s", readings.heart_rate, readings.systolic,
                  readings.diastolic, readings.stroke_volume, why);
    throw std::invalid_argument(text);
  };
  if (!(readings.heart_rate >= 20 && readings.heart_rate <= 220)) refuse("give 20 to 220 beats a minute");
  if (!(readings.diastolic >= 20 && readings.systolic > readings.diastolic + 5 && readings.systolic <= 260))
    refuse("give a systolic pressure above the diastolic one, in mmHg");
  if (!(readings.stroke_volume >= 10 && readings.stroke_volume <= 200)) refuse("give 10 to 200 mL");
  HeartParameters p;
  p.period = 60 / readings.heart_rate;
  p.contraction = 0.37 * std::sqrt(p.period / 0.8);
  p.emax = 2.2 * readings.systolic / 120;
  const double mean = readings.diastolic + (readings.systolic - readings.diastolic) / 3;
  p.peripheral = mean * p.period / readings.stroke_volume;
  p.compliance = 0.8 * readings.stroke_volume / (readings.systolic - readings.diastolic);
  const auto readings_of = [](const HeartParameters& heart) {
    const HeartBeat beat = simulate_heart(heart);
    return Eigen::Vector3d(std::log(beat.systolic), std::log(beat.diastolic), std::log(std::max(1e-6, beat.stroke_volume)));
  };
  const auto apply = [&](const Eigen::Vector3d& x) {
    HeartParameters heart = p;
    heart.peripheral = std::exp(x[0]), heart.compliance = std::exp(x[1]), heart.venous_pressure = std::exp(x[2]);
    return heart;
  };
  const Eigen::Vector3d goal(std::log(readings.systolic), std::log(readings.diastolic), std::log(readings.stroke_volume));
  Eigen::Vector3d x(std::log(p.peripheral), std::log(p.compliance), std::log(p.venous_pressure));
  for (int iteration = 0; iteration < 40; ++iteration) {
    const Eigen::Vector3d now = readings_of(apply(x)), miss = goal - now;
    if (miss.cwiseAbs().maxCoeff() < 2e-4) return apply(x);
    Eigen::Matrix3d slope;
    for (int k = 0; k < 3; ++k) slope.col(k) = (readings_of(apply(x + 1e-3 * Eigen::Vector3d::Unit(k))) - now) / 1e-3;
    Eigen::Vector3d change = slope.fullPivLu().solve(miss);
    change *= std::min(1.0, 0.4 / std::max(1e-12, change.cwiseAbs().maxCoeff()));  // at most 50 % a step
    if (!change.allFinite()) break;
    x += change;
  }
  refuse("the model finds no such beat; use other readings or tables");
  return p;
}

PortWaves port_waves(const HeartBeat& beat, double lead) {
  PortWaves waves;
  const double period = beat.time.back(), start = beat.opens - lead;
  const auto samples = beat.time.size() - 1;  // the last repeats the first
  const auto at = [&](const std::vector<double>& values, double time) {
    const double place = (time / period - std::floor(time / period)) * static_cast<double>(samples);
    const auto i = std::min(static_cast<std::size_t>(place), samples - 1);
    return values[i] + (place - static_cast<double>(i)) * (values[i + 1] - values[i]);
  };
  for (std::size_t i = 0; i <= samples; ++i) {
    const double time = period * static_cast<double>(i) / static_cast<double>(samples);
    waves.time.push_back(time);
    waves.ventricle.push_back(pascals * at(beat.ventricle, start + time)), waves.aorta.push_back(pascals * at(beat.aorta, start + time));
  }
  return waves;
}

}  // namespace sim
