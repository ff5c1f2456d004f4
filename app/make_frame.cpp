#include "app/make_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "render/skin.h"

namespace app {
namespace {

constexpr float drawn_radius = 0.62f;       // of the spacing, in 3-D: neighbours overlap, so that a body shows no gaps
constexpr float flat_radius = 0.71f;        // likewise for the discs of 2-D
constexpr std::size_t finely_drawn = 1500;  // triangles: a leaflet of fewer is smoothed by two levels, else one
constexpr float contact_distance = 0.8f;    // of the spacing: two leaflets in contact are this far apart (docs/), and drawn as touching

Eigen::Vector3f point(const std::array<double, 3>& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

sim::Kind kind_of(const sim::RunFrame& frame, std::size_t row) { return static_cast<sim::Kind>(frame.kind[row]); }

// The first frame, the last and some between.
std::vector<sim::RunFrame> frames_over(const sim::RunReader& run) {
  const std::size_t count = run.frame_count(), looked_at = std::min<std::size_t>(count, 8);
  std::vector<sim::RunFrame> frames;
  for (std::size_t i = 0; i < looked_at; ++i) frames.push_back(run.frame(looked_at > 1 ? i * (count - 1) / (looked_at - 1) : 0));
  return frames;
}

// What moves over the run.
render::Bounds bounds_over(const std::vector<sim::RunFrame>& frames, double spacing) {
  render::Bounds bounds;
  const auto radius = static_cast<float>(flat_radius * spacing);
  for (const sim::RunFrame& frame : frames)
    for (std::size_t row = 0; row < frame.size(); ++row) {
      const Eigen::Vector3f p = point(frame.position[row]);
      if (kind_of(frame, row) != sim::Kind::wall && kind_of(frame, row) != sim::Kind::port && p.allFinite()) bounds.add(p, radius);
    }
  return bounds;
}

// The vessel from a little below the annulus to a little above the commissures.
render::Surface root_part(const render::Surface& lumen, const sim::ValveFrame& valve) {
  const Eigen::Vector3f annulus = valve.annulus_center.cast<float>(), axis = valve.axis.cast<float>();
  const auto radius = static_cast<float>(valve.annulus_radius), height = static_cast<float>(valve.commissure_height);
  return render::cut_away(render::cut_away(lumen, {annulus - 0.7f * radius * axis, -axis}),
                          {annulus + (height + 0.6f * radius) * axis, axis});
}

// Whether each particle of a body stays exactly where it was in all `seen` frames: it is held (or nothing has moved yet).
std::vector<bool> held_rows(const sim::RunHeader::BodyInfo& body, const std::vector<sim::RunFrame>& seen) {
  std::vector<bool> held(static_cast<std::size_t>(body.count), true);
  for (const sim::RunFrame& frame : seen)
    for (std::int64_t row = 0; row < body.count; ++row)
      if (frame.position.at(body.first + row) != seen.front().position.at(body.first + row)) held[static_cast<std::size_t>(row)] = false;
  return held;
}

// See make_frame.h.
std::vector<sim::RunHeader::ShellInfo> visible_shells(const sim::RunHeader& header, const std::vector<sim::RunFrame>& seen) {
  std::vector<sim::RunHeader::ShellInfo> shells = header.shells;
  if (!header.valve || header.dimension == 2) return shells;
  for (sim::RunHeader::ShellInfo& shell : shells) {
    const sim::RunHeader::BodyInfo& body = header.bodies.at(static_cast<std::size_t>(shell.body));
    const std::vector<bool> held = held_rows(body, seen);
    const auto anchored = [&](const auto& t) { return held.at(t[0]) && held.at(t[1]) && held.at(t[2]); };
    if (std::all_of(shell.elements.begin(), shell.elements.end(), anchored)) continue;  // nothing has moved yet
    std::erase_if(shell.elements, anchored);
  }
  return shells;
}

// Per shell and particle: the moving particles next to a held one that is drawn; empty for all others. At a held particle the stress is
// that of the clamp, which a sheet of particles does not resolve: it shows the mean of these.
std::vector<std::vector<std::vector<std::int32_t>>> moving_neighbors(const sim::RunHeader& header,
                                                                     const std::vector<sim::RunHeader::ShellInfo>& shells,
                                                                     const std::vector<sim::RunFrame>& seen) {
  std::vector<std::vector<std::vector<std::int32_t>>> all;
  for (const sim::RunHeader::ShellInfo& shell : shells) {
    const sim::RunHeader::BodyInfo& body = header.bodies.at(static_cast<std::size_t>(shell.body));
    all.emplace_back(static_cast<std::size_t>(body.count));
    if (!header.valve || header.dimension == 2) continue;
    const std::vector<bool> held = held_rows(body, seen);
    for (const auto& triangle : shell.elements)
      for (const std::int32_t a : triangle)
        for (const std::int32_t b : triangle)
          if (held.at(static_cast<std::size_t>(a)) && !held.at(static_cast<std::size_t>(b)))
            all.back()[static_cast<std::size_t>(a)].push_back(b);
  }
  return all;
}

}  // namespace

std::vector<sim::RunHeader::ShellInfo> visible_shells(const sim::RunReader& run) { return visible_shells(run.header(), frames_over(run)); }

int scale_slot(const std::string& field) {
  return field_index(field) + (is_fluid_field(field) ? 0 : static_cast<int>(fluid_fields.size()));
}

std::vector<std::int32_t> chain(const std::vector<std::array<std::int32_t, 3>>& segments) {
  std::map<std::int32_t, std::vector<std::int32_t>> neighbors;
  for (const auto& segment : segments) {
    neighbors[segment[0]].push_back(segment[1]);
    neighbors[segment[1]].push_back(segment[0]);
  }
  if (neighbors.empty()) return {};
  std::int32_t here = neighbors.begin()->first;
  for (const auto& [row, others] : neighbors)
    if (others.size() == 1) {  // an open chain starts at an end
      here = row;
      break;
    }
  std::vector<std::int32_t> rows{here};
  std::set<std::int32_t> seen{here};
  while (true) {
    const auto& next = neighbors[here];
    const auto unseen = std::find_if(next.begin(), next.end(), [&](std::int32_t row) { return !seen.contains(row); });
    if (unseen == next.end()) break;
    here = *unseen;
    seen.insert(here);
    rows.push_back(here);
  }
  const auto& last = neighbors[here];
  if (rows.size() > 2 && std::find(last.begin(), last.end(), rows.front()) != last.end()) rows.push_back(rows.front());
  return rows;
}

FrameMaker::FrameMaker(const sim::RunReader& run, PictureChoice choice, const FieldRanges& ranges, bool alone)
    : run_(run),
      choice_(std::move(choice)),
      ranges_(ranges),
      views_(chosen_views(choice_, run.header(), alone)),
      warnings_(run.warnings()) {
  if (run.frame_count() == 0) throw std::invalid_argument("the run '" + run.header().title + "' holds no finished frame yet");
  for (const auto& [field, range] : choice_.ranges) ranges_[field] = range;
  for (std::size_t i = 0; i < run.frame_count(); ++i) times_.push_back(run.frame_time(i));
  const std::vector<sim::RunFrame> seen = frames_over(run);
  start_ = seen.front().position;
  bounds_ = bounds_over(seen, run.header().spacing);
  shells_ = visible_shells(run.header(), seen);
  stand_ins_ = moving_neighbors(run.header(), shells_, seen);
  series_ = run.series();
  plots_ = make_plots(run.header(), series_);
  const sim::RunHeader& header = run.header();
  lumen_.name = root_.name = "aorta";
  for (const auto& v : header.lumen.vertices) lumen_.vertices.emplace_back(v[0], v[1], v[2]);
  lumen_.triangles = header.lumen.triangles;
  if (header.valve) root_ = root_part(lumen_, *header.valve);
  if (header.valve && !header.valve->leaflet_bodies.empty()) {
    const sim::RunHeader::BodyInfo& body = header.bodies.at(static_cast<std::size_t>(header.valve->leaflet_bodies.front()));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::int64_t row = body.first; row < body.first + body.count; ++row)
      middle += Eigen::Vector3d(start_.at(row)[0], start_.at(row)[1], start_.at(row)[2]) - header.valve->annulus_center;
    middle -= header.valve->axis * header.valve->axis.dot(middle);
    if (middle.norm() > 0) toward_leaflet_ = middle.normalized().cast<float>();
  }
}

void FrameMaker::add_particles(render::Frame& frame, const sim::RunFrame& state) const {
  frame.particles.resize(3);
  const char* names[] = {"blood", "solids", "walls"};
  for (int slot = 0; slot < 3; ++slot) {
    frame.particles[slot].name = names[slot];
    frame.particles[slot].radius = static_cast<float>((run_.header().dimension == 2 ? flat_radius : drawn_radius) * run_.header().spacing);
  }
  frame.particles[fluid_set].fields.resize(fluid_fields.size());
  frame.particles[solid_set].fields.resize(solid_fields.size());
  for (std::size_t row = 0; row < state.size(); ++row) {
    const sim::Kind kind = kind_of(state, row);
    if (kind == sim::Kind::shell || kind == sim::Kind::port) continue;  // a port's particles lie outside the open end
    const int slot = kind == sim::Kind::wall ? wall_set : kind == sim::Kind::elastic ? solid_set : fluid_set;
    render::ParticleSet& set = frame.particles[slot];
    set.positions.push_back(point(state.position[row]));
    const auto& fields = slot == fluid_set ? fluid_fields : solid_fields;
    if (slot == wall_set) continue;
    for (std::size_t k = 0; k < fields.size(); ++k) set.fields[k].push_back(field_value(fields[k], state, row, start_));
  }
}

// Leaflets and other sheets as skins; in 2-D as lines. A skin is drawn as thick as the distance at which two leaflets touch where the
// material is thinner: what is closed to the blood then looks closed.
void FrameMaker::add_shells(render::Frame& frame, const sim::RunFrame& state) const {
  const sim::RunHeader& header = run_.header();
  frame.surfaces = {lumen_, root_};
  for (std::size_t number = 0; number < shells_.size(); ++number) {
    const sim::RunHeader::ShellInfo& shell = shells_[number];
    const sim::RunHeader::BodyInfo& body = header.bodies.at(static_cast<std::size_t>(shell.body));
    const auto value = [&](std::size_t k, std::int64_t row) {
      return field_value(solid_fields[k], state, static_cast<std::size_t>(row), start_);
    };
    if (header.dimension == 2) {
      render::Line line;
      line.name = body.name;
      line.fields.resize(solid_fields.size());
      for (const std::int32_t place : chain(shell.elements)) {
        line.points.push_back(point(state.position.at(body.first + place)));
        for (std::size_t k = 0; k < solid_fields.size(); ++k) line.fields[k].push_back(value(k, body.first + place));
      }
      frame.lines.push_back(std::move(line));
      continue;
    }
    render::Surface surface;
    surface.name = body.name;
    surface.triangles = shell.elements;
    surface.thickness = static_cast<float>(std::max(body.thickness, contact_distance * header.spacing));
    surface.smoothing = surface.triangles.size() < finely_drawn ? 2 : 1;
    surface.averaging = surface.fairing = 2;
    surface.fields.resize(solid_fields.size());
    for (std::int64_t row = body.first; row < body.first + body.count; ++row) {
      surface.vertices.push_back(point(state.position.at(row)));
      for (std::size_t k = 0; k < solid_fields.size(); ++k) surface.fields[k].push_back(value(k, row));
    }
    for (std::size_t i = 0; i < stand_ins_[number].size(); ++i) {
      const std::vector<std::int32_t>& others = stand_ins_[number][i];
      if (others.empty()) continue;
      for (const std::string& field : {std::string("stress"), std::string("principal_stress")}) {
        float sum = 0;
        for (const std::int32_t other : others) sum += value(static_cast<std::size_t>(field_index(field)), body.first + other);
        surface.fields[static_cast<std::size_t>(field_index(field))][i] = sum / static_cast<float>(others.size());
      }
    }
    frame.surfaces.push_back(std::move(surface));
  }
}

void FrameMaker::add_words(render::Frame& frame, const sim::RunFrame& state, std::size_t index) const {
  const sim::RunHeader& header = run_.header();
  frame.title = choice_.label.empty() ? header.title : choice_.label;
  frame.subtitle = settings_text(header);
  frame.time = state.time;
  if (header.statics) frame.time_text = "load " + std::to_string(std::lround(100 * state.time / std::max(header.end, 1e-300))) + " %";
  if (!header.valve) frame.caption.clear();
  frame.readouts = make_readouts(header, series_, times_.at(index));
  frame.plots = plots_;
  constexpr std::size_t shown = 2;
  frame.warnings.assign(warnings_.begin(), warnings_.begin() + static_cast<std::ptrdiff_t>(std::min(shown, warnings_.size())));
  if (warnings_.size() > shown) frame.warnings.back() += " (and " + std::to_string(warnings_.size() - shown) + " more: cusp info)";
}

// The largest value of each solids' field among what can be seen, as computed: pictures smooth what they colour.
void FrameMaker::add_highest(render::Frame& frame) const {
  for (std::size_t k = 0; k < solid_fields.size(); ++k) {
    std::optional<double>& highest = frame.scales[static_cast<std::size_t>(scale_slot(solid_fields[k]))].highest;
    const auto add = [&](float value) {
      if (std::isfinite(value)) highest = std::max<double>(highest.value_or(value), value);
    };
    for (std::size_t s = first_leaflet; s < frame.surfaces.size(); ++s)
      for (const auto& triangle : frame.surfaces[s].triangles)
        for (const std::int32_t vertex : triangle) add(frame.surfaces[s].fields[k][static_cast<std::size_t>(vertex)]);
    for (const float value : frame.particles[solid_set].fields[k]) add(value);
    for (const render::Line& line : frame.lines)
      for (const float value : line.fields[k]) add(value);
  }
}

render::Frame FrameMaker::make(std::size_t index) const {
  const sim::RunFrame state = run_.frame(index);
  render::Frame frame;
  for (const auto* list : {&fluid_fields, &solid_fields})
    for (const std::string& field : *list) {
      const auto found = ranges_.find(field);
      frame.scales.push_back(
          field_scale(field, found == ranges_.end() ? Range2{0, 1} : found->second, choice_.pressure_units, choice_.map));
    }
  add_particles(frame, state);
  add_shells(frame, state);
  add_words(frame, state, index);
  add_highest(frame);
  for (const View& view : views_) frame.panels.push_back(panel(view, frame));
  return frame;
}

render::Panel FrameMaker::panel(const View& view, const render::Frame& frame) const {
  return make_panel(view, frame, run_.header(), choice_, bounds_, toward_leaflet_);
}

}  // namespace app
