// One splat to the smallest primitive that covers its pixels: a point sprite, or two triangles (SPLAT_QUADS) where
// a sprite would be larger than the driver allows. The fragment stage casts rays, so that the primitive need not be
// centred on the splat: it is the box of the covered pixels, cut at the image, which keeps sprites whose centre is
// outside.
#include "splat_cloud.glsl"

#ifdef SPLAT_LIST
layout(binding = UNIT_LIST) uniform usamplerBuffer splat_list;  // places within the chunk, in drawing order
#endif

flat out vec3 splat_center;
flat out vec4 splat_normal_radius;
flat out int splat_index;
#ifdef SPLAT_COLOR
uniform bool splat_has_shadow;
flat out vec4 splat_color;
flat out int splat_has_normal;
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
  splat_center = splat.center;
  splat_normal_radius = vec4(splat.normal, splat.radius);
  splat_index = i;
#ifdef SPLAT_COLOR
  splat_color = vec4(point_color(i), splat_has_shadow ? point_shadow(i) : 1.0);
  splat_has_normal = point_normal(i) == vec3(0.0) ? 0 : 1;
#endif
#ifdef SPLAT_FIELD
  splat_field = point_field(i);
#endif

  ivec2 first, last;
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside: nothing is drawn
  if (!splat_pixels(splat, first, last)) return;
  vec2 low = vec2(first), high = vec2(last + 1);
#ifdef SPLAT_QUADS
  int corner = gl_VertexID % 6;
  vec2 at = vec2(corner == 1 || corner == 2 || corner == 4 ? high.x : low.x,
                 corner == 2 || corner == 4 || corner == 5 ? high.y : low.y);
#else
  // A square around the box; its centre must stay on the image, or the point is clipped as a whole.
  vec2 extent = high - low;
  float size = max(extent.x, extent.y);
  vec2 corner = max(min(low, frame.image_size - size), 0.0);
  vec2 at = min(corner + 0.5 * size, frame.image_size);
  vec2 reach = max(at - low, high - at);
  gl_PointSize = 2.0 * max(reach.x, reach.y);
#endif
  gl_Position = vec4(at / frame.image_size * 2.0 - 1.0, 0.0, 1.0);
}
