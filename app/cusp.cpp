#include <malloc.h>

#include "app/commands.h"

int main(int argc, char** argv) {
  // A step's work arrays come and go. Memory that is given back to the system would have to be mapped and cleared anew at every step.
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
  return app::run_program(argc, argv);
}
