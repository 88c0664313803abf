// How open the surroundings are, between squares of 8x8 px: that of single points is noise.
layout(binding = UNIT_INPUT + 7) uniform sampler2D coarse_openness;  // and 1 where there is a surface, else 0
const float coarse_px = 8.0;

float openness_at(vec2 pixel) {
  vec2 at = pixel / coarse_px - 0.5, t = fract(at);
  ivec2 low = ivec2(floor(at)), last = textureSize(coarse_openness, 0) - 1;
  float sum = 0.0, weights = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 corner = ivec2(k & 1, k >> 1);
    vec2 open = texelFetch(coarse_openness, clamp(low + corner, ivec2(0), last), 0).xy;
    vec2 w = mix(1.0 - t, t, vec2(corner)) * open.y;
    sum += w.x * w.y * open.x;
    weights += w.x * w.y;
  }
  return weights > 0.0 ? sum / weights : 1.0;
}
