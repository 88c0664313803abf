// One disc to the smallest point sprite that covers its pixels; a vertex for every square, with a disc or not.
#include "techniques/surface/disc.glsl"
#include "splat_primitive.glsl"

uniform int columns;
flat out vec4 center;  // in w the radius of the screen filter
flat out vec4 orientation;
flat out vec4 color;
flat out vec4 clip;
flat out vec3 circle;  // around what a point with a plane may fill: centre and radius, px

void main() {
  ivec2 square = ivec2(gl_VertexID % columns, gl_VertexID / columns);
  Splat splat = disc_at(square);
  center = vec4(splat.center, splat_prefilter_px);
  orientation = vec4(splat.normal, splat.radius);
  color = texelFetch(disc_colors, square, 0);
  clip = texelFetch(clips, square, 0);
  ivec2 first, last;
  place_nothing();
  bool has_pixels = splat_pixels(splat, first, last);
  circle = vec3(pixel_from_eye(splat.center), 0.0);
  if (clip.w > 0.0 && -splat.center.z > splat_near()) {
    circle.z = fill_scale * clip.w * pixels_at(-splat.center.z);
    ivec2 low = max(ivec2(ceil(circle.xy - circle.z - 0.5)), ivec2(0));
    ivec2 high = min(ivec2(floor(circle.xy + circle.z - 0.5)), ivec2(frame.image_size) - 1);
    if (all(lessThanEqual(low, high))) {
      first = has_pixels ? min(first, low) : low;
      last = has_pixels ? max(last, high) : high;
      has_pixels = true;
    }
  }
  if (has_pixels) place_primitive(first, last);
}
