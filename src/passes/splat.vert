// One splat to the smallest primitive that covers its pixels: a point sprite, or two triangles (SPLAT_QUADS) where
// a sprite would be larger than the driver allows. The fragment stage casts rays, so that the primitive need not be
// centred on the splat: it is the box of the covered pixels, cut at the image, which keeps sprites whose centre is
// outside.
#include "splat_cloud.glsl"
#include "splat_primitive.glsl"

#ifdef SPLAT_LIST
layout(binding = UNIT_LIST) uniform usamplerBuffer splat_list;  // places within the chunk, in drawing order
#endif

flat out vec4 splat_center_behind;
flat out vec4 splat_normal_radius;
flat out int splat_index;
#ifdef SPLAT_COLOR
uniform bool splat_has_shadow;
flat out vec4 splat_color;
flat out vec3 splat_own_normal;
#endif
#ifdef SPLAT_FIELD
flat out float splat_field;
#endif

void main() {
#ifdef SPLAT_QUADS
  int k = gl_VertexID / 6;
#else
  int k = gl_VertexID;
#endif
#ifdef SPLAT_LIST
  int i = int(texelFetch(splat_list, k).x);
#else
  int i = k;
#endif
  Splat splat = cloud_splat(i);
  splat_center_behind = vec4(splat.center, splat.behind);
  splat_normal_radius = vec4(splat.normal, splat.radius);
  splat_index = i;
#ifdef SPLAT_COLOR
  splat_color = vec4(point_color(i), splat_has_shadow ? point_shadow(i) : 1.0);
  splat_own_normal = mat3(frame.eye_from_cloud) * point_normal(i);
#endif
#ifdef SPLAT_FIELD
  splat_field = point_field(i);
#endif

  ivec2 first, last;
  place_nothing();
  if (splat_pixels(splat, first, last)) place_primitive(first, last);
}
