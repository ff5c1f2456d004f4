#version 330 core
// Adds weight and weighted value: the Shepard mean of the particles with the kernel (1 - q^2)^2.
in vec2 place;
flat in float height2;
flat in float value;
out vec4 sums;

void main() {
  float q2 = dot(place, place) + height2;
  if (q2 >= 1.0) discard;
  float weight = (1.0 - q2) * (1.0 - q2);
  sums = vec4(weight, weight * value, 0, 0);
}
