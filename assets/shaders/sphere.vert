#version 330 core
// A square facing the eye that covers a sphere; four vertices a sphere. Lengths in metres, view space.
layout(location = 0) in vec4 sphere;  // centre, radius
layout(location = 1) in vec4 color;
uniform mat4 view, projection;
uniform bool perspective;
out vec3 on_square;
flat out vec4 center_radius;
flat out vec3 sphere_color;

void main() {
  int corner = gl_VertexID & 3;
  vec2 side = vec2(corner == 1 || corner == 2 ? 1 : -1, corner >= 2 ? 1 : -1);
  vec3 center = (view * vec4(sphere.xyz, 1)).xyz;
  float radius = sphere.w;
  vec3 right = vec3(1, 0, 0), up = vec3(0, 1, 0);
  if (perspective) {  // across the line of sight, and as much larger as the tangent cone is there
    vec3 sight = normalize(center);
    right = normalize(cross(sight, vec3(0, 1, 0)));
    up = cross(right, sight);
    float ratio = min(radius / length(center), 0.9);
    radius *= inversesqrt(1 - ratio * ratio);
  }
  on_square = center + radius * (side.x * right + side.y * up);
  center_radius = vec4(center, sphere.w);
  sphere_color = color.rgb;
  gl_Position = projection * vec4(on_square, 1);
}
