#version 330 core
// Triangles from one corner of a closed outline to each of its segments: where an odd number of them lies is inside.
layout(location = 0) in vec3 place;  // m
uniform mat4 view, projection;

void main() { gl_Position = projection * view * vec4(place, 1); }
