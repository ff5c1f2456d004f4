// Bytes as text, for files within files.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace app {

std::string base64(std::span<const unsigned char> bytes);
// "data:TYPE;base64,..." of a file. Throws std::runtime_error where it can't be read.
std::string data_address(const std::filesystem::path& file, const std::string& type);

}  // namespace app
