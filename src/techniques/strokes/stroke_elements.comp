// Strokes in drawing order to the corners of their two triangles. Near strokes first, so that the depth test spares
// what is behind them.
//   HIDE   strokes behind opaque ones in every block of 8 x 8 pixels that they touch shrink to nothing
#include "frame.glsl"
#include "work_groups.glsl"

layout(local_size_x = 64) in;
layout(binding = UNIT_LIST) uniform usamplerBuffer stroke_order;
layout(std430, binding = 0) writeonly buffer Elements { uint elements[]; };
uniform int stroke_count;

#ifdef HIDE
layout(binding = UNIT_INPUT) uniform usamplerBuffer strokes;
layout(binding = UNIT_INPUT + 1) uniform sampler2D farthest;  // window depth of the farthest opaque stroke of each block

bool hidden(int stroke) {
  uvec4 texels[3];
  for (int n = 0; n < 3; ++n) texels[n] = texelFetch(strokes, 6 * stroke + n);
  vec4 center_key = uintBitsToFloat(texels[0]);
  // A trace nearer and a trace larger than it is drawn (stroke.vert).
  float z = center_key.w * (1.0 - 2e-5), depth = z / (z + frame.far_plane);
  vec3 along = 1.02 * uintBitsToFloat(texels[1].xyz), across = 1.02 * uintBitsToFloat(texels[2].xyz);
  vec2 low = vec2(infinity), high = vec2(-infinity);
  for (int corner = 0; corner < 4; ++corner) {
    vec3 eye = center_key.xyz + (corner % 2 == 0 ? -along : along) + (corner < 2 ? -across : across);
    if (frame.orthographic == 0 && -eye.z < 1e-4 * frame.far_plane) return false;
    vec2 pixel = pixel_from_eye(eye);
    low = min(low, pixel);
    high = max(high, pixel);
  }
  ivec2 last_block = textureSize(farthest, 0) - 1;
  ivec2 first = clamp(ivec2(floor(low / 8.0)), ivec2(0), last_block), last = clamp(ivec2(floor(high / 8.0)), ivec2(0), last_block);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      if (depth <= texelFetch(farthest, ivec2(x, y), 0).x) return false;
  return true;
}
#endif

void main() {
  int k = int(gl_GlobalInvocationID.x + group_row() * gl_NumWorkGroups.x * gl_WorkGroupSize.x);
  if (k >= stroke_count) return;
  int stroke = int(texelFetch(stroke_order, k).x);
  uint corner = 4u * uint(stroke);
  uint apart = 1u;
#ifdef HIDE
  if (hidden(stroke)) apart = 0u;
#endif
  uint offsets[6] = uint[6](0u, 1u, 2u, 0u, 2u, 3u);
  for (int n = 0; n < 6; ++n) elements[6 * k + n] = corner + apart * offsets[n];
}
