// From a run file's frame to a render::Frame: which things are shown, from where, in which colours, with which words.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/picture_fields.h"
#include "render/frame.h"
#include "sim/run_file.h"

namespace app {

// What the user may choose. Empty = what suits the run.
struct PictureChoice {
  // Valve: long_axis, short_axis, from_aorta, from_ventricle; pair (blood's pressure and the valve's stress, both along the long axis),
  // standard (pair and from_aorta). Other 3-D: oblique, front, side, top. 2-D: plane.
  std::vector<std::string> views;
  // pressure, speed (of the blood); stress, principal_stress, displacement (of the solids). One for all views, or one each.
  std::vector<std::string> fields;
  FieldRanges ranges;                  // SI, over those of the run itself
  std::string map;                     // colour map of all fields
  std::string pressure_units = "kPa";  // or mmHg, Pa
  bool balls = false;                  // blood as particles where it is cut, not as a continuous field
  bool walls = false;                  // show the wall's particles in 3-D too
  std::string label;                   // instead of the run's title
};

// One panel to be: a view and the field it shows.
struct View {
  std::string view, field;
};
// The choice spelt out for a run. Throws std::invalid_argument naming what is unknown and what there is. `alone`: no other run beside it.
std::vector<View> chosen_views(const PictureChoice& choice, const sim::RunHeader& header, bool alone);

// A run's sheets as pictures show them: of a valve's leaflets, without the triangles that are held at all three corners. Those are anchored
// in the wall, and what lies beyond the attachment is no tissue.
std::vector<sim::RunHeader::ShellInfo> visible_shells(const sim::RunReader& run);

// Makes the frames of one run; the reader must outlive it.
class FrameMaker {
 public:
  // `ranges`: of all runs that are shown together (field_ranges).
  FrameMaker(const sim::RunReader& run, PictureChoice choice, const FieldRanges& ranges, bool alone = true);
  render::Frame make(std::size_t index) const;
  // The panel of any view and field of the run, for a frame that make() returned.
  render::Panel panel(const View& view, const render::Frame& frame) const;
  const std::vector<double>& times() const { return times_; }
  // Places of the first frame, m, one a row.
  const std::vector<std::array<double, 3>>& start() const { return start_; }

 private:
  void add_particles(render::Frame& frame, const sim::RunFrame& state) const;
  void add_shells(render::Frame& frame, const sim::RunFrame& state) const;
  void add_highest(render::Frame& frame) const;
  void add_words(render::Frame& frame, const sim::RunFrame& state, std::size_t index) const;

  const sim::RunReader& run_;
  PictureChoice choice_;
  FieldRanges ranges_;
  std::vector<View> views_;
  std::vector<double> times_;
  std::vector<std::array<double, 3>> start_;                       // positions of the first frame
  render::Bounds bounds_;                                          // of all that moves, over the run
  Eigen::Vector3f toward_leaflet_ = Eigen::Vector3f::UnitX();      // unit, across the valve's axis to the first leaflet's middle
  std::vector<sim::RunHeader::ShellInfo> shells_;                  // without what lies within the wall
  std::vector<std::vector<std::vector<std::int32_t>>> stand_ins_;  // per shell and particle: whose stress a held one shows; mostly empty
  render::Surface lumen_, root_;                                   // the whole vessel, and its part about the valve
  std::vector<render::Plot> plots_;
  std::vector<std::vector<double>> series_;
  std::vector<std::string> warnings_;
};

// --- parts (picture_views.cpp, picture_words.cpp) -------------------------------------------------------------------------------------

// Where each kind of thing stands in the frames that FrameMaker makes. Sets and scales that a run lacks are empty, not missing.
enum ParticleSlot { fluid_set = 0, solid_set = 1, wall_set = 2 };
enum SurfaceSlot { lumen_surface = 0, root_surface = 1, first_leaflet = 2 };
int scale_slot(const std::string& field);  // scales: fluid_fields, then solid_fields, in order

// The panel of a view. `frame` holds the things already.
render::Panel make_panel(const View& view, const render::Frame& frame, const sim::RunHeader& header, const PictureChoice& choice,
                         const render::Bounds& bounds, const Eigen::Vector3f& toward_leaflet);

// "120 mmHg (16.0 kPa)"
std::string pressure_text(double pascals);
// Curves for the strip beneath: the valve's pressures; else the first probes.
std::vector<render::Plot> make_plots(const sim::RunHeader& header, const std::vector<std::vector<double>>& series);
// Pressures, orifice area and flow at a moment, as far as the run has them.
std::vector<std::string> make_readouts(const sim::RunHeader& header, const std::vector<std::vector<double>>& series, double time);
std::string settings_text(const sim::RunHeader& header);

// The points of a 2-D shell's segments chained end to end; a closed ring comes back to its first point.
std::vector<std::int32_t> chain(const std::vector<std::array<std::int32_t, 3>>& segments);

}  // namespace app
