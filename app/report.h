// One self-contained page about one run, or about several beside each other (docs/metrics.md, "The report").
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace app {

struct ReportOptions {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path output;               // .html
  std::vector<std::filesystem::path> movies;  // one a run; empty: movie.mp4 or RUN.mp4 beside it, if there
  bool with_movie = true, with_pictures = true;
  std::vector<std::string> labels;  // one a run instead of its title
};

// Everything the page shows of one run, as data: figures, curves, settings, ledger, warnings, the model (GLB), pictures, movie.
nlohmann::json report_run(const std::filesystem::path& run, const ReportOptions& options);
// The page's text. No address in it leads out of it: pictures, movie and model are within, and its policy forbids any request.
std::string report_page(const nlohmann::json& data);
// Writes the page; returns its size in bytes. Throws SceneError for a run that is none.
std::uintmax_t write_report(const ReportOptions& options);

// The scene's text without the names of files in it (they may name a patient): quoted words with a file's ending become "(file)".
std::string without_file_names(const std::string& text);

}  // namespace app
