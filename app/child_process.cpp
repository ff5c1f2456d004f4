#include "app/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>

extern char** environ;

namespace app {

std::string own_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

ChildProcess::ChildProcess(const std::string& program, const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error(std::string("no pipe to a background run: ") + std::strerror(errno));
  pipe_ = ends[0];
  fcntl(pipe_, F_SETFL, O_NONBLOCK);
  fcntl(pipe_, F_SETFD, FD_CLOEXEC);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int failed = posix_spawn(&pid_, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed == 0) return;
  close(pipe_);
  throw std::runtime_error("cannot start " + program + ": " + std::strerror(failed));
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGINT);
    int status = 0;
    waitpid(pid_, &status, 0);
  }
  if (pipe_ >= 0) close(pipe_);
}

void ChildProcess::take_line(const std::string& line) {
  if (line.empty()) return;
  last_line_ = line;
  double percent = 0;
  if (std::sscanf(line.c_str(), "%lf %%", &percent) != 1) return;
  progress_ = percent / 100;
  const auto far = line.find("so far, "), left = line.find(" left");
  if (far != std::string::npos && left != std::string::npos && left > far) time_left_ = line.substr(far + 8, left - far - 8);
}

void ChildProcess::read_lines() {
  char buffer[4096];
  for (ssize_t count = 0; (count = read(pipe_, buffer, sizeof buffer)) > 0;) unfinished_.append(buffer, static_cast<std::size_t>(count));
  for (std::size_t end = 0; (end = unfinished_.find('\n')) != std::string::npos; unfinished_.erase(0, end + 1))
    take_line(unfinished_.substr(0, end));
}

bool ChildProcess::running() {
  read_lines();
  if (pid_ <= 0) return false;
  int status = 0;
  if (waitpid(pid_, &status, WNOHANG) != pid_) return true;
  pid_ = -1;
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  read_lines();
  return false;
}

void ChildProcess::interrupt() {
  if (pid_ > 0) kill(pid_, SIGINT);
}

}  // namespace app
