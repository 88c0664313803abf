// Weighted sums over all hits within epsilon of the nearest one (Botsch 2005, pass 2).
//   BLEND_OPAQUE   only the nearest hit; discs that meet in it (coincident points) are averaged, so that their order
//                  does not matter
#include "splat_fragment.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D front;  // x ray distance of the nearest hit; yz deeper_side.glsl
uniform float epsilon;  // scene units along the ray, 0 where the distance has it

const float grazing = 0.35;  // cosine of the view ray and the normal, 70 degrees

layout(location = 0) out vec4 color_sum;   // w rgb, w
layout(location = 1) out vec4 normal_sum;  // w n (eye, facing the camera), w t
#ifdef SPLAT_SHADOW
layout(location = 2) out vec4 shadow_sum;  // w m
#endif

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  vec3 nearest = texelFetch(front, ivec2(gl_FragCoord.xy), 0).xyz;
  if (!(hit.t <= nearest.x * 1.000002 + epsilon)) discard;  // a few roundings between two programs
#ifdef BLEND_OPAQUE
  float w = 1.0;
#else
  float w = splat_weight(hit.rho);
#endif
  vec3 normal = splat_own_normal, slope = ray_slope(gl_FragCoord.xy);
  float facing = dot(normal, slope);
  if (facing > 0.0) normal = -normal;
#ifndef BLEND_OPAQUE
  // Scans know no inside. At an outline discs from beyond the horizon show as well: turned to the camera each on its own
  // they would cancel those on this side of it, and what is left points anywhere.
  if (facing * facing < grazing * grazing * dot(slope, slope) && dot(nearest.yz, vec2(normal.x, -normal.y)) < 0.0)
    normal = -normal;
#endif
  color_sum = vec4(w * splat_color.rgb, w);
  normal_sum = vec4(w * normal, w * (hit.t - splat_center_behind.w));
#ifdef SPLAT_SHADOW
  shadow_sum = vec4(w * splat_color.a);
#endif
}
