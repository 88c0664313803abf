// Second visit: one fragment of one splat. FAST blends float sums, else integer atomics: the same in every order.
#include "splat_fragment.glsl"
#include "techniques/denoise/attributes.glsl"

layout(location = 0) out vec4 color_sum;   // w rgb, w; never written unless FAST
#ifdef FAST
layout(location = 1) out vec4 normal_sum;  // w n (eye, facing the camera), w place
#ifdef SPLAT_SHADOW
layout(location = 2) out vec4 shadow_sum;  // w m
#endif
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 chosen = texelFetch(choice, pixel, 0);
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  float place = place_in_bin(pixel, hit.t, chosen.x);
  if (place < 0.0) discard;
  float w = max(splat_weight(hit.rho), least_weight);
  vec3 normal = splat_normal_radius.xyz * float(splat_has_normal);
  if (dot(normal, ray_slope(gl_FragCoord.xy)) > 0.0) normal = -normal;
#ifdef FAST
  color_sum = vec4(w * splat_color.rgb, w);
  normal_sum = vec4(w * normal, w * place);
#ifdef SPLAT_SHADOW
  shadow_sum = vec4(w * splat_color.a);
#endif
#else
  add_attributes(pixel, chosen.y, w, splat_color, normal, place);
  discard;
#endif
}
