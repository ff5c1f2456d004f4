// One self-contained HTML page from assets/report: style, scripts and data within, and nothing fetched.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace app {

// The whole of a file. Throws std::runtime_error naming a file that can't be read.
std::string text_of(const std::filesystem::path& file);

// scripts: names in assets/report, in the order they run. The page finds `data` as JSON.
std::string html_page(const std::string& title, const std::vector<std::string>& scripts, const nlohmann::json& data);

}  // namespace app
