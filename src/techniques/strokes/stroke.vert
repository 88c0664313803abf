// A stroke's quad: the parallelogram of its two half axes, four vertices. Whole strokes have one place in the order, and
// so one window depth, z / (z + far): the depth test then spares fragments behind an opaque stroke before they are shaded.
//   STROKE_COUNT, STROKE_STORE   a trace nearer: two programs may round differently, and a fragment too many is hidden
//   FRAGMENT_ORDER               the fragment stage decides
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform usamplerBuffer strokes;
flat out int stroke;
flat out vec4 stroke_center_key;
flat out vec4 stroke_u;   // along / |along|^2, so that u = dot(offset, stroke_u); level of the brush
flat out vec4 stroke_v;   // opacity
flat out vec4 stroke_normal;  // lift
flat out vec2 stroke_tile;

void main() {
  stroke = gl_VertexID / 4;
  int corner = gl_VertexID % 4, at = 6 * stroke;
  uvec4 texels[6];
  for (int n = 0; n < 6; ++n) texels[n] = texelFetch(strokes, at + n);
  stroke_center_key = uintBitsToFloat(texels[0]);
  vec3 along = uintBitsToFloat(texels[1].xyz), across = uintBitsToFloat(texels[2].xyz);
  vec4 normal_opacity = uintBitsToFloat(texels[3]);
  stroke_u = vec4(along / dot(along, along), uintBitsToFloat(texels[2].w));
  stroke_v = vec4(across / dot(across, across), normal_opacity.w);
  stroke_normal = vec4(normal_opacity.xyz, uintBitsToFloat(texels[5].y));
  uint variant = texels[1].w;
  stroke_tile = vec2(variant & 7u, variant >> 3u);
  vec2 uv = vec2(corner == 1 || corner == 2 ? 1.0 : -1.0, corner >= 2 ? 1.0 : -1.0);
  vec3 eye = stroke_center_key.xyz + 1.01 * (uv.x * along + uv.y * across);
  vec4 clip = frame.clip_from_eye * vec4(eye, 1.0);
  float depth = 0.5;  // near and far planes do not cut strokes
#ifndef FRAGMENT_ORDER
  float z = stroke_center_key.w;
#if defined(STROKE_COUNT) || defined(STROKE_STORE)
  z *= 1.0 - 1e-5;
#endif
  depth = z / (z + frame.far_plane);
#endif
  gl_Position = vec4(clip.xy, (2.0 * depth - 1.0) * clip.w, clip.w);
}
