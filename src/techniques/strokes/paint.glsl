// A stored fragment back to paint: colour, relief, shadow.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform usamplerBuffer strokes;
uniform float relief;

struct Paint {
  vec3 color;
  float alpha;
  vec3 normal;  // eye, facing the camera, bent by the relief
  float shadow;
  float t;
};

Paint paint_of(uvec4 fragment, ivec2 pixel) {
  int at = 6 * int(fragment.y);
  vec4 normal = uintBitsToFloat(texelFetch(strokes, at + 3));
  vec4 color = uintBitsToFloat(texelFetch(strokes, at + 4));
  Paint p;
  p.color = color.rgb;
  p.shadow = color.a;
  p.alpha = unpackUnorm2x16(fragment.w).x;
  p.t = uintBitsToFloat(fragment.z);
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  p.normal = dot(normal.xyz, slope) > 0.0 ? -normal.xyz : normal.xyz;
  if (relief > 0.0) {
    vec2 rise = unpackSnorm4x8(fragment.w).zw * relief * 5.0;
    vec3 along = normalize(uintBitsToFloat(texelFetch(strokes, at + 1).xyz));
    vec3 across = normalize(uintBitsToFloat(texelFetch(strokes, at + 2).xyz));
    p.normal = normalize(p.normal - rise.x * along - rise.y * across);
  }
  return p;
}
