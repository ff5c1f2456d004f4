#include "geometry/load_mesh.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <optional>
#include <stdexcept>

#include "geometry/mesh_readers.h"

namespace geometry {
namespace {

constexpr const char* known_formats = "stl, obj, ply, glb, gltf, off, vtp, vtk";

std::string suffix_of(const std::string& path) {
  std::string suffix = std::filesystem::path(path).extension().string();
  if (!suffix.empty()) suffix.erase(0, 1);
  std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
  return suffix;
}

std::string read_bytes(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw std::runtime_error("there is no such file");
  if (!std::filesystem::is_regular_file(path, error))
    throw std::runtime_error("is not a file; name a mesh file (" + std::string(known_formats) + ")");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot be opened; check its permissions");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// --- the child's side: parse, then stream the arrays through the pipe ------------------------------------------------------------------

void write_all(int pipe, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::write(pipe, at, std::min<std::size_t>(bytes, 1 << 20));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) _exit(3);
    at += done;
    bytes -= std::size_t(done);
  }
}

void write_text(int pipe, const std::string& text) {
  const std::uint64_t size = text.size();
  write_all(pipe, &size, sizeof size);
  write_all(pipe, text.data(), text.size());
}

template <class Array>
void write_array(int pipe, const Array& array) {
  const std::uint64_t size = array.size();
  write_all(pipe, &size, sizeof size);
  write_all(pipe, array.data(), array.size() * sizeof(array[0]));
}

// `room`: bytes beyond what is mapped already (a sanitiser or a graphics driver maps terabytes it never touches).
void limit_this_process(const LoadLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::size_t mapped_pages = 0;
  if (std::FILE* statm = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(statm, "%zu", &mapped_pages) != 1) mapped_pages = 0;
    std::fclose(statm);
  }
  const rlim_t space = rlim_t(mapped_pages) * rlim_t(::sysconf(_SC_PAGESIZE)) + limits.memory;
  const rlimit memory{space, space};
  const rlim_t seconds = rlim_t(std::ceil(std::max(1.0, limits.seconds)));
  const rlimit time{seconds, seconds + 1};
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_AS, &memory);
  ::setrlimit(RLIMIT_CPU, &time);
  ::setrlimit(RLIMIT_CORE, &no_core);
  for (int number : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGXCPU}) ::signal(number, SIG_DFL);
}

LoadedMesh parse(const std::string& path, const std::string& format, const std::string& bytes, const LoadLimits& limits) {
  detail::check_claims(bytes, format, limits.triangles);
  LoadedMesh loaded = format == "vtp"   ? detail::read_vtp(bytes)
                      : format == "vtk" ? detail::read_legacy_vtk(bytes)
                                        : detail::read_with_assimp(path, format);
  loaded.format = format;
  if (format == "glb" || format == "gltf") loaded.metres_per_unit = 1;
  detail::check_loaded(loaded, bytes);
  return loaded;
}

[[noreturn]] void run_child(int pipe, const std::string& path, const std::string& format, const std::string& bytes,
                            const LoadLimits& limits) {
  limit_this_process(limits);
  if (std::FILE* quiet = std::freopen("/dev/null", "w", stderr)) (void)quiet;  // what a dying library prints is no message to a user
  std::string trouble;
  LoadedMesh loaded;
  try {
    loaded = parse(path, format, bytes, limits);
  } catch (const std::bad_alloc&) {
    trouble = "reading it needs more than " + std::to_string(limits.memory >> 20) + " MB; simplify the mesh";
  } catch (const std::exception& error) {
    trouble = error.what();
  } catch (...) {
    trouble = "cannot be read as " + format;
  }
  write_text(pipe, trouble);
  if (trouble.empty()) {
    write_text(pipe, loaded.format);
    write_all(pipe, &loaded.metres_per_unit, sizeof loaded.metres_per_unit);
    write_array(pipe, loaded.mesh.vertices);
    write_array(pipe, loaded.mesh.triangles);
    write_array(pipe, loaded.group_of_triangle);
    const std::uint64_t groups = loaded.group_names.size();
    write_all(pipe, &groups, sizeof groups);
    for (const std::string& name : loaded.group_names) write_text(pipe, name);
  }
  _exit(0);
}

// --- the parent's side: bounded reading against a deadline ------------------------------------------------------------------------------

struct ChildFailure {
  std::string what;
};

class Pipe {
 public:
  Pipe(int descriptor, double seconds)
      : descriptor_(descriptor), deadline_(clock::now() + std::chrono::milliseconds(std::int64_t(seconds * 1e3))) {}
  void read(void* data, std::size_t bytes) {
    char* at = static_cast<char*>(data);
    while (bytes > 0) {
      wait_for_data();
      const ssize_t got = ::read(descriptor_, at, bytes);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) throw ChildFailure{"ended early"};
      at += got;
      bytes -= std::size_t(got);
    }
  }
  std::uint64_t read_count(std::uint64_t most) {
    std::uint64_t count = 0;
    read(&count, sizeof count);
    if (count > most) throw ChildFailure{"sent nonsense"};
    return count;
  }
  std::string read_text() {
    std::string text(read_count(1 << 20), '\0');
    read(text.data(), text.size());
    return text;
  }
  template <class Array>
  void read_array(Array& array, std::uint64_t most) {
    array.resize(read_count(most));
    read(array.data(), array.size() * sizeof(array[0]));
  }

 private:
  using clock = std::chrono::steady_clock;
  void wait_for_data() {
    for (;;) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - clock::now()).count();
      if (left <= 0) throw ChildFailure{"timed out"};
      pollfd entry{descriptor_, POLLIN, 0};
      const int ready = ::poll(&entry, 1, int(std::min<std::int64_t>(left, 1000)));
      if (ready > 0) return;
      if (ready < 0 && errno != EINTR) throw ChildFailure{"ended early"};
    }
  }
  int descriptor_;
  clock::time_point deadline_;
};

std::string receive(int descriptor, const LoadLimits& limits, LoadedMesh& loaded) {
  Pipe pipe(descriptor, limits.seconds);
  if (std::string trouble = pipe.read_text(); !trouble.empty()) return trouble;
  loaded.format = pipe.read_text();
  pipe.read(&loaded.metres_per_unit, sizeof loaded.metres_per_unit);
  pipe.read_array(loaded.mesh.vertices, 3 * limits.triangles);
  pipe.read_array(loaded.mesh.triangles, limits.triangles);
  pipe.read_array(loaded.group_of_triangle, limits.triangles);
  loaded.group_names.resize(pipe.read_count(1 << 20));
  for (std::string& name : loaded.group_names) name = pipe.read_text();
  return {};
}

std::string describe_death(const ChildFailure& failure, int status, const LoadLimits& limits) {
  const bool slow = failure.what == "timed out" || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL));
  if (slow)
    return "reading it took longer than " + std::to_string(int(limits.seconds)) +
           " s; simplify the mesh or save it again from your segmentation tool";
  return "is malformed: the reader broke down on it; save it again from your segmentation tool";
}

LoadedMesh load_in_child(const std::string& path, const std::string& format, const std::string& bytes, const LoadLimits& limits) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("cannot be read: no pipe left on this machine");
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw std::runtime_error("cannot be read: this machine allows no further process");
  }
  if (child == 0) {
    ::close(ends[0]);
    run_child(ends[1], path, format, bytes, limits);
  }
  ::close(ends[1]);
  LoadedMesh loaded;
  std::string trouble;
  std::optional<ChildFailure> failure;
  try {
    trouble = receive(ends[0], limits, loaded);
  } catch (const ChildFailure& caught) {
    failure = caught;
    if (caught.what != "ended early") ::kill(child, SIGKILL);
  } catch (const std::bad_alloc&) {
    ::kill(child, SIGKILL);
    trouble = "does not fit into this machine's memory; simplify the mesh";
  }
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (failure) throw std::runtime_error(describe_death(*failure, status, limits));
  if (!trouble.empty()) throw std::runtime_error(trouble);
  return loaded;
}

}  // namespace

double metres_per_unit(std::string_view units) {
  const std::pair<std::string_view, double> table[] = {
      {"m", 1},       {"metre", 1},         {"metres", 1},         {"meter", 1},         {"meters", 1},
      {"cm", 1e-2},   {"centimetre", 1e-2}, {"centimetres", 1e-2}, {"centimeter", 1e-2}, {"centimeters", 1e-2},
      {"mm", 1e-3},   {"millimetre", 1e-3}, {"millimetres", 1e-3}, {"millimeter", 1e-3}, {"millimeters", 1e-3},
      {"um", 1e-6},   {"micrometre", 1e-6}, {"micrometres", 1e-6}, {"micrometer", 1e-6}, {"micrometers", 1e-6},
      {"in", 0.0254}, {"inch", 0.0254}};
  const std::string text(units);  // "120 mm": one unit of the file is 120 mm
  char* rest = nullptr;
  const double number = std::strtod(text.c_str(), &rest);
  const double factor = rest == text.c_str() ? 1 : number;
  while (*rest == ' ') ++rest;
  for (const auto& [name, metres] : table)
    if (name == rest && factor > 0 && std::isfinite(factor)) return factor * metres;
  throw std::runtime_error("unknown units \"" + text + "\"; use mm, cm, m or um, or a number of them as in \"120 mm\"");
}

LoadedMesh load_mesh(const std::string& path, const LoadLimits& limits) {
  try {
    const std::string bytes = read_bytes(path);
    if (bytes.empty()) throw std::runtime_error("is empty; export the mesh again");
    const std::string suffix = suffix_of(path);
    const std::string held = detail::sniff_format(bytes);
    if (std::string(known_formats).find(suffix) == std::string::npos || suffix.size() < 3)
      throw std::runtime_error(held.empty() ? "has an unknown suffix; known are " + std::string(known_formats)
                                            : "has an unknown suffix but holds " + held + " data; rename it to ." + held);
    if (!held.empty() && held != suffix) throw std::runtime_error("holds " + held + " data, not " + suffix + "; rename it to ." + held);
    if (held.empty() && suffix != "obj")
      throw std::runtime_error("does not hold " + suffix + " data; check the file or give it its right suffix");
    return load_in_child(path, suffix, bytes, limits);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace geometry
