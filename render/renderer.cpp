#include "render/renderer.h"

#include <stdexcept>

#include "render/egl_context.h"
#include "render/overlay.h"

namespace render {

struct Renderer::Parts {
  EglContext context;
  PanelPainter painter;
  Lettering lettering;
};

Renderer::Renderer() : parts_(std::make_unique<Parts>()) {}
Renderer::~Renderer() = default;

const std::string& Renderer::driver() const { return parts_->context.description(); }

Image Renderer::draw(const Frame& frame, const PictureSettings& settings) {
  check_frame(frame);
  const Layout layout = lay_out(frame, settings.width, settings.height);
  parts_->lettering.size = layout.text_size;
  parts_->context.make_current();
  Image image(settings.width, settings.height);
  for (std::size_t i = 0; i < frame.panels.size(); ++i) {
    const Panel& panel = frame.panels[i];
    const Rect& place = layout.panels[i];
    if (place.width < 16 || place.height < 16) throw std::invalid_argument("the picture is too small for its panels: make it larger");
    long drawn = 0;
    const int reserved = legend_space(panel, layout.text_size);
    paste(image, parts_->painter.draw(frame, panel, place.width, place.height, reserved, settings.draw, &drawn), place.x, place.y);
    if (drawn == 0)
      throw std::runtime_error("the picture" + (panel.title.empty() ? "" : " '" + panel.title + "'") +
                               " shows nothing but background: what it should show is empty or lies outside the view");
    draw_panel_title(image, layout.titles[i], panel, parts_->lettering);
    draw_panel_overlay(image, place, frame, panel, parts_->lettering);
    if (place.x > 0)
      fill(image, static_cast<float>(place.x) - 1, static_cast<float>(layout.titles[i].y), 2,
           static_cast<float>(layout.titles[i].height + place.height), Color(0.6f, 0.63f, 0.67f));
  }
  draw_header(image, layout.header, frame, parts_->lettering);
  draw_plots(image, layout.plots, frame, parts_->lettering);
  draw_footer(image, layout.footer, frame, parts_->lettering);
  return image;
}

}  // namespace render
