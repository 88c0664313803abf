// Express model: the opacity of a sphere as a cosine of the distance from its centre (Seemann 2018, Eq. 19).
#include "techniques/soft/sphere_fragment.glsl"

layout(location = 0) out vec4 color;  // premultiplied

const float pi = 3.14159265;

void main() {
  SoftRay ray = soft_ray(soft_shape.xyz, soft_shape.w, gl_FragCoord.xy);
  if (!(ray.delta < 1.0) || ray.middle > solid_t() || ray.middle < near_t(gl_FragCoord.xy)) discard;
  float alpha = soft_color.a * 0.5 * (cos(pi * ray.delta) + 1.0);
  if (soft_share.x < 1.0) alpha = modulated(soft_share.y, soft_share.x, ray.delta, alpha);
  color = vec4(soft_color.rgb * alpha, alpha);
}
