// Weighted sums over the hits within epsilon of the nearest one (Botsch 2005, pass 2).
#define DISC_FRAGMENT
#include "techniques/surface/disc.glsl"

layout(binding = UNIT_INPUT + 3) uniform sampler2D nearest_t;

const float epsilon = 1.2;  // how far behind the nearest hit a disc is of the same surface, radii

#ifdef WITH_SHADOW
uniform float shadow_depth;  // share of epsilon within which shadow factors count
#endif

flat in vec4 center;
flat in vec4 orientation;
flat in vec4 color;
flat in vec4 clip;
flat in vec3 circle;

layout(location = 0) out vec4 color_sum;   // w rgb, w
// w n (eye, facing the camera), twice that of a disc without a plane, by which outline.glsl knows it; w t
layout(location = 1) out vec4 normal_sum;
#ifdef WITH_SHADOW
layout(location = 2) out vec4 shadow_sum;  // v m, v
#endif

void main() {
  SplatHit hit;
  splat_prefilter_px = center.w;
  float nearest = texelFetch(nearest_t, ivec2(gl_FragCoord.xy), 0).x;
  if (isinf(nearest)) {  // no disc: a weight of next to nothing, for where outline.glsl finds the surface to go on
    float rest = 1.0 - length(gl_FragCoord.xy - circle.xy) / circle.z;
    if (!(rest > 0.0)) discard;
    float w = 1e-6 * rest * rest;
    color_sum = vec4(w * color.rgb, w);
    normal_sum = vec4(w * orientation.xyz, w * -center.z * length(ray_slope(gl_FragCoord.xy)));
#ifdef WITH_SHADOW
    shadow_sum = vec4(w * color.a, w, 0.0, 0.0);
#endif
    return;
  }
  if (!hit_disc(Splat(center.xyz, orientation.xyz, orientation.w, 0.0), clip, gl_FragCoord.xy, hit)) discard;
  float behind = (hit.t - nearest) / (epsilon * orientation.w);
  if (!(behind <= 1.0)) discard;
  float w = splat_weight(hit.rho);
  color_sum = vec4(w * color.rgb, w);
  normal_sum = vec4((clip.w < 0.0 ? 2.0 : 1.0) * w * orientation.xyz, w * hit.t);
#ifdef WITH_SHADOW
  // A disc a little behind stands for points that the surface in front keeps in the dark: a thousandth at its
  // rear end. A mean over both would be grey.
  float rest = max(1.0 - behind / shadow_depth, 0.0), v = w * (rest * rest + 1e-3);
  shadow_sum = vec4(v * color.a, v, 0.0, 0.0);
#endif
}
