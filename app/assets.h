// Files that come with the program: scenes, waveforms, fonts.
#pragma once

#include <filesystem>
#include <string>

namespace app {

// Path of an asset such as "waveforms/ventricle_pressure.csv": in $CUSP_ASSETS, beside the installed program, or in the source tree. Throws
// std::runtime_error where it is nowhere.
std::filesystem::path asset(const std::string& name);

}  // namespace app
