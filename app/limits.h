// The machine's limits, met with one clear line instead of a crash.
#pragma once

#include <cstdint>

namespace app {

// For the whole program: a full disk (RLIMIT_FSIZE too) fails a write instead of ending the program; memory that runs out where no
// exception can be passed on (a parallel loop) ends it with one line and exit code 1.
void install_fault_handlers();

// While it lives, data beyond `bytes` is refused by the system, so that limits.memory holds; 0 = no limit. A limit below what is in use
// already, or above the system's own, changes nothing.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::int64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  unsigned long long before_ = 0;
  bool set_ = false;
};

}  // namespace app
