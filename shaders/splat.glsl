// A splat is a disc in space: centre, unit normal, radius, all in eye space. Rays meet it exactly, perspective
// included (Botsch, Hornung, Zwicker, Kobbelt 2005), so that it is right in the corners of a wide view too.
// A hit's depth is THE ray distance t; eye depth and window depth are derived from it.
//   SPLAT_PREFILTER      a splat covers at least a disc of `splat_prefilter_px` on the screen (antialiasing)
//   SPLAT_PREFILTER_OWN  that is of each splat: set it before the functions below are called
//   KERNEL_GAUSSIAN      the other kernel
#include "frame.glsl"

#ifdef SPLAT_PREFILTER_OWN
float splat_prefilter_px;
#elif defined(SPLAT_PREFILTER)
uniform float splat_prefilter_px;  // radius of the screen filter
#endif

struct Splat {
  vec3 center;  // eye
  vec3 normal;  // eye, unit
  float radius;
  float behind;  // so much farther than they are its hits count: what others hide fills where there are none
};

struct SplatHit {
  vec3 offset;  // from the centre to the hit, eye
  float depth;  // eye depth of the hit
  float t;      // distance along the ray of the pixel, and what the splat is behind
  float rho;    // 0 at the centre, 1 on the rim
};

// Hits nearer than this are not drawn. The near plane is fitted to the points and would cut their discs; this is what
// it falls back to when the camera stands inside the cloud.
float splat_near() { return 1e-4 * frame.far_plane; }

// The ray of a pixel, advancing one unit of eye depth.
vec3 ray_slope(vec2 pixel) {
  return frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(pixel, 1.0);
}

// False where the ray of this pixel position misses. Everything is measured from the centre, where float is exact.
bool hit_splat(Splat splat, vec2 pixel, out SplatHit hit) {
  float center_depth = -splat.center.z;
  vec3 slope = ray_slope(pixel);
  vec3 across = vec3(eye_from_pixel(pixel, center_depth).xy - splat.center.xy, 0.0);
  // Plane through the centre: (across + beyond slope) . normal = 0. Edge-on: infinite or NaN, hence a miss.
  float beyond = -dot(splat.normal, across) / dot(splat.normal, slope);
  hit.offset = across + beyond * slope;
  hit.depth = center_depth + beyond;
  hit.rho = length(hit.offset) / splat.radius;
  bool inside = hit.rho < 1.0;
#ifdef SPLAT_PREFILTER
  // Approximate screen filter: dist = min(|x - c| / r_px, rho); outside of the disc the depth is the centre's.
  float scale = pixels_at(center_depth);
  // A centre behind the eye is nowhere on the screen, though its disc may reach into view.
  float screen = scale > 0.0 ? length(across.xy) * scale / splat_prefilter_px : 1.0;
  if (!inside) {
    hit.offset = across;
    hit.depth = center_depth;
    hit.rho = screen;
  } else {
    hit.rho = min(hit.rho, screen);
  }
  inside = hit.rho < 1.0;
#endif
  hit.t = hit.depth * length(slope) + splat.behind;
  return inside && hit.depth >= splat_near();
}

// Weight of a hit, largest at the centre.
float splat_weight(float rho) {
#ifdef KERNEL_GAUSSIAN
  return exp(-rho * rho / (2.0 * 0.316));  // the constant of the public implementation of Botsch 2005
#else
  float rest = 1.0 - rho;  // Wendland's function
  return rest * rest * rest * rest * (4.0 * rho + 1.0);
#endif
}

// The pixels [first, last] whose centres the splat can cover; false when there are none on the screen.
//
// Exact per axis: with slopes x/z_e, the planes through the eye that touch the disc solve a quadratic; written
// relative to the centre's slope, so that nothing cancels. Extents of the disc: a = r^2 (1 - n_a^2),
// b = r^2 n_a n_z, d = r^2 (1 - n_z^2); of a sphere (SPLAT_SPHERE): a = d = r^2, b = 0.
bool splat_pixels(Splat splat, out ivec2 first, out ivec2 last) {
  float depth = -splat.center.z;
  float r2 = splat.radius * splat.radius;
#ifdef SPLAT_SPHERE
  vec2 a = vec2(r2), b = vec2(0.0);
  float d = r2;
#else
  vec2 a = r2 * max(1.0 - splat.normal.xy * splat.normal.xy, 0.0);
  vec2 b = r2 * splat.normal.xy * splat.normal.z;
  float d = r2 * max(1.0 - splat.normal.z * splat.normal.z, 0.0);
#endif
  first = ivec2(0);
  last = ivec2(frame.image_size) - 1;
  if (!(splat.radius > 0.0) || depth + sqrt(d) < splat_near()) return false;

  vec2 lo, hi;
  if (frame.orthographic != 0) {
    lo = splat.center.xy - sqrt(a);
    hi = splat.center.xy + sqrt(a);
  } else {
    if (depth <= 0.0) return true;
    // In units of the depth: fourth powers of coordinates beyond 1e9 would overflow.
    float unit = 1.0 / depth, unit2 = unit * unit;
    vec2 c = splat.center.xy * unit;
    a *= unit2, b *= unit2, d *= unit2;
    float front = 1.0 - d;
    // A disc that reaches the plane of the eye may cover any pixel.
    if (front <= 1e-6) return true;
    vec2 root = sqrt(max((b * b - a * d) - 2.0 * b * c + a + c * c * d, 0.0));
    vec2 middle = c - b;
    lo = (middle - root) / front;
    hi = (middle + root) / front;
  }
  vec2 scale = vec2(frame.intrinsics.x, -frame.intrinsics.y);
  vec2 one = lo * scale + frame.intrinsics.zw - frame.tile_origin, two = hi * scale + frame.intrinsics.zw - frame.tile_origin;
  vec2 low = min(one, two), high = max(one, two);
#ifdef SPLAT_PREFILTER
  if (depth > 0.0) {
    vec2 center = pixel_from_eye(splat.center);
    low = min(low, center - splat_prefilter_px);
    high = max(high, center + splat_prefilter_px);
  }
#endif
  // Room for rounding at the far side of a large image.
  float room = 1e-3 + 2.5e-7 * max(frame.picture_size.x, frame.picture_size.y);
  first = max(first, ivec2(ceil(max(low - 0.5 - room, -1.0))));
  last = min(last, ivec2(floor(min(high - 0.5 + room, frame.image_size))));
  return all(lessThanEqual(first, last));
}
