#include "render/colormap.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace render {
namespace {

using Coefficients = std::array<std::array<double, 3>, 7>;

// Sixth-degree fits to matplotlib's maps (CC0), by M. Zucker (public domain); error below 0.01 of the full range.
constexpr Coefficients viridis_fit = {{{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                                       {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                                       {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                                       {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                                       {6.228269936347081, 14.17993336680509, 56.69055260068105},
                                       {4.776384997670288, -13.74514537774601, -65.35303263337234},
                                       {-5.435455855934631, 4.645852612178535, 26.3124352495832}}};
constexpr Coefficients inferno_fit = {{{0.0002189403691192265, 0.001651004631001012, -0.01948089843709184},
                                       {0.1065134194856116, 0.5639564367884091, 3.932712388889277},
                                       {11.60249308247187, -3.972853965665698, -15.9423941062914},
                                       {-41.70399613139459, 17.43639888205313, 44.35414519872813},
                                       {77.162935699427, -33.40235894210092, -81.80730925738993},
                                       {-71.31942824499214, 32.62606426397723, 73.20951985803202},
                                       {25.13112622477341, -12.24266895238567, -23.07032500287172}}};
constexpr Coefficients plasma_fit = {{{0.05873234392399702, 0.02333670892565664, 0.5433401826748754},
                                      {2.176514634195958, 0.2383834171260182, 0.7539604599784036},
                                      {-2.689460476458034, -7.455851135738909, 3.110799939717086},
                                      {6.130348345893603, 42.3461881477227, -28.51885465332158},
                                      {-11.10743619062271, -82.66631109428045, 60.13984767418263},
                                      {10.02306557647065, 71.41361770095349, -54.07218655560067},
                                      {-3.658713842777788, -22.93153465461149, 18.19190778539828}}};
// Fifth-degree fit to cividis (Nunez, Anderton, Renslow 2018), as used by d3-scale-chromatic (ISC); here divided by 255.
constexpr Coefficients cividis_fit = {{{-4.54 / 255, 32.49 / 255, 81.24 / 255},
                                       {-35.34 / 255, 170.73 / 255, 442.36 / 255},
                                       {2381.73 / 255, 52.82 / 255, -2482.43 / 255},
                                       {-6402.7 / 255, -131.46 / 255, 6167.24 / 255},
                                       {7024.72 / 255, 176.58 / 255, -6614.94 / 255},
                                       {-2710.57 / 255, -67.37 / 255, 2475.67 / 255},
                                       {0, 0, 0}}};

Color polynomial(const Coefficients& c, double t) {
  Color result;
  for (int k = 0; k < 3; ++k) {
    double value = 0;
    for (int power = 6; power >= 0; --power) value = value * t + c[power][k];
    result[k] = static_cast<float>(std::clamp(value, 0.0, 1.0));
  }
  return result;
}

double to_srgb(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055; }
double to_linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

// CIELAB to sRGB, D65, cut to the gamut.
Color lab_to_srgb(double l, double a, double b) {
  const auto inverse = [](double f) { return f > 6.0 / 29 ? f * f * f : 3 * 36.0 / 841 * (f - 4.0 / 29); };
  const double fy = (l + 16) / 116;
  const double x = 0.95047 * inverse(fy + a / 500), y = inverse(fy), z = 1.08883 * inverse(fy - b / 200);
  const std::array<double, 3> linear = {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                                        0.0557 * x - 0.2040 * y + 1.0570 * z};
  Color color;
  for (int k = 0; k < 3; ++k) color[k] = static_cast<float>(std::clamp(to_srgb(std::clamp(linear[k], 0.0, 1.0)), 0.0, 1.0));
  return color;
}

// Two straight arms in CIELAB from a light middle: blue to one side, orange to the other, equal in lightness. Blue and orange stay apart
// in all common colour blindnesses; red and green would not.
Color diverging(double t) {
  const double s = 2 * t - 1, strength = std::abs(s);
  const double l = 94 - 52 * strength;
  const double hue = s < 0 ? 4.75 : 0.95, chroma = 58 * strength;  // rad
  return lab_to_srgb(l, chroma * std::cos(hue), chroma * std::sin(hue));
}

struct Named {
  const char* name;
  Colormap map;
};
constexpr std::array<Named, 5> names = {{{"viridis", Colormap::viridis},
                                         {"inferno", Colormap::inferno},
                                         {"plasma", Colormap::plasma},
                                         {"cividis", Colormap::cividis},
                                         {"diverging", Colormap::diverging}}};

}  // namespace

Color map_color(Colormap map, double t) {
  if (std::isnan(t)) return Color(0.5f, 0.5f, 0.5f);
  t = std::clamp(t, 0.0, 1.0);
  switch (map) {
    case Colormap::viridis:
      return polynomial(viridis_fit, t);
    case Colormap::inferno:
      return polynomial(inferno_fit, 0.14 + 0.86 * t);  // not from black: shading must stay visible
    case Colormap::plasma:
      return polynomial(plasma_fit, t);
    case Colormap::cividis:
      return polynomial(cividis_fit, t);
    case Colormap::diverging:
      return diverging(t);
  }
  return Color(0.5f, 0.5f, 0.5f);
}

std::vector<std::array<std::uint8_t, 3>> color_table(Colormap map, int count) {
  std::vector<std::array<std::uint8_t, 3>> table(count);
  for (int i = 0; i < count; ++i) {
    const Color color = map_color(map, count > 1 ? static_cast<double>(i) / (count - 1) : 0);
    for (int k = 0; k < 3; ++k) table[i][k] = static_cast<std::uint8_t>(std::lround(255 * color[k]));
  }
  return table;
}

Colormap colormap_by_name(std::string_view name) {
  std::string known;
  for (const Named& each : names) {
    if (name == each.name) return each.map;
    known += (known.empty() ? "" : ", ") + std::string(each.name);
  }
  throw std::invalid_argument("unknown colour map '" + std::string(name) + "': use one of " + known);
}

std::vector<std::string> colormap_names() {
  std::vector<std::string> result;
  for (const Named& each : names) result.emplace_back(each.name);
  return result;
}

double lightness(const Color& color) {
  const double y = 0.2126729 * to_linear(color[0]) + 0.7151522 * to_linear(color[1]) + 0.0721750 * to_linear(color[2]);
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

}  // namespace render
