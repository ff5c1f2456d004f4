#include "app/case_grid.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/progress.h"
#include "app/scene_error.h"
#include "sim/run_file.h"

namespace app {
namespace {

double now_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

bool finished_before(const GridCase& one) {
  try {
    return std::filesystem::exists(one.run()) && sim::RunReader(one.run()).status() == "finished";
  } catch (const std::exception&) {
    return false;  // broken: run again
  }
}

// Starts a child whose output goes to log.txt in the case's folder. It is asked to stop, as by Ctrl-C, should this process die before it:
// else it would go on alone, and the sweep that is started again would find its run file taken.
pid_t start(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  const std::string log = (folder / "log.txt").string();
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child != 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);  // it died meanwhile
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || dup2(file, STDOUT_FILENO) < 0 || dup2(file, STDERR_FILENO) < 0) _exit(1);
  execv(arguments.front(), arguments.data());
  _exit(127);
}

// Adds what a child used to what its case had used before. The peak counts at least what this program held when it started the child.
void add_case_cost(const GridCase& one, double elapsed, const rusage& used) {
  CaseCost cost = read_case_cost(one);
  const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
  cost.elapsed += elapsed, cost.processor += seconds(used.ru_utime) + seconds(used.ru_stime);
  cost.peak_memory = std::max(cost.peak_memory, 1024.0 * static_cast<double>(used.ru_maxrss));
  std::ofstream(one.folder / "cost.json")
      << nlohmann::json{{"elapsed", cost.elapsed}, {"processor", cost.processor}, {"peak_memory", cost.peak_memory}}.dump() << "\n";
}

}  // namespace

CaseCost read_case_cost(const GridCase& one) {
  std::ifstream file(one.folder / "cost.json");
  const nlohmann::json json = file ? nlohmann::json::parse(file, nullptr, false) : nlohmann::json();
  if (!json.is_object()) return {};
  return {json.value("elapsed", 0.0), json.value("processor", 0.0), json.value("peak_memory", 0.0)};
}

Variation parse_variation(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw SceneError("--vary " + text + ": is no KEY=V1,V2,...; as in --vary spacing=0.02,0.01");
  Variation variation{text.substr(0, equals), {""}};
  int depth = 0;
  bool quoted = false;
  for (char c : text.substr(equals + 1)) {
    if (c == '"') quoted = !quoted;
    if (!quoted) depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c == ',' && depth == 0 && !quoted)
      variation.values.emplace_back();
    else
      variation.values.back() += c;
  }
  for (const std::string& value : variation.values)
    if (value.empty()) throw SceneError("--vary " + text + ": has an empty value; write values with commas between them");
  return variation;
}

std::vector<GridCase> grid_cases(const std::vector<Variation>& variations, const std::filesystem::path& folder) {
  std::vector<GridCase> cases{{folder, {}}};
  for (const Variation& variation : variations) {
    std::vector<GridCase> next;
    for (const GridCase& one : cases)
      for (const std::string& value : variation.values) {
        next.push_back(one);
        next.back().settings.push_back(variation.key + "=" + value);
      }
    cases = std::move(next);
  }
  for (GridCase& one : cases) {
    std::string name;
    for (const std::string& setting : one.settings) name += (name.empty() ? "" : "__") + setting;
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_' && c != '=') c = '_';
    one.folder = folder / (name.empty() ? "case" : name);
  }
  return cases;
}

int threads_of_case(const GridOptions& options) {
  if (options.threads > 0) return options.threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()) / std::max(1, options.jobs));
}

std::vector<std::string> case_command(const GridCase& one, const GridOptions& options, const std::string& program) {
  std::vector<std::string> words{program, "run", options.scene.string(), "-o", one.run().string(), "--continue", "--quiet"};
  words.insert(words.end(), {"--threads", std::to_string(one.threads > 0 ? one.threads : threads_of_case(options))});
  for (const auto* settings : {&options.settings, &one.settings})
    for (const std::string& setting : *settings) words.insert(words.end(), {"--set", setting});
  return words;
}

std::vector<int> run_grid(const std::vector<GridCase>& cases, const GridOptions& options) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::atomic<bool>& stop = stop_on_signal();
  const double started = now_seconds();
  std::vector<int> codes(cases.size(), -1);
  std::map<pid_t, std::pair<std::size_t, double>> running;  // case, when it was started
  std::size_t next = 0, done = 0;
  bool told = false;
  const auto over = [&] { return stop.load() || (options.budget_seconds > 0 && now_seconds() - started > options.budget_seconds); };
  while (!running.empty() || (next < cases.size() && !over())) {
    while (next < cases.size() && static_cast<int>(running.size()) < std::max(1, options.jobs) && !over()) {
      const std::size_t index = next++;
      if (finished_before(cases[index])) {
        codes[index] = 0, ++done;
        continue;
      }
      std::filesystem::create_directories(cases[index].folder);
      const pid_t child = start(case_command(cases[index], options, program), cases[index].folder);
      if (child < 0) throw std::runtime_error("can't start " + program);
      running[child] = {index, now_seconds()};
    }
    if (running.empty()) continue;
    if (stop.load() && !told) {  // a signal to this process alone: the children keep what they have and end too
      for (const auto& [child, begun] : running) kill(child, SIGTERM);
      told = true;
    }
    int status = 0;
    rusage used{};
    const pid_t ended = wait4(-1, &status, WNOHANG, &used);
    const auto found = running.find(ended);
    if (found == running.end()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    const auto [index, since] = found->second;
    codes[index] = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
    add_case_cost(cases[index], now_seconds() - since, used);
    ++done;
    if (!options.quiet)
      std::fprintf(stderr, "%zu of %zu: %s %s, %s so far\n", done, cases.size(), cases[index].folder.filename().string().c_str(),
                   codes[index] == 0 ? "finished"
                   : told            ? "stopped"
                                     : "failed",
                   duration_text(now_seconds() - started).c_str());
    running.erase(found);
  }
  return codes;
}

}  // namespace app
