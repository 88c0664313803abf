// Weighted sums over all hits within epsilon of the nearest one (Botsch 2005, pass 2).
//   BLEND_OPAQUE   only the nearest hit; discs that meet in it (coincident points) are averaged, so that their order
//                  does not matter
#include "splat_fragment.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D nearest_t;
uniform float epsilon;  // scene units along the ray, 0 where nearest_t has it
uniform float full_step;  // how much deeper is as good as infinitely deeper, scene units

const float grazing = 0.35;  // cosine of the view ray and the normal, 70 degrees

// Towards the side of the picture where the surface lies deeper or ends: a normal points there on the screen.
vec2 deeper_side(ivec2 pixel, float nearest) {
  ivec2 last = ivec2(frame.image_size) - 1;
  vec4 around = vec4(texelFetch(nearest_t, min(pixel + ivec2(2, 0), last), 0).x,
                     texelFetch(nearest_t, max(pixel - ivec2(2, 0), ivec2(0)), 0).x,
                     texelFetch(nearest_t, min(pixel + ivec2(0, 2), last), 0).x,
                     texelFetch(nearest_t, max(pixel - ivec2(0, 2), ivec2(0)), 0).x);
  around = clamp(around - nearest, -full_step, full_step);
  return vec2(around.x - around.y, around.z - around.w);
}

layout(location = 0) out vec4 color_sum;   // w rgb, w
layout(location = 1) out vec4 normal_sum;  // w n (eye, facing the camera), w t
#ifdef SPLAT_SHADOW
layout(location = 2) out vec4 shadow_sum;  // w m
#endif

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  float nearest = texelFetch(nearest_t, ivec2(gl_FragCoord.xy), 0).x;
  if (!(hit.t <= nearest * 1.000002 + epsilon)) discard;  // a few roundings between two programs
#ifdef BLEND_OPAQUE
  float w = 1.0;
#else
  float w = splat_weight(hit.rho);
#endif
  vec3 normal = splat_normal_radius.xyz, slope = ray_slope(gl_FragCoord.xy);
  float facing = dot(normal, slope);
  if (facing > 0.0) normal = -normal;
#ifndef BLEND_OPAQUE
  // Scans know no inside. At an outline discs from beyond the horizon show as well: turned to the camera each on its own
  // they would cancel those on this side of it, and what is left points anywhere.
  if (facing * facing < grazing * grazing * dot(slope, slope)) {
    vec2 deeper = deeper_side(ivec2(gl_FragCoord.xy), nearest);
    if (dot(deeper, vec2(normal.x, -normal.y)) < 0.0) normal = -normal;
  }
#endif
  color_sum = vec4(w * splat_color.rgb, w);
  normal_sum = vec4(w * float(splat_has_normal) * normal, w * hit.t);
#ifdef SPLAT_SHADOW
  shadow_sum = vec4(w * splat_color.a);
#endif
}
