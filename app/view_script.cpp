#include "app/view_script.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>

#include "app/valve_moments.h"

namespace app {
namespace {

constexpr double longest_wait = 3600;  // s

// How many words follow each verb, at least.
const std::map<std::string, std::size_t>& verbs() {
  static const std::map<std::string, std::size_t> all = {
      {"open", 1},        {"view", 1},       {"field", 1},  {"range", 1},  {"cut", 1},    {"map", 1},  {"time", 1},
      {"play", 0},        {"pause", 0},      {"slow", 1},   {"orbit", 2},  {"zoom", 1},   {"pick", 2}, {"set", 2},
      {"spot", 2},        {"preview", 1},    {"replay", 0}, {"cancel", 0}, {"beside", 1}, {"wait", 1}, {"wait_ready", 0},
      {"wait_frames", 1}, {"screenshot", 1}, {"print", 0},  {"close", 0},  {"accept", 0}};
  return all;
}

double number(const ScriptStep& step, std::size_t word) {
  char* end = nullptr;
  const double value = std::strtod(step.words[word].c_str(), &end);
  if (end == step.words[word].c_str() || *end != '\0')
    throw SceneError("step '" + step.verb + "': '" + step.words[word] + "' is no number");
  return value;
}

void set_knob(Knobs& knobs, const ScriptStep& step) {
  const double value = number(step, 1);
  const std::map<std::string, double*> known = {{"youngs_modulus", &knobs.youngs_modulus},
                                                {"poisson_ratio", &knobs.poisson_ratio},
                                                {"thickness", &knobs.thickness},
                                                {"heart_rate", &knobs.heart_rate}};
  const auto found = known.find(step.words[0]);
  if (found == known.end()) throw SceneError("step 'set': there is no knob '" + step.words[0] + "'");
  *found->second = value;
}

double wanted_time(const ScriptStep& step, const ViewModel& model) {
  if (step.words[0] != "open" && step.words[0] != "closed") return number(step, 0);
  const std::optional<ValveMoments> moments = valve_moments(model.run().reader());
  if (!moments) throw SceneError("step 'time " + step.words[0] + "': this run has no valve that opens");
  return step.words[0] == "open" ? moments->open : moments->closed;
}

void print_state(ViewSession& session) {
  std::printf("%s\n", session.model.status_text().c_str());
  if (session.model.has_run())
    std::printf("t = %.4g s, view %s, field %s%s%s\n", session.model.time(), session.model.shown.view.c_str(),
                session.model.shown.field.c_str(), session.model.picked ? ", picked " : "",
                session.model.picked ? session.model.picked->what.c_str() : "");
  for (const ComparedFigure& figure : session.model.comparison())
    std::printf("%-28s %-5s %12.4g %12.4g\n", figure.name.c_str(), figure.units.c_str(), figure.values.front(), figure.values.back());
  std::printf("%s\n", session.message.c_str());
  std::fflush(stdout);
}

}  // namespace

std::vector<ScriptStep> read_script(const std::string& text, const std::string& name) {
  std::vector<ScriptStep> steps;
  std::stringstream lines(text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    std::stringstream words(line.substr(0, line.find('#')));
    ScriptStep step{count, "", {}};
    if (!(words >> step.verb)) continue;
    for (std::string word; words >> word;) step.words.push_back(word);
    const auto found = verbs().find(step.verb);
    const std::string where = name + ":" + std::to_string(count) + ": ";
    if (found == verbs().end()) throw SceneError(where + "there is no step '" + step.verb + "'; `cusp view --help` lists them");
    if (step.words.size() < found->second)
      throw SceneError(where + "'" + step.verb + "' needs " + std::to_string(found->second) + " more word" +
                       (found->second == 1 ? "" : "s"));
    steps.push_back(std::move(step));
  }
  return steps;
}

bool ScriptRunner::waits(const ScriptStep& step, ViewSession& session, double now) {
  if (step.verb == "wait") return now - since_ < number(step, 0);
  if (step.verb == "wait_ready") return session.busy();
  if (step.verb == "wait_frames") {
    const bool there = session.model.has_run() && static_cast<double>(session.model.run().frame_count()) >= number(step, 0);
    return !there && (session.busy() || (session.model.has_run() && session.model.run().growing()));
  }
  return false;
}

void ScriptRunner::carry_out(const ScriptStep& step, ViewSession& session, PanelState& state, Wishes& wishes) {
  ViewModel& model = session.model;
  const std::string& verb = step.verb;
  const std::string first = step.words.empty() ? "" : step.words[0];
  constexpr double degree = M_PI / 180;
  if (verb == "open") session.open(first);
  if (verb == "view") model.look(first);
  if (verb == "field") field_index(first), model.shown.field = first;
  if (verb == "map") model.shown.map = first;
  if (verb == "range") model.shown.range = first == "moment" ? RangeMode::this_moment : RangeMode::whole_run;
  if (verb == "cut" && (model.shown.cut = first != "off")) model.shown.cut_at = 1e-3 * number(step, 0);
  if (verb == "time") model.go_to(wanted_time(step, model));
  if (verb == "play") model.playing = true;
  if (verb == "pause") model.playing = false;
  if (verb == "slow") model.slowness = number(step, 0);
  if (verb == "orbit") model.orbit(static_cast<float>(degree * number(step, 0)), static_cast<float>(degree * number(step, 1)));
  if (verb == "zoom") model.zoom(static_cast<float>(number(step, 0)));
  if (verb == "pick") state.pick_x = static_cast<float>(number(step, 0)), state.pick_y = static_cast<float>(number(step, 1));
  if (verb == "set") set_knob(session.now, step);
  if (verb == "spot") {
    if (!model.picked) throw SceneError("step 'spot': nothing is picked");
    session.now.spots.push_back({model.picked->start, 1e-3 * number(step, 0), number(step, 1)});
  }
  if (verb == "preview") state.preview_pressure = static_cast<float>(number(step, 0)), wishes.preview = true;
  if (verb == "replay") session.replay();
  if (verb == "cancel") session.cancel();
  if (verb == "accept") session.accept_import();
  if (verb == "beside") model.shown.beside = first == "on";
  if (verb == "screenshot") wishes.screenshot = first;
  if (verb == "print") print_state(session);
  if (verb == "close") wishes.close = true;
}

ScriptRunner::Wishes ScriptRunner::go_on(ViewSession& session, PanelState& state, double now) {
  Wishes wishes;
  while (!done()) {
    const ScriptStep& step = steps_[next_];
    if (since_ < 0) since_ = now;
    try {
      if (waits(step, session, now)) {
        if (now - since_ > longest_wait) throw SceneError("step '" + step.verb + "' took too long");
        return wishes;
      }
      carry_out(step, session, state, wishes);
    } catch (const std::exception& error) {
      throw SceneError(name_ + ":" + std::to_string(step.line) + ": " + error.what());
    }
    ++next_;
    since_ = -1;
    // What the window has to do first, and what changes the picture that the next step looks at.
    if (!wishes.screenshot.empty() || wishes.preview || wishes.close || step.verb == "pick" || step.verb == "open") return wishes;
  }
  return wishes;
}

}  // namespace app
