#include "app/view_window.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
// epoxy before GLFW: both declare OpenGL
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "app/picture_overlay.h"

namespace app {
namespace {

double wall_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::string& glfw_complaint() {
  static std::string text;
  return text;
}

// The window and its context, freed in the right order.
struct Window {
  GLFWwindow* handle = nullptr;
  float scale = 1;

  explicit Window(const WindowSettings& settings) {
    glfwSetErrorCallback([](int, const char* words) { glfw_complaint() = words; });
    const std::string instead = "; `cusp render` makes pictures and movies without a display";
    if (!glfwInit()) throw std::runtime_error("cusp view: there is no display (" + glfw_complaint() + ")" + instead);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    handle = glfwCreateWindow(settings.width, settings.height, "Cusp", nullptr, nullptr);
    if (!handle) {
      glfwTerminate();
      throw std::runtime_error("cusp view: no window with OpenGL 3.3 (" + glfw_complaint() + ")" + instead);
    }
    glfwMakeContextCurrent(handle);
    glfwSwapInterval(1);
    float across = 1;
    glfwGetWindowContentScale(handle, &scale, &across);
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    style_panels(scale);
    ImGui_ImplGlfw_InitForOpenGL(handle, true);
    ImGui_ImplOpenGL3_Init("#version 330");
  }
  ~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(handle);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
};

// The pictures as textures, drawn again only when what they show has changed.
class Pictures {
 public:
  const std::vector<PanelTexture>& shown() const { return shown_; }

  void update(ViewSession& session, float width, float height, bool moving) {
    const std::vector<ViewModel::Picture> wanted = session.model.pictures();
    const std::string now = session.model.signature() + (moving ? " draft " : " ") + std::to_string(width) + "x" + std::to_string(height);
    if (now == drawn_) return;
    drawn_ = now;
    while (textures_.size() < wanted.size()) {
      GLuint name = 0;
      glGenTextures(1, &name);
      textures_.push_back(name);
    }
    shown_.clear();
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const int each = std::max(160, static_cast<int>(width / static_cast<float>(wanted.size()))),
                tall = std::max(120, static_cast<int>(height));
      const WindowPicture picture = draw_window_picture(painter_, lettering_, wanted[k], session.model.picked, each, tall, moving);
      glBindTexture(GL_TEXTURE_2D, textures_[k]);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
      glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, picture.image.width, picture.image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   picture.image.rgba.data());
      shown_.push_back({reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(textures_[k])), picture.image.width, picture.image.height,
                        picture.top, picture.reserved_right});
    }
  }

 private:
  render::PanelPainter painter_;
  render::Lettering lettering_;
  std::vector<GLuint> textures_;
  std::vector<PanelTexture> shown_;
  std::string drawn_;
};

render::Image screenshot(GLFWwindow* window) {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window, &width, &height);
  render::Image image(width, height);
  std::vector<std::uint8_t> pixels(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  for (int y = 0; y < height; ++y) std::copy_n(&pixels[4 * static_cast<std::size_t>(height - 1 - y) * width], 4 * width, image.at(0, y));
  return image;
}

class Loop {
 public:
  Loop(ViewSession& session, const WindowSettings& settings, std::optional<ScriptRunner> script)
      : session_(session), settings_(settings), script_(std::move(script)), window_(settings) {}

  void run() {
    double last = wall_seconds();
    while (!glfwWindowShouldClose(window_.handle)) {
      const bool idle = !session_.model.playing && !script_ && wall_seconds() - active_ > 0.5;
      if (idle)
        glfwWaitEventsTimeout(0.25);
      else if (script_ && !session_.model.playing)
        glfwWaitEventsTimeout(0.02);
      else
        glfwPollEvents();
      const double now = wall_seconds();
      session_.model.advance(std::min(now - last, 0.5));
      last = now;
      if (now - polled_ > 0.5) session_.poll(), polled_ = wall_seconds();
      session_.model.read_history(3);
      ScriptRunner::Wishes wishes;
      if (script_) wishes = script_->go_on(session_, state_, now);
      PanelRequests requests = draw_once("");
      if (wishes.close) return;
      if (!wishes.screenshot.empty()) {
        draw_once("");  // panels show what the step before changed one frame later
        render::write_png(screenshot(window_.handle), wishes.screenshot);
      }
      requests.preview = requests.preview || wishes.preview;
      answer(requests);
      if (script_ && script_->done() && !wishes.preview && wishes.screenshot.empty()) return;
    }
  }

 private:
  PanelRequests draw_once(const std::string& banner) {
    const bool moving = settings_.draft && (moving_ || session_.model.playing);
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_.handle, &width, &height);
    if (session_.model.has_run() && width > 0) pictures_.update(session_, state_.picture_width, state_.picture_height, moving);
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    static const std::vector<PanelTexture> none;
    const PanelRequests requests = draw_panels(session_, state_, session_.model.has_run() ? pictures_.shown() : imported());
    if (!banner.empty()) draw_banner(banner);
    ImGui::Render();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, width, height);
    glClearColor(0.93f, 0.94f, 0.95f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (requests.moving || ImGui::IsAnyItemActive() || ImGui::IsAnyItemHovered()) active_ = wall_seconds();
    moving_ = requests.moving;
    glfwSwapBuffers(window_.handle);
    return requests;
  }

  // The picture of an import, where that is what is looked at.
  const std::vector<PanelTexture>& imported() {
    if (!session_.import_picture()) import_.clear();
    if (session_.import_picture() && import_.empty()) {
      const render::Image& picture = *session_.import_picture();
      GLuint name = 0;
      glGenTextures(1, &name);
      glBindTexture(GL_TEXTURE_2D, name);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, picture.width, picture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, picture.rgba.data());
      import_.push_back({reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(name)), picture.width, picture.height, 0, 0});
    }
    return import_;
  }

  static void draw_banner(const std::string& words) {
    ImDrawList* list = ImGui::GetForegroundDrawList();
    const ImVec2 size = ImGui::GetIO().DisplaySize, text = ImGui::CalcTextSize(words.c_str());
    const ImVec2 corner(0.5f * (size.x - text.x) - 20, 0.4f * size.y - 12);
    list->AddRectFilled(corner, ImVec2(corner.x + text.x + 40, corner.y + text.y + 24), IM_COL32(255, 255, 255, 235), 4);
    list->AddRect(corner, ImVec2(corner.x + text.x + 40, corner.y + text.y + 24), IM_COL32(178, 186, 196, 255), 4);
    list->AddText(ImVec2(corner.x + 20, corner.y + 12), IM_COL32(26, 31, 38, 255), words.c_str());
  }

  void answer(const PanelRequests& requests) {
    try {
      if (!requests.open.empty()) session_.open(requests.open);
      if (requests.preview) preview();
      if (!requests.open.empty() || requests.preview) state_.complaint.clear();
    } catch (const std::exception& error) {
      if (script_) throw;
      state_.complaint = error.what();
    }
  }

  // The window stays alive: it is drawn again between the preview's steps.
  void preview() {
    double drawn = 0;
    draw_once("without blood: preparing");
    session_.preview(1000.0 * state_.preview_pressure, [&](double done) {
      if (wall_seconds() - drawn < 0.2) return;
      glfwPollEvents();
      draw_once("without blood: " + std::to_string(std::lround(100 * done)) + " %");
      drawn = wall_seconds();
    });
  }

  ViewSession& session_;
  WindowSettings settings_;
  std::optional<ScriptRunner> script_;
  Window window_;
  Pictures pictures_;
  PanelState state_;
  std::vector<PanelTexture> import_;
  bool moving_ = false;
  double active_ = wall_seconds(), polled_ = 0;
};

}  // namespace

void run_window(ViewSession& session, const WindowSettings& settings, std::optional<ScriptRunner> script) {
  Loop(session, settings, std::move(script)).run();
}

}  // namespace app
