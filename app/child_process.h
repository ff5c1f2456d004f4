// This program once more, in the background: a replay goes on while the window stays alive, and a run that fails takes nothing with it.
#pragma once

#include <sys/types.h>
#include <string>
#include <vector>

namespace app {

class ChildProcess {
 public:
  // Starts `program` with the arguments; what it writes to stderr is kept line by line, stdout is dropped. Throws std::runtime_error.
  ChildProcess(const std::string& program, const std::vector<std::string>& arguments);
  ~ChildProcess();  // interrupts what still runs, and waits for its clean end
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool running();                                              // reads what was written meanwhile
  void interrupt();                                            // as Ctrl-C: a run keeps what it has
  int exit_code() const { return exit_code_; }                 // once it no longer runs; 128 + signal where one ended it
  const std::string& last_line() const { return last_line_; }  // of stderr
  double progress() const { return progress_; }                // 0 ... 1 from "  12 %  t = ..."; 0 before the first
  const std::string& time_left() const { return time_left_; }  // "3 min 20 s", or empty

 private:
  void read_lines();
  void take_line(const std::string& line);
  pid_t pid_ = -1;
  int pipe_ = -1, exit_code_ = 0;
  double progress_ = 0;
  std::string unfinished_, last_line_, time_left_;
};

// The running program's own file.
std::string own_program();

}  // namespace app
