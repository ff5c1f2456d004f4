#include "app/picture_overlay.h"

#include <algorithm>

#include "app/measure_render.h"
#include "render/text.h"

namespace app {

WindowPicture draw_window_picture(render::PanelPainter& painter, render::Lettering& lettering, const ViewModel::Picture& picture,
                                  const std::optional<Picked>& picked, int width, int height, bool draft) {
  render::PictureSettings settings{width, height, {}};
  if (draft) settings = draft_settings(width, height);
  lettering.size = std::clamp(std::min(settings.height / 36, settings.width / 30), 8, 26);
  WindowPicture result{render::Image(settings.width, settings.height), 2 * lettering.size,
                       render::legend_space(picture.panel, lettering.size)};
  const render::Rect title{0, 0, settings.width, result.top}, place{0, result.top, settings.width, settings.height - result.top};
  render::paste(result.image, painter.draw(*picture.frame, picture.panel, place.width, place.height, result.reserved_right, settings.draw),
                place.x, place.y);
  render::draw_panel_title(result.image, title, picture.panel, lettering);
  render::draw_panel_overlay(result.image, place, *picture.frame, picture.panel, lettering);
  if (!picked) return result;
  const render::Projection projection =
      render::panel_projection(*picture.frame, picture.panel, place.width, place.height, result.reserved_right);
  const Eigen::Vector3f at = render::to_pixel(projection, picked->place);
  const auto size = static_cast<float>(lettering.size);
  render::disc(result.image, at.x(), at.y() + static_cast<float>(place.y), 0.45f * size, render::Color(1, 1, 1));
  render::disc(result.image, at.x(), at.y() + static_cast<float>(place.y), 0.3f * size, render::Color(0.05f, 0.35f, 0.85f));
  return result;
}

}  // namespace app
