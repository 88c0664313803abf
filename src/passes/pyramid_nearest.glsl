// One level of the nearest-point pyramid: the child with the least depth, whole (Bouchiba 2018, Sec. 3.1.1).
#include "bindings.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D finer;

vec4 nearer(vec4 a, vec4 b) { return b.z > a.z ? b : a; }

bool filter_pixel(ivec2 pixel) {
  ivec2 child = 2 * pixel;
  out_0 = nearer(nearer(texelFetch(finer, child, 0), texelFetch(finer, child + ivec2(1, 0), 0)),
                 nearer(texelFetch(finer, child + ivec2(0, 1), 0), texelFetch(finer, child + ivec2(1, 1), 0)));
  return true;
}
