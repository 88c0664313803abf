// Running sums to albedo, depth and normal for the shading pass.
//   PAINT_NEAREST   instead of sums the one nearest fragment
//   PAINT_LISTED    the same from the lists of fragments
#include "frame.glsl"
#if defined(PAINT_NEAREST) || defined(PAINT_LISTED)
#include "techniques/strokes/paint.glsl"
#endif
#if defined(PAINT_NEAREST)
layout(binding = UNIT_INPUT + 1) uniform usampler2D nearest;
uvec4 nearest_fragment(ivec2 pixel) { return uvec4(0u, texelFetch(nearest, pixel, 0).xy, no_fragment); }
#elif defined(PAINT_LISTED)
layout(binding = UNIT_INPUT + 1) uniform usampler2D heads;
layout(binding = UNIT_INPUT + 2) uniform usamplerBuffer fragments;
uvec4 nearest_fragment(ivec2 pixel) {
  uvec4 nearest = uvec4(no_fragment);
  for (uint k = texelFetch(heads, pixel, 0).x; k != no_fragment;) {
    uvec4 fragment = texelFetch(fragments, int(k));
    k = fragment.w;
    // As opaque as the pass that draws nothing else asks for (stroke.frag), and of equals the stroke that it draws first.
    bool nearer = fragment.x < nearest.x || (fragment.x == nearest.x && fragment.y < nearest.y);
    if (nearer && fragment_alpha(fragment) >= 0.5) nearest = fragment;
  }
  return nearest;
}
#else
layout(binding = UNIT_INPUT) uniform sampler2D sum_color;
layout(binding = UNIT_INPUT + 1) uniform sampler2D sum_normal;
layout(binding = UNIT_INPUT + 2) uniform sampler2D sum_rest;
#endif

uniform vec2 even_light;  // ambient and diffuse of paint that light falls straight on everywhere; 1 0 where shading follows

bool filter_pixel(ivec2 pixel) {
#if defined(PAINT_NEAREST) || defined(PAINT_LISTED)
  uvec4 fragment = nearest_fragment(pixel);
  vec4 color = vec4(0.0, 0.0, 0.0, 1.0), normal = vec4(0.0);
  float t = 0.0;
  if (fragment.y != no_fragment) {
    Paint p = paint_of(fragment, pixel);
    color = vec4(p.color, 0.0);
    normal = vec4(p.normal, p.shadow);
    t = p.t;
  }
#else
  vec4 color = texelFetch(sum_color, pixel, 0), normal = texelFetch(sum_normal, pixel, 0);
  float t = texelFetch(sum_rest, pixel, 0).x;
#endif
  float weight = 1.0 - color.a;
  out_0 = vec4(0.0);
  out_1 = vec4(infinity);
  out_2 = vec4(0.0, 0.0, 0.0, 1.0);
  if (weight <= 0.0) return true;
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  vec3 n = transpose(mat3(frame.eye_from_cloud)) * normal.xyz;
  float size = length(n);
  // What is left of the light below half a percent is not worth another stroke: the pixel counts as covered.
  float alpha = color.a < 0.005 ? 1.0 : weight;
  float shadow = normal.w / weight;
  out_0 = vec4(color.rgb * (alpha / weight) * (even_light.x + even_light.y * shadow), alpha);
  out_1 = vec4(t / weight / length(slope));
  out_2 = vec4(size > 1e-3 * weight ? n / size : vec3(0.0), shadow);
  return true;
}
