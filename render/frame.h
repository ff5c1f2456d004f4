// What is to be drawn: owned copies, plain data, nothing that points into a solver. Lengths in metres, values in SI units; a colour scale
// says in which unit they are shown. A Frame becomes an Image in renderer.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "render/camera.h"
#include "render/colormap.h"

namespace render {

// --- things -----------------------------------------------------------------------------------------------------------------------------

// Particles of one kind. Each field holds one value a particle, in SI units.
struct ParticleSet {
  std::string name;
  std::vector<Eigen::Vector3f> positions;  // m; in a 2-D scene z = 0
  std::vector<std::vector<float>> fields;  // each as long as positions
  float radius = 0.5e-3f;                  // m, > 0, of the drawn sphere or disc
};

// A triangle surface: a vessel, or the mid-surface of a leaflet that gets its skin from `thickness`.
struct Surface {
  std::string name;
  std::vector<Eigen::Vector3f> vertices;  // m
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::vector<float>> fields;  // each as long as vertices
  float thickness = 0;                     // m; > 0: drawn as a skin on both sides with a rim
  int smoothing = 0;                       // levels of Loop subdivision before drawing, 0 ... 3
  int averaging = 0;                       // passes of area-weighted recovery of the fields before drawing (fairing.h), >= 0
  int fairing = 0;                         // rounds of fairing of the positions before drawing (fairing.h), >= 0
};

// A line through points: an attachment, an annulus, a section; in a 2-D scene a beam.
struct Line {
  std::string name;
  std::vector<Eigen::Vector3f> points;     // m
  std::vector<std::vector<float>> fields;  // each as long as points
  bool closed = false;
};

// A named point: drawn as a ball with its text beside it.
struct Mark {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // m
  float radius = 0;                                    // m; 0 = text alone
  std::string text;                                    // may be empty
  Color color = Color(0.1f, 0.1f, 0.1f);
};

// --- how they look ----------------------------------------------------------------------------------------------------------------------

// A colour scale that stays the same from frame to frame. Shown value = value * factor, in `unit`.
struct ColorScale {
  std::string label;                // "Pressure of the blood"
  std::string unit;                 // "kPa"
  double factor = 1;                // shown value per SI value, e.g. 1e-3
  double minimum = 0, maximum = 1;  // SI; maximum > minimum
  Colormap map = Colormap::viridis;
  std::optional<double> highest{};  // SI: the largest value now, before any smoothing; marked on the bar and written beneath it
};

// Colour by a field on a scale, or (field = -1) plain.
struct Style {
  int field = -1;                            // index into the thing's fields; -1: plain colour
  int scale = -1;                            // index into Frame::scales; needed where field >= 0
  Color color = Color(0.75f, 0.75f, 0.75f);  // sRGB 0 ... 1, for what has no field
  float opacity = 1;                         // of a surface, 0 ... 1; below 1 it is drawn as glass, in the right order
  bool clipped = true;                       // the panel's clip plane cuts it
};

enum class ParticleShape { sphere, disc };  // disc: flat, for 2-D scenes
struct ParticleLayer {
  int set = 0;  // index into Frame::particles
  Style style;
  ParticleShape shape = ParticleShape::sphere;
  bool section = false;  // where the clip plane cuts the particles, a continuous field instead of cut balls
};
struct SurfaceLayer {
  int surface = 0;  // index into Frame::surfaces
  Style style;
  bool rim = false;      // a dark line along the surface's border
  bool section = false;  // a dark line where the clip plane cuts it
};
struct LineLayer {
  int line = 0;  // index into Frame::lines
  Style style;
  float pixels = 3;     // width at 1080 rows, scaled with the picture
  float metres = 0;     // > 0: width in metres instead
  bool on_top = false;  // drawn over everything
};

// What lies on the side the normal points to is cut away.
struct ClipPlane {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();    // m
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  // unit
};

// A named direction for the orientation marker.
struct Direction {
  std::string name;
  Eigen::Vector3f vector = Eigen::Vector3f::UnitX();  // unit
  Color color = Color(0.2f, 0.2f, 0.2f);
};

// One picture within the frame.
struct Panel {
  std::string title;
  std::string note;  // beneath the title: what differs between panels
  Camera camera;
  std::optional<ClipPlane> clip;
  std::vector<ParticleLayer> particles;
  std::vector<SurfaceLayer> surfaces;
  std::vector<LineLayer> lines;
  std::vector<int> marks;             // indices into Frame::marks
  std::vector<int> legends;           // indices into Frame::scales, shown as colour bars
  std::vector<Direction> directions;  // orientation marker; none = no marker
  bool scale_bar = true;
};

// A plot over time beneath the panels.
struct Curve {
  std::string label;
  Color color = Color(0.1f, 0.1f, 0.1f);
  std::vector<double> time, value;  // s; shown unit of the plot
};
struct Plot {
  std::string label, unit;
  std::vector<Curve> curves;
};

// --- the frame --------------------------------------------------------------------------------------------------------------------------
struct Frame {
  std::string title;                                                          // top left: the case's label, never a patient's name
  std::string subtitle;                                                       // beneath it: the settings that matter
  std::optional<double> time;                                                 // s, top right; also the cursor of the plots
  std::string time_text;                                                      // written instead of the time where given: "load 0.50"
  std::vector<std::string> readouts;                                          // beneath the time: "LV 12.3 kPa (92 mmHg)"
  std::vector<std::string> warnings;                                          // bottom left, marked
  std::string caption = "For planning research, not for clinical decisions";  // bottom right

  std::vector<ColorScale> scales;
  std::vector<ParticleSet> particles;
  std::vector<Surface> surfaces;
  std::vector<Line> lines;
  std::vector<Mark> marks;

  std::vector<Panel> panels;  // left to right, then down
  int columns = 0;            // panels a row; 0 = all in one row
  std::vector<Plot> plots;    // a strip beneath the panels; none = no strip
  Color background_top = Color(0.97f, 0.98f, 0.99f), background_bottom = Color(0.83f, 0.86f, 0.89f);
};

// All panels of `frames` in one frame, in order, each keeping its things; time, readouts, plots and captions from the first, titles joined.
// Scales of the same label are widened to a common range.
Frame side_by_side(const std::vector<Frame>& frames);

// Throws std::invalid_argument with one line that names the first thing wrong (an index out of range, a field of the wrong length, ...).
void check_frame(const Frame& frame);

}  // namespace render
