// Weighted sums over all hits within epsilon of the nearest one (Botsch 2005, pass 2).
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
  if (!(hit.t < texelFetch(nearest_t, ivec2(gl_FragCoord.xy), 0).x + epsilon)) discard;
  float w = splat_weight(hit.rho);
  vec3 normal = splat_normal_radius.xyz;
  if (dot(normal, ray_slope(gl_FragCoord.xy)) > 0.0) normal = -normal;
  color_sum = vec4(w * splat_color.rgb, w);
  normal_sum = vec4(w * float(splat_has_normal) * normal, w * hit.t);
#ifdef SPLAT_SHADOW
  shadow_sum = vec4(w * splat_color.a);
#endif
}
