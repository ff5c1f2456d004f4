#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;     // a = opacity seen face on
layout(location = 3) in float clipped;  // 1: the clip plane cuts it
uniform mat4 view, projection;
out vec3 view_point, surface_normal;
out vec4 surface_color;
flat out float is_clipped;

void main() {
  vec4 point = view * vec4(position, 1);
  view_point = point.xyz;
  surface_normal = mat3(view) * normal;
  surface_color = color;
  is_clipped = clipped;
  gl_Position = projection * point;
}
