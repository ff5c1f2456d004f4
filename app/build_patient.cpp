#include "app/case_parts.h"

namespace app {

CaseParticles place_patient(const SceneFile& scene) { refuse(scene.patient->spot, "valve cases are still being built", "use bodies"); }
void set_patient_wave(const PatientSpec&, sim::Port<3>&) {}

}  // namespace app
