#version 330 core
layout(location = 0) in vec3 position;  // m
layout(location = 1) in vec3 normal;
layout(location = 2) in float value;    // 0 ... 1 along the colour table
uniform mat4 view, projection;
out vec3 view_point, surface_normal;
out float table_place;

void main() {
  vec4 point = view * vec4(position, 1);
  view_point = point.xyz;
  surface_normal = mat3(view) * normal;
  table_place = value;
  gl_Position = projection * point;
}
