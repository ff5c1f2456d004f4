#version 330 core
// Blended as source x (1 - destination): each triangle turns what it covers over.
out vec4 inside;

void main() { inside = vec4(1); }
