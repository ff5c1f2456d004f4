#version 330 core
layout(location = 0) in vec3 place;   // normalised device coordinates
layout(location = 1) in vec4 color;
layout(location = 2) in vec3 across;  // pixels along and across from the segment's start; z = its length in pixels
out vec4 line_color;
out vec3 pixels;

void main() {
  line_color = color;
  pixels = across;
  gl_Position = vec4(place, 1);
}
