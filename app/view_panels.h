// The window's panels in Dear ImGui: they read and change a ViewSession, and know nothing of GLFW or OpenGL, so that they are tested
// without a display.
#pragma once

#include <imgui.h>

#include <functional>
#include <string>
#include <vector>

#include "app/view_session.h"

namespace app {

// A drawn picture as the window keeps it.
struct PanelTexture {
  ImTextureID texture = nullptr;
  int width = 0, height = 0;  // pixels, with the title
  int top = 0;                // pixels that the title takes
  int reserved_right = 0;     // pixels that the colour bar takes
};

// What the panels ask of the window.
struct PanelRequests {
  bool moving = false;  // the mouse drags: draw with less detail
  bool close = false;
  bool preview = false;  // the dry preview was asked for
  std::string open;      // a file to open, or empty
};

struct PanelState {
  float picture_x = 0, picture_y = 0, picture_width = 640, picture_height = 480;  // where pictures go, of the last frame
  float preview_pressure = 12;                                                    // kPa
  char path[1024] = "";                                                           // typed into File
  bool painting = false;                                                          // a click paints a stiff spot instead of picking
  float spot_radius = 2, spot_scale = 20;                                         // mm, times
  float pick_x = -1, pick_y = -1;  // 0 ... 1 of the first picture: a click that a script asks for
  std::string complaint;           // the last refusal, until the next action
};

// Fonts and colours; call once after ImGui::CreateContext. `scale`: pixels a point (1 on a plain screen).
void style_panels(float scale);

// All panels of one frame, between ImGui::NewFrame and ImGui::Render.
PanelRequests draw_panels(ViewSession& session, PanelState& state, const std::vector<PanelTexture>& pictures);

// What the words of the data mean to a surgeon: "stress" -> "Stress (von Mises)" and a sentence for the tooltip.
struct Words {
  std::string label, tip;
};
Words words_for(const std::string& name);

}  // namespace app
