// A user's mistake, said in one line that names the file, the line, the key and the mend.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace app {

// A user's mistake in a scene or on the command line: what() is one line, the program exits with 2.
struct SceneError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Where something was written, for messages.
struct Spot {
  std::string file;
  int line = 0;  // 1-based; 0 = not in a file
  std::string key;
};
[[noreturn]] void refuse(const Spot& spot, const std::string& problem, const std::string& mend = "");

// Whether a name can stand in a column's heading, a dotted path and a file's name: not empty, no comma, dot, space, slash, quote or control
// character. So no scene can write outside its run's folder.
bool usable_name(std::string_view name);

// The candidate nearest to `word` by edit distance, or "" where none is near enough to be meant.
std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace app
