#ifdef FAST
#extension GL_NV_shader_atomic_float : require
#endif
// First visit: one fragment of one splat.
#include "splat_fragment.glsl"
#include "techniques/denoise/evidence.glsl"
#include "techniques/denoise/weights.glsl"

layout(location = 0) out vec4 sink;  // never written

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  float weight = splat_weight(hit.rho);
#ifdef SPLAT_FIELD
  if (covers > 0.0) weight *= splat_field * evidence(fragment_splat());
#endif
  add_weight(ivec2(gl_FragCoord.xy), hit.t, weight);
  discard;
}
