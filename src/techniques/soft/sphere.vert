// The soft points as primitives that cover their spheres, in their own order or in that of a list.
#define SOFT_READ
#include "techniques/soft/sphere.glsl"
#include "splat_primitive.glsl"

#ifdef SOFT_ORDERED
layout(binding = UNIT_LIST) uniform usamplerBuffer soft_order;
uniform int order_first;
uniform int order_step;  // 1, or -1: read backwards
#endif

flat out vec4 soft_shape;
flat out vec4 soft_color;  // opacity in alpha
flat out vec2 soft_share;  // share and cone of Eq. 22
flat out float soft_shells;
flat out int soft_slot;

void main() {
#ifdef SPLAT_QUADS
  int k = gl_VertexID / 6;
#else
  int k = gl_VertexID;
#endif
#ifdef SOFT_ORDERED
  k = int(texelFetch(soft_order, order_first + order_step * k).x);
#endif
  SoftPoint point = soft_point(k);
  soft_shape = vec4(point.center, point.radius);
  soft_color = vec4(point.color, point.opacity);
  soft_share = vec2(point.share, point.cone);
  soft_shells = point.shells;
  soft_slot = k;
  ivec2 first, last;
  place_nothing();
  if (splat_pixels(Splat(point.center, vec3(0.0), point.radius, 0.0), first, last)) place_primitive(first, last);
}
