#version 330 core
// A translucent surface, premultiplied; drawn from back to front. More opaque where it is seen edge on, so that its shape is read.
in vec3 view_point, surface_normal;
in vec4 surface_color;
flat in float is_clipped;
uniform bool perspective, clip_on;
uniform vec4 clip_plane;
out vec4 color;

void main() {
  if (clip_on && is_clipped > 0.5 && dot(clip_plane, vec4(view_point, 1)) > 0) discard;
  vec3 toward_eye = perspective ? -normalize(view_point) : vec3(0, 0, 1);
  vec3 normal = normalize(surface_normal);
  float facing = abs(dot(normal, toward_eye));
  if (dot(normal, toward_eye) < 0) normal = -normal;
  float edge = (1 - facing) * (1 - facing);
  float opacity = mix(surface_color.a, min(1.0, 2.5 * surface_color.a + 0.15), edge);
  float light = 0.62 + 0.38 * max(dot(normal, normalize(vec3(-0.35, 0.5, 0.8))), 0.0);
  vec3 halfway = normalize(normalize(vec3(-0.35, 0.5, 0.8)) + toward_eye);
  float shine = 0.25 * pow(max(dot(normal, halfway), 0.0), 60.0);
  color = vec4(surface_color.rgb * light * opacity + vec3(shine), min(1.0, opacity + shine));
}
