// Surfaces as they are drawn, remembered from picture to picture: several panels of a frame show the same leaflets, and from frame to frame
// these move but hang together as before. What comes out depends on the surface alone, never on what was asked before. No OpenGL.
#pragma once

#include <array>
#include <list>
#include <memory>
#include <vector>

#include "render/fairing.h"
#include "render/skin.h"

namespace render {

// What is returned holds until `kept` other surfaces have been asked for, the values until another field of the same surface is.
class SkinCache {
 public:
  static constexpr std::size_t kept = 24;  // a comparison of three runs shows 15
  // What is drawn for a surface: its middle, faired and smoothed, with its skin on both sides. `field` < 0: the values mean nothing. As
  // many of its levels of smoothing are used as its edges' mean length in pixels asks for.
  const DrawnMesh& drawn(const Surface& surface, int field, float pixels_per_metre);
  // The skin's middle: positions and triangles alone.
  const DrawnMesh& middle(const Surface& surface, float pixels_per_metre);
  // The outline of a skin: segments half its thickness beyond the border of its middle.
  const std::vector<std::array<Eigen::Vector3f, 2>>& rim(const Surface& surface, float pixels_per_metre);
  // The border of the surface's own triangles.
  const Border& border(const Surface& surface);

 private:
  // How the triangles hang together at each level of subdivision, from the surface's own to the drawn one.
  struct Levels {
    std::vector<Topology> each;
    Followed followed;
  };
  struct Entry {
    Surface surface;            // without its fields; its smoothing is what was used
    std::vector<float> values;  // the field that skin.mesh.values shows; empty: none yet
    std::shared_ptr<const Levels> levels;
    DrawnMesh middle;
    Skin skin;
    std::vector<std::array<Eigen::Vector3f, 2>> rim;
  };
  std::shared_ptr<const Levels> levels_of(const Surface& surface, int smoothing);
  Entry make_entry(const Surface& surface, int smoothing);
  Entry& entry_of(const Surface& surface, int smoothing);

  std::list<Entry> entries_;  // the one used last in front
  std::list<std::shared_ptr<const Levels>> levels_;
};

// The levels of smoothing, at most the surface's own, after which its edges are `longest_edge` pixels or less in the mean.
inline constexpr float longest_edge = 8;
int levels_needed(const Surface& surface, float pixels_per_metre);

}  // namespace render
