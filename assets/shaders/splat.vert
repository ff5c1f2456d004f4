#version 330 core
// A square in the clip plane round each particle near it, on which its value is spread.
layout(location = 0) in vec4 particle;  // centre m, value 0 ... 1 along the colour table
uniform mat4 view, projection;
uniform vec4 clip_plane;  // view space
uniform float reach;      // m
out vec2 place;           // in the plane, in units of reach
flat out float height2;   // squared distance from the plane, in units of reach squared
flat out float value;

void main() {
  int corner = gl_VertexID & 3;
  vec2 side = vec2(corner == 1 || corner == 2 ? 1 : -1, corner >= 2 ? 1 : -1);
  vec3 center = (view * vec4(particle.xyz, 1)).xyz;
  float height = dot(clip_plane, vec4(center, 1));
  vec3 right = normalize(cross(abs(clip_plane.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0), clip_plane.xyz));
  vec3 up = cross(clip_plane.xyz, right);
  vec3 point = center - height * clip_plane.xyz + reach * (side.x * right + side.y * up);
  place = side;
  height2 = height * height / (reach * reach);
  value = particle.w;
  gl_Position = projection * vec4(point, 1);
}
