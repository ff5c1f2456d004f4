// The window's left panel: what is open, from where it is seen, what the colours mean, what is picked.
#include <algorithm>
#include <cmath>

#include "app/view_panel_parts.h"
#include "app/view_plots.h"

namespace app {

using namespace panel_parts;

namespace {

void choose_view(ViewModel& model, PanelState& state) {
  heading("View");
  int column = 0;
  for (const std::string& view : model.views()) {
    if (column++ % 2) ImGui::SameLine(0.5f * ImGui::GetWindowWidth());
    const Words words = words_for(view);
    if (ImGui::RadioButton(words.label.c_str(), model.shown.view == view)) attempt(state, [&] { model.look(view); });
    tip(words.tip + "\nClick again to come back to it after turning the picture.");
  }
}

void choose_field(ViewModel& model) {
  heading("Colours show");
  for (const std::string& field : model.fields()) {
    const Words words = words_for(field);
    if (ImGui::RadioButton(words.label.c_str(), model.shown.field == field)) {
      model.shown.field = field;
      model.shown.range = model.shown.range == RangeMode::by_hand ? RangeMode::whole_run : model.shown.range;
      if (model.picked) model.picked->time.clear(), model.picked->value.clear(), model.picked->read = 0;
    }
    tip(words.tip);
  }
  int mode = static_cast<int>(model.shown.range);
  const char* modes[] = {"scale of the whole run", "scale of this moment", "scale set by hand"};
  ImGui::SetNextItemWidth(-1);
  if (ImGui::Combo("##range", &mode, modes, 3)) {
    model.shown.range = static_cast<RangeMode>(mode);
    const auto found = model.run().ranges().find(model.shown.field);
    if (found != model.run().ranges().end()) model.shown.by_hand = found->second;
  }
  tip("The same scale over the whole run lets moments be compared; the scale of one moment shows its finest differences.");
  if (model.shown.range == RangeMode::by_hand) {
    const render::ColorScale unit = field_scale(model.shown.field, model.shown.by_hand, model.shown.pressure_units, "");
    float ends[2] = {static_cast<float>(model.shown.by_hand[0] * unit.factor), static_cast<float>(model.shown.by_hand[1] * unit.factor)};
    ImGui::SetNextItemWidth(-1);
    if (ImGui::DragFloat2(("##ends" + unit.unit).c_str(), ends, 0.01f * std::max(1e-6f, ends[1] - ends[0])) && ends[1] > ends[0])
      model.shown.by_hand = {ends[0] / unit.factor, ends[1] / unit.factor};
    tip("Lowest and highest value of the colours, in " + unit.unit);
  }
}

void choose_looks(ViewModel& model) {
  static const std::vector<std::string> maps = {"", "viridis", "inferno", "plasma", "cividis", "diverging"};
  if (ImGui::CollapsingHeader("Colour map and units")) {
    for (const std::string& map : maps) {
      if (ImGui::RadioButton(map.empty() ? "usual map" : map.c_str(), model.shown.map == map)) model.shown.map = map;
      tip("All maps can be read with the common colour blindnesses.");
    }
    for (const char* unit : {"kPa", "mmHg"}) {
      if (ImGui::RadioButton(unit, model.shown.pressure_units == unit)) model.shown.pressure_units = unit;
      tip("Unit of blood pressure");
      ImGui::SameLine();
    }
    ImGui::NewLine();
  }
  heading("Parts");
  ImGui::Checkbox("Aorta", &model.shown.aorta);
  tip("The vessel's wall, as glass");
  ImGui::SameLine();
  ImGui::Checkbox("Leaflets", &model.shown.leaflets);
  tip("The valve's leaflets (those that carry the colours stay)");
  ImGui::SameLine();
  ImGui::Checkbox("Blood", &model.shown.blood);
  tip("The blood where a view cuts it open");
  ImGui::Checkbox("Smooth", &model.shown.smooth);
  tip("Stress averaged over neighbouring patches of tissue. The mark beside the colour bar is always the highest value before averaging.");
  ImGui::SameLine();
  ImGui::Checkbox("Cut", &model.shown.cut);
  tip("Cuts away what lies before a plane across your line of sight. Move it with the slider, or drag with Ctrl held down.");
  if (model.shown.cut) {
    auto millimetres = static_cast<float>(1e3 * model.shown.cut_at);
    ImGui::SetNextItemWidth(-1);
    if (ImGui::SliderFloat("##cut", &millimetres, -25, 25, "%.1f mm")) model.shown.cut_at = 1e-3 * millimetres;
  }
}

void show_picked(ViewModel& model) {
  if (!model.picked) {
    ImGui::TextWrapped("Click on a leaflet to follow the place through the beat.");
    return;
  }
  const Picked& picked = *model.picked;
  ImGui::TextWrapped("%s", picked.what.c_str());
  const std::string field = is_fluid_field(model.shown.field) ? "stress" : model.shown.field;
  const auto range = model.run().ranges().find(field);
  const render::ColorScale unit =
      field_scale(field, range == model.run().ranges().end() ? Range2{0, 1} : range->second, model.shown.pressure_units, "");
  if (!picked.value.empty()) {
    const std::size_t at = std::min(model.frame_index(), picked.value.size() - 1);
    const auto highest = std::max_element(picked.value.begin(), picked.value.end());
    ImGui::Text("now %.3g, highest %.3g %s", picked.value[at] * unit.factor, *highest * unit.factor, unit.unit.c_str());
    draw_history(picked, unit, model.time());
  }
  if (picked.read < model.run().frame_count()) ImGui::Text("reading frame %zu of %zu", picked.read, model.run().frame_count());
}

}  // namespace

void draw_left(ViewSession& session, PanelState& state, PanelRequests& requests, float height) {
  begin_panel("View", 0, 0, side_width, height);
  ImGui::SetNextItemWidth(-60);
  ImGui::InputTextWithHint("##path", "run, scene or mesh", state.path, sizeof state.path);
  tip("A run (.h5), a scene (.toml) or a patient's mesh (.stl, .ply, .obj ...)");
  ImGui::SameLine();
  if (ImGui::Button("Open", ImVec2(-1, 0)) && state.path[0]) requests.open = state.path;
  if (session.model.has_run() && session.model.run().frame_count() > 0) {
    choose_view(session.model, state);
    choose_field(session.model);
    choose_looks(session.model);
    heading("Place");
    show_picked(session.model);
  }
  ImGui::End();
}

}  // namespace app
