// What the fragment stage of a splat knows (src/passes/splat.vert). A technique's fragment file includes this and
// begins with
//   SplatHit hit;
//   if (!hit_splat(fragment_splat(), gl_FragCoord.xy, hit)) discard;
// With y down, gl_FragCoord.xy is the pixel position of frame.glsl.
//   SPLAT_COLOR   splat_color: linear colour, shadow factor in alpha
//   SPLAT_FIELD   splat_field: the point's scalar
#include "splat.glsl"

flat in vec4 splat_center_behind;   // eye, and Splat::behind
flat in vec4 splat_normal_radius;   // eye, unit normal and radius
flat in int splat_index;            // within the chunk, for attributes fetched here
#ifdef SPLAT_COLOR
flat in vec4 splat_color;
flat in vec3 splat_own_normal;      // eye, 0 where there is none: a dot that is turned to the camera is lit as what it lies on
#endif
#ifdef SPLAT_FIELD
flat in float splat_field;
#endif

Splat fragment_splat() {
  return Splat(splat_center_behind.xyz, splat_normal_radius.xyz, splat_normal_radius.w, splat_center_behind.w);
}
