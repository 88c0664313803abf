// Splats of all points but those of the first soft layer: the nearest hit, or (ACCUMULATE) sums over all hits within
// epsilon of it. As in passes/splat_nearest.frag and passes/splat_accumulate.frag but for the first lines of main.
#include "splat_fragment.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D layer_t;
#ifdef ACCUMULATE
layout(binding = UNIT_INPUT + 1) uniform sampler2D nearest_t;
#endif
uniform float soft_threshold;
uniform float epsilon;  // scene units along the ray

layout(location = 0) out vec4 out_0;   // t; or w rgb, w
#ifdef ACCUMULATE
layout(location = 1) out vec4 out_1;   // w n (eye, facing the camera), w t
#ifdef SPLAT_SHADOW
layout(location = 2) out vec4 out_2;   // w m
#endif
#endif

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  if (splat_field > soft_threshold && hit.t <= texelFetch(layer_t, ivec2(gl_FragCoord.xy), 0).x + epsilon) discard;
#ifdef ACCUMULATE
  if (!(hit.t <= texelFetch(nearest_t, ivec2(gl_FragCoord.xy), 0).x * 1.000002 + epsilon)) discard;
  float w = splat_weight(hit.rho);
  vec3 normal = splat_normal_radius.xyz;
  if (dot(normal, ray_slope(gl_FragCoord.xy)) > 0.0) normal = -normal;
  out_0 = vec4(w * splat_color.rgb, w);
  out_1 = vec4(w * float(splat_own_normal != vec3(0.0)) * normal, w * (hit.t - splat_center_behind.w));
#ifdef SPLAT_SHADOW
  out_2 = vec4(w * splat_color.a);
#endif
#else
  out_0 = vec4(hit.t);
#endif
}
