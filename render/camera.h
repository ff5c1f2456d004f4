// Where the eye is and what it sees. Right-handed; view space looks along -z.
#pragma once

#include <Eigen/Core>

namespace render {

struct Camera {
  Eigen::Vector3f target = Eigen::Vector3f::Zero();     // m, in the middle of the picture
  Eigen::Vector3f backward = Eigen::Vector3f::UnitZ();  // unit, from the target to the eye
  Eigen::Vector3f up = Eigen::Vector3f::UnitY();        // not along backward; need not be orthogonal to it
  float width = 1, height = 1;                          // m at the target that the picture must hold, > 0
  float field_of_view = 0;  // rad, vertical, of `height`; 0 = orthographic (a scale bar is then exact everywhere)
};

// The box and the ball round what is drawn.
struct Bounds {
  Eigen::Vector3f min = Eigen::Vector3f::Constant(1e30f), max = Eigen::Vector3f::Constant(-1e30f);
  void add(const Eigen::Vector3f& point, float radius = 0);
  void add(const Bounds& other);
  bool empty() const { return min.x() > max.x(); }
  Eigen::Vector3f center() const { return 0.5f * (min + max); }
  float radius() const { return empty() ? 0 : 0.5f * (max - min).norm(); }
};

// A camera applied to a picture of so many pixels; near and far planes from the bounds.
struct Projection {
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity(), projection = Eigen::Matrix4f::Identity();
  bool perspective = false;
  int width = 0, height = 0;   // pixels
  float pixels_per_metre = 0;  // at the target
  float near = 0, far = 0;     // m before the eye
};
// `reserved_right`: pixels at the right edge that the camera's width shall not use (a colour bar stands there); the target moves to the
// middle of what is left.
Projection project(const Camera& camera, int width, int height, const Bounds& bounds, int reserved_right = 0);

// Pixel coordinates (x right, y down from the top left corner) and depth 0 (near) ... 1 (far).
Eigen::Vector3f to_pixel(const Projection& projection, const Eigen::Vector3f& point);

// The standard views of a valve. `axis` is unit from ventricle to aorta, `side` a direction across it (a commissure, say) that is turned
// to the right of the picture in the views along the axis and towards the eye in the long-axis view.
//   long_axis     the axis upwards, cut open towards the eye      short_axis      along the axis from the aorta, orthographic
//   from_aorta    the surgeon's view down onto the valve          from_ventricle  the same from below
enum class StandardView { long_axis, short_axis, from_aorta, from_ventricle };
Camera standard_camera(StandardView view, const Eigen::Vector3f& center, const Eigen::Vector3f& axis, const Eigen::Vector3f& side,
                       float width, float height);

// The camera that looks at a whole 2-D scene (plane z = 0), with a margin as a fraction of its size.
Camera flat_camera(const Bounds& bounds, float margin = 0.04f);

}  // namespace render
