#version 330 core
// Lights what the opaque passes left: colour, normal, depth. Shading stays gentle, for the colour carries the number.
uniform sampler2D albedo, normals, occlusion;
uniform bool occlusion_on;
out vec4 color;  // a: 0 where nothing was drawn

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 base = texelFetch(albedo, pixel, 0);
  if (base.a < 0.25) discard;  // the background stands
  if (base.a < 0.75) {
    color = vec4(base.rgb, 1);
    return;
  }
  vec3 normal = normalize(2.0 * texelFetch(normals, pixel, 0).xyz - 1.0);
  float open_sky = 1.0;
  // At half size; each of its pixels is the mean of 4 x 4 whose middle lies half a pixel beyond its own.
  if (occlusion_on) open_sky = texture(occlusion, (0.5 * gl_FragCoord.xy - 0.5) / vec2(textureSize(occlusion, 0))).r;
  vec3 lamp = normalize(vec3(-0.35, 0.5, 0.8));
  float diffuse = max(dot(normal, lamp), 0.0);
  float sky = 0.5 + 0.5 * normal.y;
  float shine = 0.07 * pow(max(dot(normal, normalize(lamp + vec3(0, 0, 1))), 0.0), 25.0);
  float light = (0.58 + 0.08 * sky + 0.38 * diffuse) * mix(0.25, 1.0, open_sky);
  color = vec4(min(base.rgb * light + vec3(shine * open_sky), vec3(1)), 1);
}
