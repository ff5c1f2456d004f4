#include <malloc.h>
#include <unistd.h>

#include <cstdlib>

#include "app/commands.h"

namespace {

// Threads that wait for one another spin for some microseconds, then sleep: on a machine with other work a thread that spins on keeps the
// one it waits for from its core (a small channel beside three other programs: 16 s, now 0.6 s; a step at the paper's size on a quiet
// machine: 238 ms spinning, 253 ms asleep at once, 241 ms so). OpenMP reads this before main, so the program starts itself anew; where that
// fails it goes on as it is. Who has set a policy keeps it.
void wait_without_spinning(char** argv) {
  if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT")) return;
  setenv("GOMP_SPINCOUNT", "2000", 0);
  execv("/proc/self/exe", argv);
}

}  // namespace

int main(int argc, char** argv) {
  wait_without_spinning(argv);
  // A step's work arrays come and go. Memory that is given back to the system would have to be mapped and cleared anew at every step.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  return app::run_program(argc, argv);
}
