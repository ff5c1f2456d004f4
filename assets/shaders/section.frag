#version 330 core
// The cut face from the sums in its plane: the mean value by colour, unlit, where enough particles are near; at the plane's own depth.
uniform sampler2D sums, color_table, inside;
uniform mat4 projection;
uniform vec2 size, unproject, middle;  // pixels; view-space half size; place of the optical axis, -1 ... 1
uniform vec4 clip_plane;
uniform vec3 corner, along, across;  // of the sums: place of their corner, and their directions over their sizes
uniform bool perspective, by_table, masked;
uniform vec3 plain_color;
uniform float enough;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 view_normal;

void main() {
  if (masked && texelFetch(inside, ivec2(gl_FragCoord.xy), 0).r < 0.5) discard;
  vec2 ndc = 2.0 * gl_FragCoord.xy / size - 1.0 - middle;
  vec3 origin = perspective ? vec3(0) : vec3(ndc * unproject, 0);
  vec3 sight = perspective ? normalize(vec3(ndc * unproject, -1)) : vec3(0, 0, -1);
  float slope = dot(clip_plane.xyz, sight);
  if (slope > -1e-6) discard;  // the face looks away
  vec3 point = origin - sight * dot(clip_plane, vec4(origin, 1)) / slope;
  vec2 place = vec2(dot(point - corner, along), dot(point - corner, across));
  if (any(notEqual(place, clamp(place, 0.0, 1.0)))) discard;
  vec2 sum = texture(sums, place).rg;
  if (sum.x < enough) discard;
  float columns = float(textureSize(color_table, 0).x);
  float t = clamp(sum.y / sum.x, 0.0, 1.0);
  albedo = vec4(by_table ? texture(color_table, vec2((t * (columns - 1.0) + 0.5) / columns, 0.5)).rgb : plain_color, 0.5);
  view_normal = vec4(0.5 * clip_plane.xyz + 0.5, 1);
  vec4 clip = projection * vec4(point, 1);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
}
