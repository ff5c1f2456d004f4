// An OpenGL 3.3 core context without a display.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace render {

class EglContext {
 public:
  // Tries, in this order: every EGL device, Mesa's surfaceless platform, the default display; each without a surface, then with a 1 x 1
  // pbuffer. `only` restricts it to the kinds named ("device", "surfaceless", "default"). Throws std::runtime_error whose text says what
  // was tried and why each failed. The context is current on the calling thread.
  explicit EglContext(const std::vector<std::string>& only = {"device", "surfaceless", "default"});
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current();
  // "llvmpipe (LLVM 15.0.6, 256 bits), by surfaceless"
  const std::string& description() const { return description_; }

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  std::string description_;
};

}  // namespace render
