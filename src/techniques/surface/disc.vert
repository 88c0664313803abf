// One disc to the smallest point sprite that covers its pixels; a vertex for every square, with a disc or not.
#include "techniques/surface/disc.glsl"
#include "splat_primitive.glsl"
#include "techniques/surface/openness.glsl"

uniform int columns;
uniform float ambient_occlusion;
flat out vec4 center;  // in w the radius of the screen filter
flat out vec4 orientation;
flat out vec4 color;
flat out vec4 clip;

void main() {
  ivec2 square = ivec2(gl_VertexID % columns, gl_VertexID / columns);
  Splat splat = disc_at(square);
  center = vec4(splat.center, splat_prefilter_px);
  orientation = vec4(splat.normal, splat.radius);
  color = texelFetch(disc_colors, square, 0);
  if (ambient_occlusion > 0.0) color.rgb *= mix(1.0, openness_at(2.0 * vec2(square) + 1.0), ambient_occlusion);
  clip = texelFetch(clips, square, 0);
  ivec2 first, last;
  place_nothing();
  if (splat_pixels(splat, first, last)) place_primitive(first, last);
}
