#include "app/run_names.h"

#include <algorithm>
#include <set>

namespace app {
namespace {

constexpr const char* part_mark = "  ·  ";
constexpr const char* item_mark = ", ";

std::vector<std::string> split(const std::string& text, const std::string& mark) {
  std::vector<std::string> pieces;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(mark, start), text.size());
    if (end > start) pieces.push_back(text.substr(start, end - start));
    start = end + mark.size();
  }
  return pieces;
}

std::vector<std::string> items_of(const std::string& settings) {
  std::vector<std::string> items;
  for (const std::string& part : split(settings, part_mark))
    for (std::string& item : split(part, item_mark)) items.push_back(std::move(item));
  return items;
}

bool all_different(const std::vector<std::string>& texts) {
  return std::set<std::string>(texts.begin(), texts.end()).size() == texts.size() && std::ranges::find(texts, "") == texts.end();
}

// "a.b.key=value" to "key=value"; words are spelt with spaces.
std::string without_path(const std::string& setting) {
  const std::size_t value = std::min(setting.find('='), setting.size()), dot = setting.rfind('.', value);
  std::string text = setting.substr(dot == std::string::npos ? 0 : dot + 1);
  std::replace(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find('='), text.size())), '_', ' ');
  return text;
}

// The items of `items` that every other list has too (or, with `shared` false, those that some other lacks).
std::string kept(const std::vector<std::string>& items, const std::vector<std::vector<std::string>>& all, bool shared) {
  std::string text;
  for (const std::string& item : items) {
    const bool everywhere = std::ranges::all_of(all, [&](const auto& list) { return std::ranges::find(list, item) != list.end(); });
    if (everywhere == shared) text += (text.empty() ? "" : item_mark) + item;
  }
  return text;
}

}  // namespace

RunNames run_names(const std::vector<std::string>& titles, const std::vector<std::string>& settings,
                   const std::vector<std::vector<std::string>>& keys) {
  std::vector<std::vector<std::string>> items;
  for (const std::string& text : settings) items.push_back(items_of(text));
  RunNames result;
  if (!items.empty()) result.shared = kept(items.front(), items, true);
  result.names = titles;
  if (all_different(result.names)) return result;
  for (std::size_t run = 0; run < items.size(); ++run) result.names[run] = kept(items[run], items, false);
  if (all_different(result.names)) return result;
  std::vector<std::vector<std::string>> set;
  for (const auto& list : keys) {
    set.emplace_back();
    for (const std::string& key : list) set.back().push_back(without_path(key));
  }
  for (std::size_t run = 0; run < set.size(); ++run) result.names[run] = kept(set[run], set, false);
  if (all_different(result.names)) return result;
  for (std::size_t run = 0; run < result.names.size(); ++run)
    result.names[run] = std::to_string(run + 1) + (result.names[run].empty() ? "" : ": " + result.names[run]);
  return result;
}

}  // namespace app
