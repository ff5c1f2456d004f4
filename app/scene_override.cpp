// --set: one value of a scene replaced from the command line.
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "app/scene_parts.h"

namespace app {
namespace {

Spot spot_of(const Override& setting) { return {"--set " + setting.text, 0, ""}; }

bool is_number(const std::string& word) {
  return !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c); });
}

// The entry of a list that `word` means: by number, or by the `name` of a table in it.
toml::node& entry_of(toml::array& list, const std::string& word, const Override& setting) {
  if (is_number(word)) {
    const std::size_t index = std::strtoul(word.c_str(), nullptr, 10);
    if (index < list.size()) return *list.get(index);
    refuse(spot_of(setting), "the list has " + std::to_string(list.size()) + " entries", "count from 0");
  }
  std::vector<std::string> names;
  for (toml::node& entry : list) {
    const toml::table* table = entry.as_table();
    if (!table) continue;
    names.push_back((*table)["name"].value_or(std::string()));
    if (names.back() == word) return entry;
  }
  const std::string near = nearest_word(word, names);
  refuse(spot_of(setting), "no \"" + word + "\" in the list",
         near.empty() ? "use its number, counted from 0, or its name" : "did you mean \"" + near + "\"?");
}

// The value as TOML; what is no TOML is taken as text, so that scheme.name=paper needs no quotes.
toml::table parsed_value(const Override& setting) {
  const std::string file = "--set " + setting.text;
  char* end = nullptr;
  const double number = std::strtod(setting.value.c_str(), &end);
  const bool numeric = !setting.value.empty() && *end == '\0';
  try {
    return toml::parse("value = " + setting.value, file);
  } catch (const toml::parse_error&) {
    toml::table table;
    if (numeric) {
      table.insert("value", number);
    } else {
      table.insert("value", setting.value);
    }
    return table;
  }
}

}  // namespace

Override parse_override(const std::string& text) {
  const std::size_t equals = text.find('=');
  Override setting{{}, text, equals == std::string::npos ? "" : text.substr(equals + 1)};
  if (equals == std::string::npos || equals == 0 || setting.value.empty())
    refuse({"--set " + text, 0, ""}, "is no KEY=VALUE", "as in --set body.plate.material.youngs_modulus=2e6");
  std::stringstream words(text.substr(0, equals));
  for (std::string word; std::getline(words, word, '.');) {
    const auto blank = [](unsigned char c) { return std::isspace(c); };
    word.erase(std::remove_if(word.begin(), word.end(), blank), word.end());
    if (word.empty()) refuse(spot_of(setting), "has an empty part in its key", "as in body.plate.material.youngs_modulus");
    setting.path.push_back(word);
  }
  return setting;
}

void apply_override(toml::table& scene, const Override& setting) {
  toml::table value = parsed_value(setting);
  toml::node* place = &scene;
  for (std::size_t i = 0; i + 1 < setting.path.size(); ++i) {
    const std::string& word = setting.path[i];
    if (toml::array* list = place->as_array()) {
      place = &entry_of(*list, word, setting);
    } else if (toml::table* table = place->as_table()) {
      if (!table->contains(word)) table->insert(word, toml::table{});
      place = table->get(word);
    } else {
      refuse(spot_of(setting), "\"" + word + "\" stands below something that is no table", "`cusp explain` lists the keys");
    }
  }
  const std::string& last = setting.path.back();
  if (toml::array* list = place->as_array()) {
    toml::node& entry = entry_of(*list, last, setting);
    for (auto it = list->begin(); it != list->end(); ++it)
      if (&*it == &entry) {
        it = list->erase(it);
        list->insert(it, std::move(*value.get("value")));
        return;
      }
  } else if (toml::table* table = place->as_table()) {
    table->insert_or_assign(last, std::move(*value.get("value")));
  } else {
    refuse(spot_of(setting), "\"" + last + "\" stands below something that is no table", "`cusp explain` lists the keys");
  }
}

}  // namespace app
