#include "app/assets.h"

#include <cstdlib>
#include <stdexcept>
#include <system_error>
#include <vector>

namespace app {

std::filesystem::path asset(const std::string& name) {
  namespace fs = std::filesystem;
  std::vector<fs::path> places;
  if (const char* chosen = std::getenv("CUSP_ASSETS")) places.emplace_back(chosen);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) places.push_back(program.parent_path().parent_path() / "share" / "cusp");
  places.emplace_back(CUSP_SOURCE_ASSETS);
  places.emplace_back(CUSP_INSTALLED_ASSETS);
  for (const fs::path& place : places)
    if (fs::exists(place / name, error)) return place / name;
  throw std::runtime_error("the program's file " + name +
                           " is missing; install again with cmake --install, or set CUSP_ASSETS to its assets folder");
}

}  // namespace app
