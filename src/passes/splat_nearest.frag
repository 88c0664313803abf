// Visibility: the nearest ray distance of every pixel, by GL_MIN blending (Botsch 2005, pass 1). Without a shift here
// it is left to the readers, which compare t < t_min + epsilon.
#include "splat_fragment.glsl"
#include "splat_shift.glsl"

layout(location = 0) out vec4 t_min;

void main() {
  SplatHit hit;
  if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
  t_min = vec4(hit.t + splat_shift(splat_normal_radius.w));
}
