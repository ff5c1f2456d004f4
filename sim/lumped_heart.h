// One heart beat from three cuff readings: a lumped left heart (elastance, mitral and aortic valve, three-element Windkessel) fitted to
// heart rate, systolic and diastolic pressure and stroke volume. Gives the pressures at a valve's two ports.
#pragma once

#include <vector>

namespace sim {

// Units of the model, as cardiologists use them: mmHg, mL, s.
struct HeartParameters {
  double period = 0.8;                                                  // s
  double emax = 2.2, emin = 0.05, unstressed_volume = 10;               // mmHg/mL, mmHg/mL, mL
  double venous_pressure = 6.9, mitral_resistance = 0.008;              // mmHg, mmHg s/mL
  double inertance = 8e-4, resistance = 0.004, bernoulli = 2e-5;        // aortic valve: mmHg s2/mL, mmHg s/mL, mmHg s2/mL2
  double characteristic = 0.045, compliance = 1.35, peripheral = 1.08;  // Windkessel: mmHg s/mL, mL/mmHg, mmHg s/mL
  double contraction = 0.37;                                            // s, time scale of the elastance
};

struct HeartBeat {
  std::vector<double> time;                               // s from the beginning of contraction, one period
  std::vector<double> ventricle, aorta, flow, volume;     // mmHg, mmHg, mL/s, mL
  double systolic = 0, diastolic = 0, stroke_volume = 0;  // mmHg, mmHg, mL
  double opens = 0, closes = 0;                           // s: first and last flow through the aortic valve
};

// Normalised elastance (double Hill, Mynard et al. 2012): tn = t / contraction,
// e = 1.55 [(tn/0.7)^1.9 / (1 + (tn/0.7)^1.9)] / (1 + (tn/1.17)^21.9).
double normalised_elastance(double time, double contraction);
// The periodic beat (after enough beats that pressures repeat), `samples` even times over a period and the end.
HeartBeat simulate_heart(const HeartParameters& parameters, int samples = 160);

struct CuffReadings {
  double heart_rate = 75;                 // 1/min
  double systolic = 120, diastolic = 80;  // mmHg
  double stroke_volume = 70;              // mL
};
// Peripheral resistance, compliance and filling pressure such that the beat has these readings (Newton's method on their logarithms);
// contraction's time scales with the square root of the period, emax with the systolic pressure. Throws std::invalid_argument (one line)
// where no heart of this model has them.
HeartParameters fit_heart(const CuffReadings& readings);

// A beat's pressures in Pa from just before the valve opens (t = 0), one period, for ports. `lead`: s before the opening.
struct PortWaves {
  std::vector<double> time, ventricle, aorta;  // s, Pa, Pa
};
PortWaves port_waves(const HeartBeat& beat, double lead = 0);

}  // namespace sim
