#include "render/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <stdexcept>

namespace render {

struct EglContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  EGLSurface surface = EGL_NO_SURFACE;

  bool make_current() const { return eglMakeCurrent(display, surface, surface, context) == EGL_TRUE; }
  ~Handles() {
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    // The display is shared by the whole process: terminating it here would pull it from under another context.
  }
};

namespace {

const char* error_name(EGLint error) {
  switch (error) {
    case EGL_SUCCESS:
      return "no reason given";
    case EGL_NOT_INITIALIZED:
      return "EGL_NOT_INITIALIZED";
    case EGL_BAD_ACCESS:
      return "EGL_BAD_ACCESS";
    case EGL_BAD_ALLOC:
      return "EGL_BAD_ALLOC";
    case EGL_BAD_ATTRIBUTE:
      return "EGL_BAD_ATTRIBUTE";
    case EGL_BAD_CONFIG:
      return "EGL_BAD_CONFIG";
    case EGL_BAD_DISPLAY:
      return "EGL_BAD_DISPLAY";
    case EGL_BAD_MATCH:
      return "EGL_BAD_MATCH";
    case EGL_BAD_PARAMETER:
      return "EGL_BAD_PARAMETER";
    default:
      return "another EGL error";
  }
}

struct Candidate {
  std::string name;
  EGLDisplay display;
};

std::vector<Candidate> candidates(const std::vector<std::string>& only, std::string& tried) {
  const auto wanted = [&](const char* kind) { return std::find(only.begin(), only.end(), kind) != only.end(); };
  std::vector<Candidate> found;
  if (wanted("device")) {
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
        (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
         epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))) {
      EGLint count = 0;
      eglQueryDevicesEXT(0, nullptr, &count);
      std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(std::max(count, 0)));
      if (count > 0) eglQueryDevicesEXT(count, devices.data(), &count);
      if (count < 1) tried += "; device: none listed";
      for (EGLint i = 0; i < count; ++i)
        found.push_back({"device " + std::to_string(i), eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr)});
    } else {
      tried += "; device: not offered by this EGL";
    }
  }
  if (wanted("surfaceless")) {
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
      found.push_back({"surfaceless", eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)});
    else
      tried += "; surfaceless: not offered by this EGL";
  }
  if (wanted("default")) found.push_back({"default display", eglGetDisplay(EGL_DEFAULT_DISPLAY)});
  return found;
}

// Makes a context on the display; returns an empty string, or why it did not work.
template <class Handles>
std::string open(const Candidate& candidate, bool pbuffer, Handles& handles) {
  if (candidate.display == EGL_NO_DISPLAY) return "no display";
  if (!eglInitialize(candidate.display, nullptr, nullptr)) return std::string("initialisation: ") + error_name(eglGetError());
  if (!eglBindAPI(EGL_OPENGL_API)) return "no desktop OpenGL";
  const EGLint config_wanted[] = {EGL_SURFACE_TYPE, pbuffer ? EGL_PBUFFER_BIT : 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(candidate.display, config_wanted, &config, 1, &count) || count < 1) return "no configuration with OpenGL";
  const EGLint context_wanted[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  handles.display = candidate.display;
  handles.context = eglCreateContext(candidate.display, config, EGL_NO_CONTEXT, context_wanted);
  if (handles.context == EGL_NO_CONTEXT) return std::string("OpenGL 3.3 context: ") + error_name(eglGetError());
  if (pbuffer) {
    const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    handles.surface = eglCreatePbufferSurface(candidate.display, config, size);
    if (handles.surface == EGL_NO_SURFACE) return std::string("pbuffer: ") + error_name(eglGetError());
  }
  if (!handles.make_current()) return std::string("making it current: ") + error_name(eglGetError());
  if (epoxy_gl_version() < 33) return "OpenGL " + std::to_string(epoxy_gl_version()) + " is below 3.3";
  return {};
}

}  // namespace

EglContext::EglContext(const std::vector<std::string>& only) {
  std::string tried;
  for (const Candidate& candidate : candidates(only, tried))
    for (const bool pbuffer : {false, true}) {
      auto handles = std::make_unique<Handles>();
      const std::string reason = open(candidate, pbuffer, *handles);
      const std::string name = candidate.name + (pbuffer ? " with a pbuffer" : "");
      if (reason.empty()) {
        handles_ = std::move(handles);
        description_ = std::string(reinterpret_cast<const char*>(glGetString(GL_RENDERER))) + ", by " + name;
        return;
      }
      tried += "; " + name + ": " + reason;
    }
  throw std::runtime_error("no EGL device can draw with OpenGL 3.3 (tried" + (tried.empty() ? std::string(" nothing") : tried.substr(1)) +
                           "); Mesa's software driver does: on Debian, install libegl-mesa0 and libgl1-mesa-dri");
}

EglContext::~EglContext() = default;

void EglContext::make_current() {
  if (!handles_->make_current()) throw std::runtime_error("EGL context: cannot be made current on this thread");
}

}  // namespace render
