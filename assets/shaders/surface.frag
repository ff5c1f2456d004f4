#version 330 core
// An opaque surface, lit later.
in vec3 view_point, surface_normal;
in float table_place;
uniform bool perspective, clip_on, by_table;
uniform vec4 clip_plane;
uniform vec3 plain_color;
uniform sampler2D color_table;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 view_normal;

void main() {
  if (clip_on && dot(clip_plane, vec4(view_point, 1)) > 0) discard;
  vec3 toward_eye = perspective ? -normalize(view_point) : vec3(0, 0, 1);
  vec3 normal = normalize(surface_normal);
  if (dot(normal, toward_eye) < 0) normal = -normal;
  float columns = float(textureSize(color_table, 0).x);
  vec3 color = by_table ? texture(color_table, vec2((clamp(table_place, 0.0, 1.0) * (columns - 1.0) + 0.5) / columns, 0.5)).rgb : plain_color;
  albedo = vec4(color, 1);
  view_normal = vec4(0.5 * normal + 0.5, 1);
}
