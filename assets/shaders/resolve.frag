#version 330 core
// The finished picture from the drawn one: the mean of scale x scale pixels, or at scale 1 edges smoothed along their direction
// (Lottes 2009, FXAA, in its short form).
uniform sampler2D drawn;
uniform int scale;
uniform bool smooth_edges;
out vec4 color;

float luma(vec3 rgb) { return dot(rgb, vec3(0.299, 0.587, 0.114)); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (scale > 1) {
    vec4 sum = vec4(0);
    for (int y = 0; y < scale; ++y)
      for (int x = 0; x < scale; ++x) sum += texelFetch(drawn, scale * pixel + ivec2(x, y), 0);
    color = sum / float(scale * scale);
    return;
  }
  vec4 middle = texelFetch(drawn, pixel, 0);
  color = middle;
  if (!smooth_edges) return;
  ivec2 last = textureSize(drawn, 0) - 1;
  float nw = luma(texelFetch(drawn, clamp(pixel + ivec2(-1, 1), ivec2(0), last), 0).rgb);
  float ne = luma(texelFetch(drawn, clamp(pixel + ivec2(1, 1), ivec2(0), last), 0).rgb);
  float sw = luma(texelFetch(drawn, clamp(pixel + ivec2(-1, -1), ivec2(0), last), 0).rgb);
  float se = luma(texelFetch(drawn, clamp(pixel + ivec2(1, -1), ivec2(0), last), 0).rgb);
  float m = luma(middle.rgb);
  float darkest = min(m, min(min(nw, ne), min(sw, se))), lightest = max(m, max(max(nw, ne), max(sw, se)));
  if (lightest - darkest < max(0.03, 0.1 * lightest)) return;
  vec2 along = vec2((sw + se) - (nw + ne), (ne + se) - (nw + sw));  // across the gradient
  float reduce = max((nw + ne + sw + se) * 0.03125, 0.0078125);
  along = clamp(along / (min(abs(along.x), abs(along.y)) + reduce), -8.0, 8.0);
  vec2 texel = 1.0 / vec2(last + 1), here = (vec2(pixel) + 0.5) * texel;
  vec3 near = 0.5 * (texture(drawn, here + along * (1.0 / 3.0 - 0.5) * texel).rgb + texture(drawn, here + along * (2.0 / 3.0 - 0.5) * texel).rgb);
  vec3 wide = 0.5 * near + 0.25 * (texture(drawn, here - 0.5 * along * texel).rgb + texture(drawn, here + 0.5 * along * texel).rgb);
  float w = luma(wide);
  color = vec4(w < darkest || w > lightest ? near : wide, middle.a);
}
