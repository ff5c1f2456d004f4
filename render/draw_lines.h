// Lines of a given width in pixels, with round ends.
#pragma once

#include <vector>

#include "render/camera.h"
#include "render/frame.h"
#include "render/shader.h"

namespace render {

struct Segment {
  Eigen::Vector3f from, to;  // m
  Color from_color, to_color;
};

// The segments of a line layer, coloured by its style.
std::vector<Segment> segments(const Line& line, const Style& style, const ColorScale* scale);
// Plain segments of one colour.
std::vector<Segment> segments(const std::vector<std::array<Eigen::Vector3f, 2>>& pairs, const Color& color);

// Needs a current context, and a framebuffer with the lit picture and the depth of the opaque things bound.
class LinePainter {
 public:
  LinePainter();
  // Hidden by what is nearer; `over` the same, but leaves the depths as they are, for a second line along a wider one: where segments of
  // one colour meet, no seam shows; on_top: never hidden.
  enum class Depth { hidden, over, on_top };
  // width in pixels; `lift` (m) moves the lines towards the eye, so that a line on a surface is not half sunk in it.
  void draw(const std::vector<Segment>& segments, float width, float lift, Depth depth, const Projection& projection);

 private:
  Program program_;
  VertexArray vertices_;
  Buffer buffer_;
};

}  // namespace render
