// The brush on a stroke's plane, met by the ray of the pixel.
//   STROKE_OPAQUE   the nearest opaque fragment of every pixel, by the depth test
//   STROKE_COUNT    how many fragments lie before it, by additive blending
//   STROKE_STORE    those fragments into the lists of their pixels
//   STROKE_NEAREST  the nearest fragment, by the depth test: stroke and paint
//   FRAGMENT_ORDER  fragments by their own distance, not whole strokes by theirs: depths are those of fragments
#include "frame.glsl"
#if defined(STROKE_STORE) && !defined(FRAGMENT_ORDER)
layout(early_fragment_tests) in;  // what is hidden is not stored
#endif

flat in int stroke;
flat in vec4 stroke_look;
flat in vec2 stroke_tile;
in vec3 stroke_at;

layout(binding = UNIT_INPUT + 1) uniform sampler2D brush;

#ifdef FRAGMENT_ORDER
#include "techniques/strokes/stroke_plane.glsl"
flat in vec3 stroke_center;
flat in vec4 stroke_normal;
#if defined(STROKE_COUNT) || defined(STROKE_STORE)
layout(binding = UNIT_INPUT + 2) uniform sampler2D opaque_depth;
#endif
#endif
#ifdef STROKE_STORE
layout(std430, binding = 0) buffer Stored { uint stored; };
layout(r32ui, binding = IMAGE_FRAGMENT_CURSOR) uniform uimage2D heads;
layout(rgba32ui, binding = IMAGE_FRAGMENTS) writeonly uniform uimageBuffer fragments;
uniform ivec2 rows;  // [first, last) of this band
uniform uint fragment_room;
#elif defined(STROKE_NEAREST)
layout(location = 0) out uvec2 out_fragment;
#elif defined(STROKE_COUNT)
layout(location = 0) out vec4 out_value;
#endif

uint pack_paint(float alpha, vec2 slope) {
  return (packUnorm2x16(vec2(alpha, 0.0)) & 0xffffu) | (packSnorm4x8(vec4(0.0, 0.0, 2.0 * slope)) & 0xffff0000u);
}

void main() {
  vec2 pixel = gl_FragCoord.xy;
#ifdef STROKE_STORE
  if (int(pixel.y) < rows.x || int(pixel.y) >= rows.y) discard;
#endif
  if (stroke_at.z < 1e-4 * frame.far_plane) discard;
#ifdef FRAGMENT_ORDER
  float z = max(plane_distance(pixel, stroke_center, stroke_normal.xyz) - stroke_normal.w, 0.0);
#if defined(STROKE_COUNT) || defined(STROKE_STORE)
  // As in stroke.vert, a trace nearer.
  float trace = z * (1.0 - 1e-5);
  if (trace / (trace + frame.far_plane) > texelFetch(opaque_depth, ivec2(pixel), 0).x) discard;
#else
  gl_FragDepth = z / (z + frame.far_plane);
#endif
#else
  float z = stroke_look.x;
#endif
  vec2 at = (stroke_tile + clamp(0.5 + 0.5 * stroke_at.xy, stroke_look.w, 1.0 - stroke_look.w)) / 8.0;
  vec4 paint = textureLod(brush, at, stroke_look.z);
  float alpha = paint.x * stroke_look.y;

#if defined(STROKE_OPAQUE)
  // A trace more than ends the mixing (sort_blend.glsl), for what the quads of two programs differ by.
  if (alpha < 0.9951) discard;
#elif defined(STROKE_COUNT)
  if (alpha < 0.004) discard;
  out_value = vec4(1.0);
#elif defined(STROKE_STORE)
  if (alpha < 0.004) discard;
  uint place = atomicAdd(stored, 1u);
  if (place < fragment_room) {
    uint next = imageAtomicExchange(heads, ivec2(pixel), place);
    imageStore(fragments, int(place), uvec4(floatBitsToUint(z), uint(stroke), pack_paint(alpha, paint.zw), next));
  }
#else
  if (alpha < 0.5) discard;
  out_fragment = uvec2(stroke, pack_paint(alpha, paint.zw));
#endif
}
