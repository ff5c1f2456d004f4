#version 330 core
// Sphere by ray: colour, normal and true depth. A sphere that the clip plane cuts shows its cut face; faces that overlap are parted half way
// between the centres (the nearer centre wins by a small bias of depth), so that a cut body of particles shows no gaps and no flicker.
in vec3 on_square;
flat in vec4 center_radius;
flat in vec3 sphere_color;
uniform mat4 projection;
uniform bool perspective, disc, clip_on;
uniform vec4 clip_plane;  // view space; positive side is cut away
layout(location = 0) out vec4 albedo;       // a: 0 background, 0.5 unlit, 1 lit
layout(location = 1) out vec4 view_normal;  // 0.5 n + 0.5

void main() {
  vec3 center = center_radius.xyz;
  float radius = center_radius.w;
  vec3 point, normal;
  float lit = 1, push = 0;
  if (disc) {
    vec3 offset = on_square - center;
    float distance2 = dot(offset, offset);
    if (distance2 > radius * radius) discard;
    point = center;
    push = radius * distance2 / (radius * radius);
    normal = vec3(0, 0, 1);
    lit = 0.5;
  } else {
    vec3 origin = perspective ? vec3(0) : vec3(on_square.xy, 0);
    vec3 sight = perspective ? normalize(on_square) : vec3(0, 0, -1);
    vec3 offset = origin - center;
    float b = dot(offset, sight);
    vec3 across = offset - b * sight;  // from the centre to the ray; avoids the cancellation of b^2 - (|offset|^2 - r^2)
    float inside = radius * radius - dot(across, across);
    if (inside < 0) discard;
    point = origin + (-b - sqrt(inside)) * sight;
    normal = (point - center) / radius;
    if (clip_on && dot(clip_plane, vec4(point, 1)) > 0) {
      float slope = dot(clip_plane.xyz, sight);
      if (slope > -1e-6) discard;  // seen from the side that is kept
      point = origin - sight * dot(clip_plane, vec4(origin, 1)) / slope;
      vec3 from_center = point - center;
      float distance2 = dot(from_center, from_center);
      if (distance2 > radius * radius) discard;
      normal = clip_plane.xyz;
      push = 0.25 * distance2 / radius;
      lit = 0.5;
    }
  }
  albedo = vec4(sphere_color, lit);
  view_normal = vec4(0.5 * normal + 0.5, 1);
  vec4 clip = projection * vec4(point.xy, point.z - push, 1);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
}
