// What the panels have in common. Internal to app/view_panel*.cpp.
#pragma once

#include <exception>
#include <string>

#include "app/view_panels.h"

namespace app {

void draw_left(ViewSession& session, PanelState& state, PanelRequests& requests, float height);

namespace panel_parts {

inline constexpr float side_width = 300, bottom_height = 250;  // points

inline void tip(const std::string& text) {
  if (!text.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
}

inline void heading(const char* text) {
  ImGui::Spacing();
  ImGui::TextColored(ImVec4(0.10f, 0.32f, 0.66f, 1), "%s", text);
  ImGui::Separator();
}

inline bool begin_panel(const char* name, float x, float y, float width, float height, ImGuiWindowFlags more = 0) {
  ImGui::SetNextWindowPos(ImVec2(x, y));
  ImGui::SetNextWindowSize(ImVec2(width, height));
  return ImGui::Begin(name, nullptr,
                      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse |
                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus | more);
}

// Does something that may be refused, and keeps the refusal's words for the user.
template <class Action>
void attempt(PanelState& state, Action&& action) {
  try {
    state.complaint.clear();
    action();
  } catch (const std::exception& error) {
    state.complaint = error.what();
  }
}

}  // namespace panel_parts
}  // namespace app
