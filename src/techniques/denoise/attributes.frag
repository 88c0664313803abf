#ifdef FAST
#extension GL_NV_shader_atomic_float : require
#endif
// Second visit: one fragment of one splat.
#include "splat_fragment.glsl"
#include "techniques/denoise/evidence.glsl"
#include "techniques/denoise/attributes.glsl"

layout(location = 0) out vec4 sink;  // never written

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 chosen = texelFetch(choice, pixel, 0);
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  float place = place_in_bin(pixel, hit.t, chosen.x);
  if (place >= 0.0)
    add_attributes(pixel, chosen.y, fragment_splat(), splat_own_normal != vec3(0.0), hit.rho, splat_color, place);
  discard;
}
