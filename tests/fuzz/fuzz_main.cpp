// libFuzzer's entry for one target; CUSP_FUZZ_TARGET is mesh, scene, wave or run (CMake, option CUSP_FUZZ; preset `fuzz`).
#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::CUSP_FUZZ_TARGET({data, size});
  return 0;
}
