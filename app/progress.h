// Progress of a run on stderr: a bar on a terminal, a plain line now and then otherwise.
#pragma once

#include <atomic>
#include <string>

#include "sim/run.h"

namespace app {

class ProgressPrinter {
 public:
  explicit ProgressPrinter(bool quiet);
  void operator()(const sim::RunProgress& progress);
  void finish();  // ends the bar's line

 private:
  bool quiet_, terminal_, line_open_ = false;
  double last_ = -1e9;
};

// Set by Ctrl-C and SIGTERM once installed; a second signal ends the program at once.
const std::atomic<bool>& stop_on_signal();

std::string duration_text(double seconds);

}  // namespace app
