#version 330 core
// What is seen where nothing is.
uniform vec2 size;
uniform vec3 background_top, background_bottom;
out vec4 color;  // a: 0 where nothing was drawn

void main() { color = vec4(mix(background_bottom, background_top, gl_FragCoord.y / size.y), 0); }
