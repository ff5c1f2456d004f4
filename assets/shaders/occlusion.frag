#version 330 core
// Ambient occlusion from the depth buffer at half size: how much of the sky over a point is hidden by what is near it
// (McGuire et al. 2011, "The Alchemy screen-space ambient obscurance algorithm", the estimator of its Eq 10).
uniform sampler2D depth, normals, albedo;
uniform vec2 unproject;  // view-space half size at unit depth (perspective) or at all depths (orthographic)
uniform vec2 middle;     // place of the optical axis, -1 ... 1
uniform vec2 size;       // pixels of the full picture
uniform float near, far, radius, pixels_per_metre;
uniform bool perspective;
out vec4 open_sky;
const int samples = 10;

float view_depth(float d) { return perspective ? near * far / (far - d * (far - near)) : near + d * (far - near); }
vec3 view_point(ivec2 pixel) {
  float z = view_depth(texelFetch(depth, pixel, 0).r);
  vec2 xy = (2.0 * (vec2(pixel) + 0.5) / size - 1.0 - middle) * unproject * (perspective ? z : 1.0);
  return vec3(xy, -z);
}

void main() {
  ivec2 half_pixel = ivec2(gl_FragCoord.xy), pixel = 2 * half_pixel;
  if (texelFetch(albedo, pixel, 0).a < 0.75) {  // background, and cut faces that must keep their colour
    open_sky = vec4(1);
    return;
  }
  vec3 point = view_point(pixel);
  vec3 normal = normalize(2.0 * texelFetch(normals, pixel, 0).xyz - 1.0);
  float reach = radius * pixels_per_metre * (perspective ? 1.0 / -point.z : 1.0);
  float turn = 0.3927 * float((half_pixel.x & 3) * 4 + (half_pixel.y & 3) * 5);
  float hidden = 0.0;
  for (int i = 0; i < samples; ++i) {
    float part = (float(i) + 0.5) / float(samples);
    float angle = turn + 6.2832 * 3.0 * part;
    ivec2 other = clamp(pixel + ivec2(reach * part * vec2(cos(angle), sin(angle))), ivec2(0), ivec2(size) - 1);
    vec3 toward = view_point(other) - point;
    float distance2 = dot(toward, toward);
    if (distance2 < 4.0 * radius * radius) hidden += max(0.0, dot(toward, normal) - 0.04 * radius) / (distance2 + 0.02 * radius * radius);
  }
  open_sky = vec4(clamp(1.0 - 1.1 * radius * hidden / float(samples), 0.0, 1.0));
}
