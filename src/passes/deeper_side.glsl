// The nearest hit of every pixel, and towards which side of the picture the surface lies deeper or ends, by less than
// an outline is wide: a normal points there on the screen. Once a pixel, as many discs cover each.
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D nearest_t;

uniform float full_step;  // how much deeper is as good as infinitely deeper, scene units

const int distance_px = 2;  // as Splats::reach_px says

float nearest_at(ivec2 pixel) {
  return texelFetch(nearest_t, clamp(pixel, ivec2(0), ivec2(frame.image_size) - 1), 0).x;
}

// x nearest hit, yz the side, x right and y down.
bool filter_pixel(ivec2 pixel) {
  float nearest = texelFetch(nearest_t, pixel, 0).x;
  out_0 = vec4(nearest, 0.0, 0.0, 0.0);
  if (isinf(nearest)) return true;
  vec4 around = vec4(nearest_at(pixel + ivec2(distance_px, 0)), nearest_at(pixel - ivec2(distance_px, 0)),
                     nearest_at(pixel + ivec2(0, distance_px)), nearest_at(pixel - ivec2(0, distance_px)));
  around = clamp(around - nearest, -full_step, full_step);
  out_0.yz = vec2(around.x - around.y, around.z - around.w);
  return true;
}
