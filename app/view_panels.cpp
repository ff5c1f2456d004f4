#include "app/view_panels.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "app/view_panel_parts.h"
#include "app/view_plots.h"
#include "render/text.h"

namespace app {

using namespace panel_parts;

namespace {

// --- right: the case and its replay -----------------------------------------------------------------------------------------------------

void slide(const char* label, double& value, double factor, float low, float high, const char* format, bool logarithmic,
           const char* words) {
  auto shown = static_cast<float>(value * factor);
  ImGui::TextUnformatted(label);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat((std::string("##") + label).c_str(), &shown, low, high, format,
                         logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None))
    value = static_cast<double>(shown) / factor;
  tip(words);
}

void draw_knobs(ViewSession& session, PanelState& state) {
  Knobs& knobs = session.now;
  heading("The leaflets");
  slide("Stiffness (Young's modulus)", knobs.youngs_modulus, 1e-6, 0.1f, 20, "%.2f MPa", true,
        "Healthy leaflets 0.3 to 2 MPa; fixed or calcified tissue several times as much. Ctrl-click to type a number.");
  slide("Thickness", knobs.thickness, 1e3, 0.2f, 2, "%.2f mm", false,
        "Healthy leaflets 0.3 to 0.6 mm. Changing it places the particles anew.");
  slide("Poisson's ratio", knobs.poisson_ratio, 1, 0.2f, 0.495f, "%.3f", false,
        "0.5 would keep its volume exactly, as wet tissue nearly does.");
  ImGui::Checkbox("Click paints a calcified spot", &state.painting);
  tip("Then click on a leaflet: the tissue within the radius becomes stiffer.");
  if (state.painting) {
    ImGui::SetNextItemWidth(0.45f * side_width);
    ImGui::SliderFloat("radius", &state.spot_radius, 0.5f, 6, "%.1f mm");
    ImGui::SetNextItemWidth(0.45f * side_width);
    ImGui::SliderFloat("as stiff", &state.spot_scale, 2, 100, "%.0f times", ImGuiSliderFlags_Logarithmic);
  }
  if (!knobs.spots.empty()) {
    ImGui::Text("%zu spot%s", knobs.spots.size(), knobs.spots.size() == 1 ? "" : "s");
    ImGui::SameLine();
    if (ImGui::SmallButton("remove the last")) knobs.spots.pop_back();
  }
  if (session.valve() && ImGui::CollapsingHeader("Heart")) {
    slide("Heart rate", knobs.heart_rate, 1, 40, 180, "%.0f a minute", false, "Beats a minute");
    ImGui::Checkbox("Own pressures", &knobs.own_pressures);
    tip("Else those of the case");
    if (knobs.own_pressures) {
      constexpr double mmHg = 1 / 133.322;
      slide("Left ventricle, systolic", knobs.ventricle_systolic, mmHg, 80, 220, "%.0f mmHg", false, "Highest pressure in the ventricle");
      slide("Aorta, systolic", knobs.aortic_systolic, mmHg, 80, 220, "%.0f mmHg", false, "Highest pressure in the aorta");
      slide("Aorta, diastolic", knobs.aortic_diastolic, mmHg, 30, 120, "%.0f mmHg", false, "Lowest pressure in the aorta");
    }
  }
}

void draw_actions(ViewSession& session, PanelState& state, PanelRequests& requests) {
  heading("Answer");
  ImGui::TextWrapped("%s", session.changes().c_str());
  if (session.valve()) {
    if (ImGui::Button("Preview the closed valve", ImVec2(-1, 0))) requests.preview = true;
    tip("In seconds, WITHOUT blood: the leaflets alone under a pressure difference. It misses 13 to 28 % of the peak stress and knows no "
        "flow. For a first look only.");
    ImGui::SetNextItemWidth(-1);
    ImGui::SliderFloat("##preview", &state.preview_pressure, 2, 20, "under %.1f kPa");
    tip("Aorta minus ventricle in diastole; 12 kPa are 90 mmHg");
  }
  if (!session.busy()) {
    if (ImGui::Button("Replay with blood", ImVec2(-1, 0))) attempt(state, [&] { session.replay(); });
    tip("The whole beat again with these settings, in the background. Frames appear as they are made; the run before stays beside it.");
  } else {
    ImGui::ProgressBar(static_cast<float>(session.progress()), ImVec2(-1, 0), session.progress_text().c_str());
    if (ImGui::Button("Stop", ImVec2(-1, 0))) session.cancel();
    tip("What was simulated is kept");
  }
  if (session.model.ghost()) {
    ImGui::Checkbox("The run before beside it", &session.model.shown.beside);
    tip("Both with the same colours, at the same moment");
  }
}

void draw_comparison(ViewSession& session) {
  const std::vector<ComparedFigure> figures = session.model.comparison();
  if (figures.empty()) return;
  heading("What changed");
  if (!ImGui::BeginTable("changed", 4, ImGuiTableFlags_SizingFixedFit | ImGuiTableFlags_RowBg)) return;
  for (const char* name : {"", "before", "after", "change"})  // names give way to the numbers, in as many lines as they need
    ImGui::TableSetupColumn(name, *name ? ImGuiTableColumnFlags_WidthFixed : ImGuiTableColumnFlags_WidthStretch);
  ImGui::TableHeadersRow();
  for (const ComparedFigure& figure : figures) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextWrapped("%s [%s]", figure.name.c_str(), figure.units.c_str());
    for (const double value : {figure.values.front(), figure.values.back()}) {
      ImGui::TableNextColumn();
      if (std::isfinite(value)) ImGui::Text("%.3g", value);
    }
    ImGui::TableNextColumn();
    const double part = (figure.values.back() - figure.values.front()) / std::abs(figure.values.front());
    if (std::isfinite(part)) ImGui::Text("%+.0f %%", 100 * part);
  }
  ImGui::EndTable();
}

void draw_import(ViewSession& session, PanelState& state) {
  heading("The patient's mesh");
  ImGui::TextWrapped("Is the root where it should be? Planes can be moved along the vessel before the valve is placed.");
  slide("Annulus", session.annulus_shift, 1e3, -10, 10, "%+.1f mm", false, "Towards the aorta positive");
  slide("Sinotubular junction", session.junction_shift, 1e3, -10, 10, "%+.1f mm", false, "Towards the aorta positive");
  if (ImGui::Button("Accept, place the valve", ImVec2(-1, 0))) attempt(state, [&] { session.accept_import(); });
}

void draw_right(ViewSession& session, PanelState& state, PanelRequests& requests, float x, float height) {
  begin_panel("Case", x, 0, side_width, height);
  if (session.import_picture()) draw_import(session, state);
  if (session.has_case()) {
    draw_knobs(session, state);
    draw_actions(session, state, requests);
    draw_comparison(session);
  } else if (session.busy()) {
    ImGui::TextWrapped("%s", session.message.c_str());
  }
  ImGui::End();
}

// --- bottom: time -----------------------------------------------------------------------------------------------------------------------

void draw_timeline(ViewModel& model) {
  if (ImGui::Button(model.playing ? "Pause" : "Play", ImVec2(70, 0))) model.playing = !model.playing;
  tip("Space");
  ImGui::SameLine();
  if (ImGui::Button("<")) model.step_frames(-1);
  tip("One frame back (left arrow)");
  ImGui::SameLine();
  if (ImGui::Button(">")) model.step_frames(1);
  tip("One frame on (right arrow)");
  ImGui::SameLine();
  auto slowness = static_cast<float>(model.slowness);
  ImGui::SetNextItemWidth(150);
  if (ImGui::SliderFloat("##slow", &slowness, 1, 100, "%.0f x slower", ImGuiSliderFlags_Logarithmic)) model.slowness = slowness;
  tip("Than the heart beats");
  ImGui::SameLine();
  ImGui::Checkbox("Loop", &model.loop);
  ImGui::SameLine();
  auto time = static_cast<float>(model.time());
  const auto first = static_cast<float>(model.run().times().front()), last = static_cast<float>(model.run().times().back());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##time", &time, first, std::max(last, first + 1e-9f), "t = %.3f s")) {
    model.playing = false;
    model.go_to(time);
  }
  tip("Drag to look through the beat");
}

void draw_bottom(ViewSession& session, PanelState& state, PanelRequests& requests, float y, float width, float height) {
  begin_panel("Time", 0, y, width, height);
  ViewModel& model = session.model;
  const std::string words = state.complaint.empty() ? session.message : state.complaint;
  if (model.has_run() && model.run().frame_count() > 0) {
    draw_timeline(model);
    if (ImGui::IsItemActive()) requests.moving = true;
    const double wanted = draw_curves(model, ImGui::GetContentRegionAvail().x, height - 92);
    if (std::isfinite(wanted)) {
      model.playing = false;
      model.go_to(wanted);
      requests.moving = true;
    }
    ImGui::TextUnformatted(model.status_text().c_str());
    ImGui::SameLine(0, 30);
  }
  ImGui::TextColored(state.complaint.empty() ? ImVec4(0.3f, 0.33f, 0.38f, 1) : ImVec4(0.72f, 0.27f, 0.02f, 1), "%s", words.c_str());
  ImGui::End();
}

// --- the middle -------------------------------------------------------------------------------------------------------------------------

// At a pixel of the picture: picks, or paints a spot.
void click(ViewSession& session, PanelState& state, std::size_t number, const PanelTexture& picture, float x, float y) {
  const bool found = session.model.pick(number, picture.width, picture.height - picture.top, picture.reserved_right, x,
                                        y - static_cast<float>(picture.top));
  if (found && state.painting) session.now.spots.push_back({session.model.picked->start, 1e-3 * state.spot_radius, state.spot_scale});
}

void handle_mouse(ViewSession& session, PanelState& state, PanelRequests& requests, std::size_t number, const PanelTexture& picture) {
  ViewModel& model = session.model;
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 corner = ImGui::GetItemRectMin();
  const float tall = std::max(1.0f, ImGui::GetItemRectSize().y);
  if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
    model.zoom(std::pow(1.15f, io.MouseWheel));
    requests.moving = true;
  }
  if (!ImGui::IsItemActive()) {
    if (!ImGui::IsItemDeactivated()) return;
    const ImVec2 way = ImGui::GetMouseDragDelta(0, 0);
    if (std::hypot(way.x, way.y) > 3 || picture.width == 0) return;
    const float scale = static_cast<float>(picture.width) / std::max(1.0f, ImGui::GetItemRectSize().x);
    click(session, state, number, picture, scale * (io.MousePos.x - corner.x), scale * (io.MousePos.y - corner.y));
    return;
  }
  const ImVec2 moved = io.MouseDelta;
  if (moved.x == 0 && moved.y == 0) return;
  requests.moving = true;
  if (io.KeyCtrl) {
    model.shown.cut = true;
    model.shown.cut_at -= 0.05 * static_cast<double>(moved.y) / tall;
  } else if (io.KeyShift || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2)) {
    model.pan(moved.x / tall, moved.y / tall);
  } else {
    model.orbit(3 * moved.x / tall, 3 * moved.y / tall);
  }
}

void draw_middle(ViewSession& session, PanelState& state, PanelRequests& requests, const std::vector<PanelTexture>& pictures) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  begin_panel("Pictures", state.picture_x, state.picture_y, state.picture_width, state.picture_height,
              ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::PopStyleVar();
  if (pictures.empty()) {
    ImGui::SetCursorPos(ImVec2(30, 30));
    ImGui::TextUnformatted(session.busy() ? session.message.c_str() : "Open a run, a scene or a patient's mesh.");
  }
  if (state.pick_x >= 0 && !pictures.empty()) {
    const PanelTexture& first = pictures.front();
    click(session, state, 0, first, state.pick_x * static_cast<float>(first.width), state.pick_y * static_cast<float>(first.height));
    state.pick_x = -1;
  }
  const float each = state.picture_width / static_cast<float>(std::max<std::size_t>(pictures.size(), 1));
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const auto at = static_cast<float>(k);
    ImGui::SetCursorPos(ImVec2(at * each, 0));
    ImGui::Image(pictures[k].texture, ImVec2(each, state.picture_height));
    if (!session.model.has_run()) continue;
    ImGui::SetCursorPos(ImVec2(at * each, 0));
    ImGui::InvisibleButton(("picture" + std::to_string(k)).c_str(), ImVec2(each, state.picture_height),
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    handle_mouse(session, state, requests, k, pictures[k]);
  }
  ImGui::End();
}

void handle_keys(ViewModel& model) {
  if (ImGui::GetIO().WantTextInput || !model.has_run() || model.run().frame_count() == 0) return;
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Space), false)) model.playing = !model.playing;
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_LeftArrow))) model.step_frames(-1);
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_RightArrow))) model.step_frames(1);
}

}  // namespace

void style_panels(float scale) {
  ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.FrameBorderSize = 1;
  style.WindowBorderSize = 1;
  style.ScaleAllSizes(scale);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;
  const auto bytes = render::font_file(false);
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;
  io.Fonts->AddFontFromMemoryTTF(const_cast<unsigned char*>(bytes.data()), static_cast<int>(bytes.size()), 15 * scale, &config);
}

PanelRequests draw_panels(ViewSession& session, PanelState& state, const std::vector<PanelTexture>& pictures) {
  PanelRequests requests;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float tall = std::max(200.0f, size.y - bottom_height);
  state.picture_x = side_width, state.picture_y = 0;
  state.picture_width = std::max(160.0f, size.x - 2 * side_width), state.picture_height = tall;
  handle_keys(session.model);
  draw_left(session, state, requests, tall);
  draw_right(session, state, requests, size.x - side_width, tall);
  draw_bottom(session, state, requests, tall, size.x, size.y - tall);
  draw_middle(session, state, requests, pictures);
  return requests;
}

}  // namespace app
