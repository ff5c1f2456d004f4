#include <cstdio>
#include <fstream>
#include <sstream>

#include "app/validation.h"

namespace app {
namespace {

std::string number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string percent(double value) { return number(100 * value, 3) + " %"; }

void write_csv(const nlohmann::json& all, std::ofstream csv) {
  csv << "case,priority,status,quantity,measured,reference,uncertainty,error,limit,seconds,source\n";
  for (const auto& one : all["cases"])
    for (const auto& c : one.value("checks", nlohmann::json::array({nlohmann::json::object()}))) {
      csv << one["name"].get<std::string>() << "," << one["priority"] << "," << one["status"].get<std::string>() << ","
          << c.value("quantity", "") << ",";
      if (c.contains("measured"))
        csv << number(c["measured"], 8) << "," << number(c["reference"], 8) << "," << number(c["uncertainty"], 3) << ","
            << number(c["error"], 4) << "," << (c.contains("limit") ? number(c["limit"], 4) : "");
      else
        csv << ",,,,";
      csv << "," << number(one["seconds"], 4) << ",\"" << c.value("source", "") << "\"\n";
    }
}

void write_case_rows(const nlohmann::json& one, std::ostream& md) {
  bool first = true;
  for (const auto& c : one.value("checks", nlohmann::json::array({nlohmann::json::object()}))) {
    md << "| " << (first ? "[" + one["title"].get<std::string>() + "](validation/" + one["name"].get<std::string>() + ".svg)" : "") << " | "
       << (first ? one["status"].get<std::string>() : "") << " | " << c.value("quantity", "") << " | ";
    if (c.contains("measured")) {
      const bool passed = c.value("passed", true);
      md << number(c["measured"], 6) << " | " << number(c["reference"], 6) << " | " << c.value("source", "") << " | "
         << (passed ? "" : "**") << percent(c["error"]) << (passed ? "" : "**") << " | "
         << (c.contains("limit") ? percent(c["limit"]) : "");
    } else {
      md << " | | " << one.value("message", "") << " | |";
    }
    md << " | " << (first ? number(one["seconds"], 3) + " s" : "") << " |\n";
    first = false;
  }
  if (one.contains("message") && one.contains("checks")) md << "| | | " << one["message"].get<std::string>() << " | | | | | | |\n";
}

void write_orders(const nlohmann::json& all, std::ostream& md) {
  std::ostringstream rows;
  for (const auto& one : all["cases"]) {
    if (!one.contains("order")) continue;
    if (one["order"].contains("message"))
      rows << "| " << one["title"].get<std::string>() << " | " << one["order"]["message"].get<std::string>() << " | | | |\n";
    for (const auto& row : one["order"].value("rows", nlohmann::json::array())) {
      rows << "| " << one["title"].get<std::string>() << " | " << row["quantity"].get<std::string>() << " | ";
      for (double l0 : row["spacings"]) rows << number(l0, 3) << " ";
      rows << "| ";
      for (double error : row["errors"]) rows << percent(error) << " ";
      rows << "| " << (row.contains("order") ? number(row["order"], 3) : "no order") << " |\n";
    }
  }
  if (rows.str().empty()) return;
  md << "\n## Observed order of convergence\n\nSlope of log error over log spacing; \"no order\" where the errors do not fall from step to "
        "step.\n\n"
     << "| case | quantity | spacings, m | errors | order |\n|---|---|---|---|---|\n"
     << rows.str();
}

}  // namespace

void write_validation_tables(const nlohmann::json& all, const std::filesystem::path& folder) {
  std::ofstream(folder / "validation.json") << all.dump(2) << "\n";
  write_csv(all, std::ofstream(folder / "validation.csv"));
  std::ofstream md(folder / "validation.md");
  const std::string settings = all.value("settings", "fast");
  double seconds = 0;
  for (const auto& one : all["cases"]) seconds += one["seconds"].get<double>();
  md << "# Validation\n\nPrinted by `cusp validate" << (settings == "full" ? " --full" : "") << "`"
     << (all.contains("threads") ? ", " + std::to_string(all["threads"].get<int>()) + " threads" : "") << ", " << number(seconds / 60, 3)
     << " min of runs in all (without the ladders of the last table). "
     << "Errors are relative: of a profile or curve the L2 norm of the difference over that of the reference. Bold: over the limit, which "
        "is the "
     << "'good' column of the validation plan; without a limit the error is reported only. A case's title leads to its plot.\n";
  static const char* const heads[] = {"", "must be within the limits", "within them, or with the measured reason", "reported"};
  for (int priority = 1; priority <= 3; ++priority) {
    md << "\n## Priority " << priority << ": " << heads[priority]
       << "\n\n| case | status | quantity | measured | reference | source | error | limit | time "
          "|\n|---|---|---|---|---|---|---|---|---|\n";
    for (const auto& one : all["cases"])
      if (one["priority"] == priority) write_case_rows(one, md);
  }
  write_orders(all, md);
}

}  // namespace app
