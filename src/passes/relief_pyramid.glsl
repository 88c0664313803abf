// One level of the depth pyramid: of each square of four the mean depth of what is in front. A mean lies on the plane of
// its points however it is tilted, which the nearest one does not.
//
// Beside it what does not hold together between the four: the diagonal detail of the Haar wavelet, 0 on every plane and
// along straight edges. Its mean is what noise is measured by (Donoho, Johnstone 1994, "Ideal Spatial Adaptation by
// Wavelet Shrinkage", Sec. 4.2). Leaves are no noise: no square counts for more than a quarter of its width.
//   x depth, 0 where nothing; y share that is covered; z the detail, below 0 where unknown; w the mean of the children's
#include "frame.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D finer;

uniform bool is_first;   // `finer` holds the depth of pixels
uniform float width_px;  // of a square

const float steepest = 4.0;       // depth over width: what lies farther behind is another surface
const float least_share = 0.25;   // of a square's cover: less in front is a speck
const float most_detail = 0.25;   // widths of a square

vec4 child(ivec2 at) {
  if (any(greaterThanEqual(at, textureSize(finer, 0)))) return vec4(0.0, 0.0, -1.0, -1.0);
  vec4 value = texelFetch(finer, at, 0);
  if (!is_first) return value;
  return isinf(value.x) ? vec4(0.0, 0.0, -1.0, -1.0) : vec4(value.x, 1.0, -1.0, -1.0);
}

bool filter_pixel(ivec2 square) {
  vec4 a = child(2 * square), b = child(2 * square + ivec2(1, 0)), c = child(2 * square + ivec2(0, 1)),
       d = child(2 * square + ivec2(1, 1));
  vec4 depth = vec4(a.x, b.x, c.x, d.x), share = vec4(a.y, b.y, c.y, d.y);
  float cover = dot(share, vec4(1.0));
  out_0 = vec4(0.0, 0.0, -1.0, -1.0);
  if (cover <= 0.0) return true;
  bvec4 there = greaterThan(share, vec4(0.0));
  vec4 known = mix(vec4(infinity), depth, there);
  float nearest = min(min(known.x, known.y), min(known.z, known.w));
  float pixel = 1.0 / pixels_at(nearest);
  vec4 in_front = share * vec4(lessThanEqual(known, vec4(nearest + steepest * width_px * pixel)));
  if (dot(in_front, vec4(1.0)) < least_share * cover) in_front = share - in_front;
  float sum = dot(in_front, vec4(1.0));
  out_0.x = dot(in_front, depth) / sum;
  out_0.y = 0.25 * sum;
  if (all(there)) out_0.z = min(0.5 * abs(a.x - b.x - c.x + d.x), most_detail * width_px * pixel);
  vec4 details = vec4(a.z, b.z, c.z, d.z), measured = vec4(greaterThanEqual(details, vec4(0.0)));
  float count = dot(measured, vec4(1.0));
  if (count > 0.0) out_0.w = dot(measured, details) / count;
  return true;
}
