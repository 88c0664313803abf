// The level of Eq. 1 (removal_level.glsl) between the squares of the coarse map, so that it does not jump at their
// borders.
layout(binding = UNIT_INPUT + REMOVAL_LEVEL_INPUT) uniform sampler2D removal_level;

uniform int coarse_level;

float level_at(ivec2 pixel) {
  vec2 square = (vec2(pixel) + 0.5) / float(1 << coarse_level) - 0.5;
  ivec2 low = ivec2(floor(square)), last = textureSize(removal_level, 0) - 1;
  ivec2 lo = clamp(low, ivec2(0), last), hi = clamp(low + 1, ivec2(0), last);
  vec2 t = square - vec2(low);
  return mix(mix(texelFetch(removal_level, lo, 0).x, texelFetch(removal_level, ivec2(hi.x, lo.y), 0).x, t.x),
             mix(texelFetch(removal_level, ivec2(lo.x, hi.y), 0).x, texelFetch(removal_level, hi, 0).x, t.x), t.y);
}
