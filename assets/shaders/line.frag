#version 330 core
// A line with round ends and soft edges, premultiplied.
in vec4 line_color;
in vec3 pixels;
uniform float half_width;  // pixels
out vec4 color;

void main() {
  float along = pixels.x - clamp(pixels.x, 0.0, pixels.z);
  float cover = clamp(half_width + 0.5 - length(vec2(along, pixels.y)), 0.0, 1.0) * line_color.a;
  if (cover <= 0.0) discard;
  color = vec4(line_color.rgb * cover, cover);
}
