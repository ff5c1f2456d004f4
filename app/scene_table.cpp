#include "app/scene_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace app {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row.back();
}

std::string joined(const std::vector<std::string>& words) {
  std::string result;
  for (const std::string& word : words) result += (result.empty() ? "" : ", ") + word;
  return result;
}

std::string shown(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

std::string dotted(const std::string& path, std::string_view key) {
  if (key.empty()) return path;
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

Spot spot_of(const toml::source_region& source, std::string key) {
  const bool typed = source.path && source.path->starts_with("--set");  // one line, which needs no number
  return {source.path ? *source.path : std::string(), typed ? 0 : static_cast<int>(source.begin.line), std::move(key)};
}

void check(const Spot& spot, double value, const Range& range) {
  const bool inside =
      (range.min_open ? value > range.min : value >= range.min) && (range.max_open ? value < range.max : value <= range.max);
  if (!std::isfinite(value)) refuse(spot, "is not a finite number", std::string("give ") + range.words);
  if (!inside) refuse(spot, shown(value) + " is impossible", std::string("give ") + range.words);
}

}  // namespace

void refuse(const Spot& spot, const std::string& problem, const std::string& mend) {
  std::string line = spot.file;
  if (spot.line > 0) line += ":" + std::to_string(spot.line);
  if (!line.empty()) line += ": ";
  if (!spot.key.empty()) line += spot.key + ": ";
  line += problem;
  if (!mend.empty()) line += "; " + mend;
  for (char& c : line)  // a name may hold what would end the line, or write over it
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  throw SceneError(line);
}

bool usable_name(std::string_view name) {
  return !name.empty() && name.find_first_of(",. /\\\"") == std::string_view::npos &&
         std::none_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) best_distance = distance, best = candidate;
  }
  return best;
}

TableReader::TableReader(const toml::table& table, std::string path, std::vector<std::string> known)
    : table_(table), path_(std::move(path)) {
  for (const auto& [key, value] : table_) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    const std::string near = nearest_word(key.str(), known);
    const toml::source_region& source = key.source().begin.line > 0 ? key.source() : value.source();
    refuse(spot_of(source, dotted(path_, key.str())), "unknown key",
           near.empty() ? "known here: " + joined(known) : "did you mean `" + near + "`?");
  }
}

Spot TableReader::spot(std::string_view key) const {
  if (const toml::node* found = key.empty() ? nullptr : table_.get(key); found && found->source().begin.line > 0)
    return spot_of(found->source(), dotted(path_, key));
  return spot_of(table_.source(), dotted(path_, key));
}

const toml::node& TableReader::node(std::string_view key) const {
  const toml::node* found = table_.get(key);
  if (!found) refuse(spot(key), "is missing", path_.empty() ? "add it at the top of the file" : "add it to `" + path_ + "`");
  return *found;
}

void TableReader::wrong_type(std::string_view key, const char* wanted) const {
  std::ostringstream is;
  is << node(key).type();
  refuse(spot(key), "is a " + is.str() + " where " + wanted + " is needed", std::string("give ") + wanted);
}

double TableReader::number(std::string_view key, Range range) const {
  const toml::node& found = node(key);
  if (!found.is_number()) wrong_type(key, range.words);
  const double value = *found.value<double>();
  check(spot(key), value, range);
  return value;
}

double TableReader::number(std::string_view key, Range range, double fallback) const { return has(key) ? number(key, range) : fallback; }

std::int64_t TableReader::integer(std::string_view key, Range range, std::int64_t fallback) const {
  if (!has(key)) return fallback;
  const double value = number(key, range);
  if (value != std::floor(value) || std::abs(value) > 9e15) refuse(spot(key), shown(value) + " is no whole number", "give a whole number");
  return static_cast<std::int64_t>(value);
}

bool TableReader::flag(std::string_view key, bool fallback) const {
  if (!has(key)) return fallback;
  if (!node(key).is_boolean()) wrong_type(key, "true or false");
  return *node(key).value<bool>();
}

std::string TableReader::text(std::string_view key) const {
  if (!node(key).is_string()) wrong_type(key, "a text in quotes");
  return *node(key).value<std::string>();
}

std::string TableReader::text(std::string_view key, const std::string& fallback) const { return has(key) ? text(key) : fallback; }

std::string TableReader::choice(std::string_view key, const std::vector<std::string>& choices) const {
  const std::string value = text(key);
  if (std::find(choices.begin(), choices.end(), value) != choices.end()) return value;
  const std::string near = nearest_word(value, choices);
  refuse(spot(key), "\"" + value + "\" is not known",
         (near.empty() ? "" : "did you mean \"" + near + "\"? ") + std::string("possible: ") + joined(choices));
}

std::string TableReader::choice(std::string_view key, const std::vector<std::string>& choices, const std::string& fallback) const {
  return has(key) ? choice(key, choices) : fallback;
}

Eigen::Vector3d TableReader::vector(std::string_view key, int count) const {
  const std::vector<double> values = numbers(key);
  if (static_cast<int>(values.size()) != count)
    refuse(spot(key), "has " + std::to_string(values.size()) + " numbers",
           "give " + std::to_string(count) + ", one an axis (`dimension` says how many)");
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < count; ++axis) result[axis] = values[axis];
  return result;
}

std::vector<std::string> TableReader::texts(std::string_view key) const {
  std::vector<std::string> result;
  for (const toml::node& entry : array(key)) {
    if (!entry.is_string()) wrong_type(key, "a list of texts");
    result.push_back(*entry.value<std::string>());
  }
  return result;
}

std::vector<double> TableReader::numbers(std::string_view key) const {
  std::vector<double> result;
  for (const toml::node& entry : array(key)) {
    if (!entry.is_number()) refuse(spot(key), "holds something that is no number", "give numbers, as in [0, 0.5]");
    result.push_back(*entry.value<double>());
    check(spot(key), result.back(), any_number);
  }
  return result;
}

const toml::table& TableReader::table(std::string_view key) const {
  if (!node(key).is_table()) wrong_type(key, "a table { ... }");
  return *node(key).as_table();
}

std::vector<const toml::table*> TableReader::tables(std::string_view key) const {
  std::vector<const toml::table*> result;
  if (!has(key)) return result;
  for (const toml::node& entry : array(key)) {
    if (!entry.is_table()) wrong_type(key, "a list of tables");
    result.push_back(entry.as_table());
  }
  return result;
}

const toml::array& TableReader::array(std::string_view key) const {
  if (!node(key).is_array()) wrong_type(key, "a list [ ... ]");
  return *node(key).as_array();
}

std::string entry_path(const std::string& path, const toml::table& entry, std::size_t index) {
  if (const auto name = entry["name"].value<std::string>(); name && !name->empty()) return path + "." + *name;
  return path + "." + std::to_string(index);
}

}  // namespace app
