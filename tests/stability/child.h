// The program itself as a child process, under limits, and killed when asked: what tests of faults need.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace stability {

namespace fs = std::filesystem;

struct ChildOptions {
  rlim_t largest_file = RLIM_INFINITY, address_space = RLIM_INFINITY;  // bytes
  uid_t user = 0;              // other than 0: run as this user (where the test itself runs as root)
  double kill_after = 0;       // s; 0 = never
  fs::path kill_once_there{};  // or as soon as this file exists
  int kill_with = SIGKILL;     // then
};

struct ChildResult {
  int exit_code = -1, signal = 0;  // exit_code -1: ended by `signal`
  std::string errors;              // what it wrote on stderr
};

inline std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline fs::path fresh_folder(const std::string& name) {
  const fs::path folder = fs::temp_directory_path() / ("cusp_" + name + "_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

// Starts `cusp WORDS...`; its stderr goes to `log`.
inline pid_t start_cusp(const std::vector<std::string>& words, const fs::path& log, const ChildOptions& options = {}) {
  const std::string program = std::string(CUSP_BINARY_DIR) + "/cusp";
  std::vector<char*> arguments{const_cast<char*>("cusp")};
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int errors = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  const pid_t child = fork();
  if (child == 0) {  // only calls that are safe between fork and exec
    dup2(errors, STDERR_FILENO);
    dup2(nothing, STDOUT_FILENO);
    const rlimit file{options.largest_file, options.largest_file}, space{options.address_space, options.address_space}, core{0, 0};
    setrlimit(RLIMIT_CORE, &core);
    if (options.largest_file != RLIM_INFINITY) setrlimit(RLIMIT_FSIZE, &file);
    if (options.address_space != RLIM_INFINITY) setrlimit(RLIMIT_AS, &space);
    if (options.user != 0 && setuid(options.user) != 0) _exit(126);
    execv(program.c_str(), arguments.data());
    _exit(127);
  }
  close(errors);
  close(nothing);
  return child;
}

inline ChildResult wait_for(pid_t child, const fs::path& log) {
  int status = 0;
  waitpid(child, &status, 0);
  ChildResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  result.errors = text_of(log);
  return result;
}

inline ChildResult run_cusp(const std::vector<std::string>& words, const fs::path& log, const ChildOptions& options = {}) {
  const pid_t child = start_cusp(words, log, options);
  if (options.kill_after > 0 || !options.kill_once_there.empty()) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options.kill_after);
    siginfo_t about{};
    while (options.kill_after > 0 ? std::chrono::steady_clock::now() < end : !fs::exists(options.kill_once_there)) {
      about.si_pid = 0;
      if (waitid(P_PID, static_cast<id_t>(child), &about, WEXITED | WNOHANG | WNOWAIT) == 0 && about.si_pid != 0) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(child, options.kill_with);  // ended already: a zombie that takes no harm
  }
  return wait_for(child, log);
}

// Lines of a message: one clear line is asked for.
inline std::size_t lines_of(const std::string& text) {
  std::size_t lines = 0;
  for (char c : text) lines += c == '\n';
  return lines;
}

}  // namespace stability
