// Strict reading of TOML tables: every mistake is refused in one line that names the file, the line, the key and the mend.
#pragma once

#include <toml++/toml.h>
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene_error.h"

namespace app {

// Which numbers a key takes, and how to say so.
struct Range {
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
  bool min_open = false, max_open = false;
  const char* words = "a number";
};
inline constexpr double infinite = std::numeric_limits<double>::infinity();
inline constexpr Range any_number{};
inline constexpr Range positive{0, infinite, true, false, "a number above 0"};
inline constexpr Range not_negative{0, infinite, false, false, "a number not below 0"};

class TableReader {
 public:
  // Refuses at once any key of `table` that is not among `known`. `path` is the dotted path of the table ("" at the top).
  TableReader(const toml::table& table, std::string path, std::vector<std::string> known);

  bool has(std::string_view key) const { return table_.contains(key); }
  Spot spot(std::string_view key = "") const;
  const std::string& path() const { return path_; }
  const toml::node& node(std::string_view key) const;  // refused where missing

  double number(std::string_view key, Range range = any_number) const;
  double number(std::string_view key, Range range, double fallback) const;
  std::int64_t integer(std::string_view key, Range range, std::int64_t fallback) const;
  bool flag(std::string_view key, bool fallback) const;
  std::string text(std::string_view key) const;
  std::string text(std::string_view key, const std::string& fallback) const;
  // One of `choices`.
  std::string choice(std::string_view key, const std::vector<std::string>& choices) const;
  std::string choice(std::string_view key, const std::vector<std::string>& choices, const std::string& fallback) const;
  // `count` finite numbers, the rest of the three filled with 0.
  Eigen::Vector3d vector(std::string_view key, int count) const;
  std::vector<std::string> texts(std::string_view key) const;
  std::vector<double> numbers(std::string_view key) const;
  const toml::table& table(std::string_view key) const;
  std::vector<const toml::table*> tables(std::string_view key) const;  // an array of tables; empty where missing
  const toml::array& array(std::string_view key) const;

 private:
  [[noreturn]] void wrong_type(std::string_view key, const char* wanted) const;
  const toml::table& table_;
  std::string path_;
};

// Dotted path of entry `index` of the list at `path`: by its name where it has one.
std::string entry_path(const std::string& path, const toml::table& entry, std::size_t index);

}  // namespace app
