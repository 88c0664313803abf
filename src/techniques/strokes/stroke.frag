// The brush on a stroke's plane, met by the ray of the pixel.
//   STROKE_OPAQUE   the nearest opaque fragment of every pixel, by the depth test
//   STROKE_COUNT    how many fragments lie before it, by additive blending
//   STROKE_STORE    those fragments into the lists of their pixels
//   STROKE_NEAREST  the nearest fragment, by the depth test
//   FRAGMENT_ORDER  fragments by their own distance, not whole strokes by theirs: depths are those of fragments
#include "frame.glsl"
#if defined(STROKE_STORE) && !defined(FRAGMENT_ORDER)
layout(early_fragment_tests) in;  // what is hidden is not stored
#endif

flat in int stroke;
flat in vec4 stroke_center_key;
flat in vec4 stroke_u;
flat in vec4 stroke_v;
flat in vec4 stroke_normal;
flat in vec2 stroke_tile;

layout(binding = UNIT_INPUT + 1) uniform sampler2D brush;

#if defined(FRAGMENT_ORDER) && (defined(STROKE_COUNT) || defined(STROKE_STORE))
layout(binding = UNIT_INPUT + 2) uniform sampler2D opaque_depth;
#endif
#ifdef STROKE_STORE
layout(binding = UNIT_INPUT + 3) uniform usampler2D offsets;
layout(r32ui, binding = 0) uniform uimage2D cursors;
layout(rgba32ui, binding = 1) writeonly uniform uimageBuffer fragments;
uniform ivec2 rows;  // [first, last) of this band
uniform uint fragment_room;
#elif defined(STROKE_NEAREST)
layout(location = 0) out uvec4 out_fragment;
#elif defined(STROKE_COUNT)
layout(location = 0) out vec4 out_value;
#endif

uint pack_paint(float alpha, vec2 slope) {
  return (packUnorm2x16(vec2(alpha, 0.0)) & 0xffffu) | (packSnorm4x8(vec4(0.0, 0.0, 2.0 * slope)) & 0xffff0000u);
}

void main() {
#ifdef STROKE_STORE
  int row = int(gl_FragCoord.y);
  if (row < rows.x || row >= rows.y) discard;
#endif
  vec2 pixel = gl_FragCoord.xy;
  vec3 center = stroke_center_key.xyz;
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(pixel, 1.0);
  vec3 sideways = vec3(eye_from_pixel(pixel, -center.z).xy - center.xy, 0.0);
  float behind = -dot(stroke_normal.xyz, sideways) / dot(stroke_normal.xyz, slope);
  vec3 offset = sideways + behind * slope;
  float depth = behind - center.z;
  vec2 uv = vec2(dot(offset, stroke_u.xyz), dot(offset, stroke_v.xyz));
  if (!(max(abs(uv.x), abs(uv.y)) < 1.0) || depth < 1e-4 * frame.far_plane) discard;
  float t = depth * length(slope);
#ifdef FRAGMENT_ORDER
  float z = max(t - stroke_normal.w, 0.0);
#else
  float z = stroke_center_key.w;
#endif
#ifdef FRAGMENT_ORDER
#if defined(STROKE_COUNT) || defined(STROKE_STORE)
  // As in stroke.vert, a trace nearer.
  float trace = z * (1.0 - 1e-5);
  if (trace / (trace + frame.far_plane) > texelFetch(opaque_depth, ivec2(pixel), 0).x) discard;
#else
  gl_FragDepth = z / (z + frame.far_plane);
#endif
#endif
  // A tile's border stays half a texel of the level away from its neighbours.
  float inset = 0.5 * exp2(ceil(stroke_u.w)) / 64.0;
  vec2 at = (stroke_tile + clamp(0.5 + 0.5 * uv, inset, 1.0 - inset)) / 8.0;
  vec4 paint = textureLod(brush, at, stroke_u.w);
  float alpha = paint.x * stroke_v.w;

#if defined(STROKE_OPAQUE)
  if (alpha < 0.995) discard;
#elif defined(STROKE_COUNT)
  if (alpha < 0.004) discard;
  out_value = vec4(1.0);
#elif defined(STROKE_STORE)
  if (alpha < 0.004) discard;
  uint place = texelFetch(offsets, ivec2(pixel), 0).x + imageAtomicAdd(cursors, ivec2(pixel), 1u);
  if (place < fragment_room) imageStore(fragments, int(place), uvec4(floatBitsToUint(z), uint(stroke), floatBitsToUint(t), pack_paint(alpha, paint.zw)));
#else
  if (alpha < 0.5) discard;
  out_fragment = uvec4(floatBitsToUint(z), uint(stroke), floatBitsToUint(t), pack_paint(alpha, paint.zw));
#endif
}
