#include "app/limits.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <exception>
#include <new>

namespace app {
namespace {

void say(const char* text) {
  if (write(STDERR_FILENO, text, std::strlen(text)) < 0) _exit(1);
}

// Reached by an exception that nothing could catch: nothing of the run file is lost, its last finished state is on disk.
[[noreturn]] void end_with_a_line() {
  try {
    if (std::exception_ptr current = std::current_exception()) std::rethrow_exception(current);
    say("cusp: ended without an exception; please report this\n");
  } catch (const std::bad_alloc&) {
    say("cusp: not enough memory; make the spacing larger, or raise limits.memory or the system's limit\n");
  } catch (const std::exception& error) {
    say("cusp: ");
    say(error.what());
    say("\n");
  } catch (...) {
    say("cusp: ended by an unknown exception; please report this\n");
  }
  _exit(1);
}

}  // namespace

void install_fault_handlers() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::set_terminate(end_with_a_line);
}

MemoryLimit::MemoryLimit(std::int64_t bytes) {
  if (bytes <= 0) return;
  rlimit limit{};
  if (getrlimit(RLIMIT_DATA, &limit) != 0) return;
  before_ = limit.rlim_cur;
  if (static_cast<rlim_t>(bytes) >= limit.rlim_cur || static_cast<rlim_t>(bytes) >= limit.rlim_max) return;
  limit.rlim_cur = static_cast<rlim_t>(bytes);
  set_ = setrlimit(RLIMIT_DATA, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  rlimit limit{};
  if (!set_ || getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = static_cast<rlim_t>(before_);
  setrlimit(RLIMIT_DATA, &limit);
}

}  // namespace app
