#include "app/progress.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace app {
namespace {

std::atomic<bool> stop_requested{false};

void request_stop(int signal) {
  stop_requested = true;
  std::signal(signal, SIG_DFL);
}

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

std::string duration_text(double seconds) {
  char text[32];
  const long whole = std::lround(seconds);
  if (seconds < 100)
    std::snprintf(text, sizeof text, "%.3g s", seconds);
  else if (whole < 6000)
    std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min", whole / 3600, whole / 60 % 60);
  return text;
}

ProgressPrinter::ProgressPrinter(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

void ProgressPrinter::operator()(const sim::RunProgress& progress) {
  if (quiet_) return;
  const double now = now_seconds();
  if (now - last_ < (terminal_ ? 0.2 : 10)) return;
  last_ = now;
  const double done = progress.end > 0 ? progress.time / progress.end : 1;
  char bar[21] = "                    ";
  for (int k = 0; k < 20 && k < done * 20; ++k) bar[k] = '#';
  std::fprintf(stderr, "%s%s%s%3.0f %%  t = %.5g of %.5g  step %lld of %.2g s  %lld particles  %s so far, %s left%s",
               terminal_ ? "\r\x1b[K[" : "", terminal_ ? bar : "", terminal_ ? "] " : "", 100 * done, progress.time, progress.end,
               static_cast<long long>(progress.step), progress.step_size, static_cast<long long>(progress.particles),
               duration_text(progress.wall_seconds).c_str(), duration_text(progress.seconds_left).c_str(), terminal_ ? "" : "\n");
  std::fflush(stderr);
  line_open_ = terminal_;
}

void ProgressPrinter::finish() {
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

const std::atomic<bool>& stop_on_signal() {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  return stop_requested;
}

}  // namespace app
