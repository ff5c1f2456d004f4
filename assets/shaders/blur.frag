#version 330 core
// The mean of ambient occlusion over 4 x 4, the period of its sampling pattern, at its own half size.
uniform sampler2D occlusion;
out vec4 open_sky;

void main() {
  ivec2 corner = ivec2(gl_FragCoord.xy) - 1, last = textureSize(occlusion, 0) - 1;
  float sum = 0.0;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) sum += texelFetch(occlusion, clamp(corner + ivec2(x, y), ivec2(0), last), 0).r;
  open_sky = vec4(sum / 16.0);
}
