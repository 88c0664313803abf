// A stroke's quad: the parallelogram of its two half axes, four vertices, cut to what the brush paints. Whole strokes have
// one place in the order, and so one window depth, z / (z + far): the depth test then spares fragments behind an opaque
// stroke before they are shaded.
//   STROKE_COUNT, STROKE_STORE   a trace nearer: two programs may round differently, and a fragment too many is hidden
//   FRAGMENT_ORDER               the fragment stage decides
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform usamplerBuffer strokes;
// Half axes of the painted part of the quad, by level of the brush (BrushPicture::reach).
uniform vec4 reach_along;
uniform vec4 reach_across;

flat out int stroke;
flat out vec4 stroke_look;  // place in the order, opacity, level of the brush, border of its tile
flat out vec2 stroke_tile;
out vec3 stroke_at;  // place on the quad, -1 to 1 along and across; eye depth
#ifdef FRAGMENT_ORDER
flat out vec3 stroke_center;
flat out vec4 stroke_normal;  // lift
#endif

void main() {
  stroke = gl_VertexID / 4;
  int corner = gl_VertexID % 4, at = 6 * stroke;
  uvec4 texels[6];
  for (int n = 0; n < 6; ++n) texels[n] = texelFetch(strokes, at + n);
  vec3 center = uintBitsToFloat(texels[0].xyz);
  vec3 along = uintBitsToFloat(texels[1].xyz), across = uintBitsToFloat(texels[2].xyz);
  float key = uintBitsToFloat(texels[0].w), lod = uintBitsToFloat(texels[2].w);
  // Half a texel of the coarser level stays between a tile and its neighbours.
  stroke_look = vec4(key, uintBitsToFloat(texels[3].w), lod, 0.5 * exp2(ceil(lod)) / 64.0);
  uint variant = texels[1].w;
  stroke_tile = vec2(variant & 7u, variant >> 3u);
#ifdef FRAGMENT_ORDER
  stroke_center = center;
  stroke_normal = vec4(uintBitsToFloat(texels[3].xyz), uintBitsToFloat(texels[5].y));
#endif
  int fine = int(lod), coarse = min(fine + 1, 3);
  vec2 uv = vec2(max(reach_along[fine], reach_along[coarse]), max(reach_across[fine], reach_across[coarse]));
  uv *= vec2(corner == 1 || corner == 2 ? 1.0 : -1.0, corner >= 2 ? 1.0 : -1.0);
  vec3 eye = center + uv.x * along + uv.y * across;
  stroke_at = vec3(uv, -eye.z);
  vec4 clip = frame.clip_from_eye * vec4(eye, 1.0);
  float depth = 0.5;  // near and far planes do not cut strokes
#ifndef FRAGMENT_ORDER
#if defined(STROKE_COUNT) || defined(STROKE_STORE)
  key *= 1.0 - 1e-5;
#endif
  depth = key / (key + frame.far_plane);
#endif
  gl_Position = vec4(clip.xy, (2.0 * depth - 1.0) * clip.w, clip.w);
}
