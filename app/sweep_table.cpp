#include "app/sweep_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "app/clinical.h"
#include "app/html_page.h"
#include "app/scene_error.h"
#include "sim/run_file.h"

namespace app {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::vector<std::string> fields_of(std::string line) {
  std::vector<std::string> fields{""};
  int depth = 0;
  bool quoted = false;
  for (const char c : line) {
    if (c == '\r') continue;
    if (c == '"') quoted = !quoted;
    if (!quoted) depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c == ',' && depth == 0 && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  for (std::string& field : fields) {
    field.erase(0, field.find_first_not_of(" \t"));
    field.erase(field.find_last_not_of(" \t") + 1);
  }
  return fields;
}

// A setting's value as a number where it is one.
json value_of(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? json(number) : json(text);
}

void add_result(json& row, json& figures, const fs::path& file) {
  const sim::RunReader run(file);
  row["status"] = run.status(), row["wall_seconds"] = run.wall_seconds();
  for (const std::string& name : run.header().columns) {
    const std::vector<double> values = run.column(name);
    if (values.empty() || name == "time") continue;
    row["last"][name] = values.back();
    row["largest"][name] = *std::max_element(values.begin(), values.end());
  }
  const std::optional<ClinicalFigures> clinical = clinical_figures(run, file);
  if (!clinical) return;
  for (std::size_t k = 0; k < clinical->summary.figures.size(); ++k) {
    const sim::Figure& figure = clinical->summary.figures[k];
    if (!std::isfinite(figure.value)) continue;
    row["figures"][figure.key] = figure.value;
    if (std::isfinite(figure.uncertainty)) row["uncertainty"][figure.key] = figure.uncertainty;
    const bool known = std::any_of(figures.begin(), figures.end(), [&](const json& one) { return one["key"] == figure.key; });
    if (!known)
      figures.push_back(
          {{"key", figure.key}, {"label", figure.label}, {"unit", clinical->corridors[k].unit}, {"factor", clinical->corridors[k].factor}});
  }
}

std::string csv_cell(const json& value) {
  if (value.is_number()) return value.dump();
  std::string text = value.is_string() ? value.get<std::string>() : "";
  std::replace(text.begin(), text.end(), '"', '\'');
  return "\"" + text + "\"";
}

void write_csv(const json& table, const fs::path& file) {
  std::ofstream out(file);
  std::vector<std::pair<std::string, std::string>> columns;  // group, name
  for (const char* group : {"figures", "last", "largest"})
    for (const json& row : table["cases"])
      if (row.contains(group))
        for (const auto& [name, value] : row[group].items())
          if (std::find(columns.begin(), columns.end(), std::pair{std::string(group), name}) == columns.end())
            columns.emplace_back(group, name);
  out << "case";
  for (const json& key : table["keys"]) out << "," << key.get<std::string>();
  out << ",status,wall_seconds";
  for (const auto& [group, name] : columns) out << "," << (group == "figures" ? "" : group == "last" ? "last " : "max ") << name;
  out << "\n";
  for (const json& row : table["cases"]) {
    out << csv_cell(row["case"]);
    for (const json& key : table["keys"]) out << "," << csv_cell(row["settings"].value(key.get<std::string>(), json("")));
    out << "," << csv_cell(row["status"]) << "," << row.value("wall_seconds", 0.0);
    for (const auto& [group, name] : columns) {
      out << ",";
      if (row.contains(group) && row[group].contains(name)) out << row[group][name].dump();
    }
    out << "\n";
  }
  if (!out.flush()) throw std::runtime_error(file.string() + ": can't be written");
}

}  // namespace

std::vector<GridCase> listed_cases(const fs::path& file, const fs::path& folder, std::vector<Variation>& variations) {
  std::ifstream in(file);
  if (!in) throw SceneError(file.string() + ": can't be read; give a CSV with a heading of keys, one case a row");
  std::vector<GridCase> cases;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    const std::vector<std::string> field = fields_of(line);
    if (variations.empty()) {
      for (const std::string& key : field) variations.push_back({key, {}});
      continue;
    }
    if (field.size() != variations.size())
      throw SceneError(file.string() + ": the row \"" + line + "\" has " + std::to_string(field.size()) + " values; give " +
                       std::to_string(variations.size()) + ", one a key");
    std::vector<Variation> one;
    for (std::size_t k = 0; k < field.size(); ++k) {
      one.push_back({variations[k].key, {field[k]}});
      auto& values = variations[k].values;
      if (std::find(values.begin(), values.end(), field[k]) == values.end()) values.push_back(field[k]);
    }
    cases.push_back(grid_cases(one, folder).front());
  }
  if (cases.empty()) throw SceneError(file.string() + ": holds no case; write a heading of keys, then one case a row");
  return cases;
}

json sweep_table(const std::string& title, const std::vector<Variation>& variations, const std::vector<GridCase>& cases,
                 const std::vector<int>& codes) {
  json table{{"title", title}, {"keys", json::array()}, {"figures", json::array()}, {"cases", json::array()}, {"notice", standing_notice}};
  for (const Variation& variation : variations) table["keys"].push_back(variation.key);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    json row{{"case", cases[k].folder.filename().string()}, {"settings", json::object()}, {"exit_code", codes[k]}};
    for (const std::string& setting : cases[k].settings) {
      const std::size_t equals = setting.find('=');
      row["settings"][setting.substr(0, equals)] = value_of(setting.substr(equals + 1));
    }
    row["status"] = codes[k] < 0 ? "not started" : "refused";
    if (codes[k] >= 0 && fs::exists(cases[k].run())) {
      try {
        add_result(row, table["figures"], cases[k].run());
      } catch (const std::exception& error) {
        row["status"] = error.what();
      }
    }
    table["cases"].push_back(row);
  }
  return table;
}

void write_sweep(const json& table, const fs::path& folder) {
  write_csv(table, folder / "sweep.csv");
  std::ofstream(folder / "sweep.json") << table.dump(2) << "\n";
  if (!(std::ofstream(folder / "sweep.html") << html_page("Sweep", {"curves.js", "sweep.js"}, table)))
    throw std::runtime_error((folder / "sweep.html").string() + ": can't be written");
}

}  // namespace app
