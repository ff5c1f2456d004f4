// The window driven by a list of steps instead of a hand: `cusp view --script`. For screenshots that a reader can make again, and tests.
// One step a line; `#` begins a remark:
//   open FILE                 view NAME          field NAME         range run|moment   cut MM|off       map NAME
//   time SECONDS|open|closed  play | pause       slow FACTOR        orbit DEG DEG      zoom FACTOR      pick X Y (0 ... 1 of the picture)
//   set KNOB VALUE            spot RADIUS_MM TIMES (where picked)   preview KPA        replay | cancel  beside on|off
//   wait SECONDS              wait_ready (nothing runs any more)    wait_frames N      screenshot FILE.png  print  close
// KNOB is youngs_modulus, poisson_ratio, thickness or heart_rate, SI (heart_rate a minute).
#pragma once

#include <string>
#include <vector>

#include "app/view_panels.h"

namespace app {

struct ScriptStep {
  int line = 0;
  std::string verb;
  std::vector<std::string> words;  // what follows it
};

// Throws SceneError naming the line.
std::vector<ScriptStep> read_script(const std::string& text, const std::string& name);

class ScriptRunner {
 public:
  explicit ScriptRunner(std::vector<ScriptStep> steps, std::string name) : steps_(std::move(steps)), name_(std::move(name)) {}
  struct Wishes {
    std::string screenshot;  // after the next picture
    bool preview = false, close = false;
  };
  // Does what can be done now; `now` in s. Throws SceneError naming the line of a step that is refused or whose wait took too long.
  Wishes go_on(ViewSession& session, PanelState& state, double now);
  bool done() const { return next_ >= steps_.size(); }

 private:
  bool waits(const ScriptStep& step, ViewSession& session, double now);
  void carry_out(const ScriptStep& step, ViewSession& session, PanelState& state, Wishes& wishes);
  std::vector<ScriptStep> steps_;
  std::string name_;
  std::size_t next_ = 0;
  double since_ = -1;
};

}  // namespace app
