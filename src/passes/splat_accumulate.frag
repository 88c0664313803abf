// Weighted sums over all hits within epsilon of the nearest one (Botsch 2005, pass 2).
//   BLEND_OPAQUE   only the nearest hit; discs that meet in it (coincident points) are averaged, so that their order
//                  does not matter
#include "splat_fragment.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D nearest_t;
uniform float epsilon;  // scene units along the ray

layout(location = 0) out vec4 color_sum;   // w rgb, w
layout(location = 1) out vec4 normal_sum;  // w n (eye, facing the camera), w t
#ifdef SPLAT_SHADOW
layout(location = 2) out vec4 shadow_sum;  // w m
#endif

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  float nearest = texelFetch(nearest_t, ivec2(gl_FragCoord.xy), 0).x;
#ifdef BLEND_OPAQUE
  if (!(hit.t <= nearest * 1.000002 + epsilon)) discard;  // epsilon is 0: a few roundings between two programs
  float w = 1.0;
#else
  if (!(hit.t < nearest + epsilon)) discard;
  float w = splat_weight(hit.rho);
#endif
  vec3 normal = splat_normal_radius.xyz;
  if (dot(normal, ray_slope(gl_FragCoord.xy)) > 0.0) normal = -normal;
  color_sum = vec4(w * splat_color.rgb, w);
  normal_sum = vec4(w * float(splat_has_normal) * normal, w * hit.t);
#ifdef SPLAT_SHADOW
  shadow_sum = vec4(w * splat_color.a);
#endif
}
