// A weak bin in front of the chosen one counts where the surface that the pixels around show passes through it.
//
// Splats that cover a place at random add up to less than a threshold here and there, and through such a dip the far
// wall would show. A dip is no larger than a splat; an outlier is no larger either, but beside it there is no surface
// at its depth. Pixels on opposite sides say where between them a surface passes, however tilted: at the middle of
// their inverse depths. A third of the pairs is enough, for a curved or narrow surface ends within the splats' reach.
//
// Where one surface ends in front of another nothing lies halfway between the two. But when both are in front of what was
// chosen, it shows through their seam, which is no wider than a splat, and a bin that goes on from either closes it. Half of
// the pairs must say so: a side alone says less than what lies halfway.
#include "techniques/denoise/table.glsl"

layout(binding = UNIT_INPUT + 1) uniform sampler2D choice;

uniform float splat_reach;  // radius of a splat, scene units: the usual one, or that of the larger ones in a last round
uniform float reach_least_px;
uniform int peak_bins;      // bins this close in front of the chosen one are noise of one surface (choose.glsl)

const int rings = 3, pairs = 4 * rings;
const int seam_rings = 2;  // out to the radius of a splat

bool filter_pixel(ivec2 pixel) {
  vec4 chosen = texelFetch(choice, pixel, 0);
  out_0 = chosen;
  float nearest = texelFetch(nearest_t, pixel, 0).x;
  if (isinf(nearest)) return true;
  float origin = bin_origin(pixel);
  uint first = bin_of(bin_distance(nearest, origin));
  if (chosen.x >= 0.0 && uint(chosen.x) <= first) return true;

  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  float radius_px = max(splat_reach * pixels_at(nearest / length(slope)), reach_least_px);
  ivec2 last = textureSize(choice, 0) - 1;
  // In bin sizes: where the bin of the surface between two pixels would begin; where theirs begin, of pairs about a seam.
  float passes[pairs];
  vec2 sides[pairs];
  int count = 0, seen = 0;
  for (int ring = 0; ring < rings; ++ring) {
    int far = int(ceil(radius_px * exp2(float(ring - 1)))), diagonal = (far * 7 + 9) / 10;
    for (int k = 0; k < 4; ++k) {
      ivec2 step = k == 0 ? ivec2(far, 0) : k == 1 ? ivec2(0, far) : k == 2 ? ivec2(diagonal) : ivec2(diagonal, -diagonal);
      ivec2 one = pixel + step, two = pixel - step;
      if (any(lessThan(min(one, two), ivec2(0))) || any(greaterThan(max(one, two), last))) continue;
      ++seen;
      vec4 beside = texelFetch(choice, one, 0), opposite = texelFetch(choice, two, 0);
      if (!(beside.y > beside.z && opposite.y > opposite.z)) continue;  // a last resort is no witness
      float a = beside.w, b = opposite.w;
      if (isinf(a) || isinf(b)) continue;  // the last of the dense bins has no end
      float end = frame.orthographic != 0 ? 0.5 * (a + b) : 2.0 * a * b / (a + b);
      sides[count] = ring < seam_rings ? (vec2(a, b) - origin) / bin_size - 1.0 : vec2(infinity);
      passes[count++] = (end - origin) / bin_size - 1.0;
    }
  }
  if (3 * count <= seen) return true;
  int base = first_slot(pixel);
  uint agreed = chosen.x >= 0.0 ? uint(chosen.x) : no_bin;
  bool found = false;
  int votes_for_chosen = 0;
  float in_front = infinity;  // of what was chosen, and no noise of its surface
  if (chosen.x >= 0.0) {
    in_front = bin_start(uint(chosen.x)) - float(peak_bins);
    for (int k = 0; k < count; ++k) votes_for_chosen += int(abs(passes[k] - bin_start(uint(chosen.x))) <= 1.0);
  }
  for (int slot = 0; slot < slots; ++slot) {
    uint b = bin_in(base, slot);
    if (b == no_bin || b >= agreed) continue;
    float start = bin_start(b);
    if (start >= in_front) continue;
    int votes = 0, votes_of_seams = 0;
    for (int k = 0; k < count; ++k) {
      bool halfway = abs(passes[k] - start) <= 1.0, beside = min(abs(sides[k].x - start), abs(sides[k].y - start)) <= 1.0;
      votes += int(halfway);
      votes_of_seams += int(!halfway && beside && max(sides[k].x, sides[k].y) < in_front);
    }
    int all = votes + votes_of_seams;
    bool surface = votes > votes_for_chosen && 3 * votes > seen, seam = all > votes_for_chosen && 2 * all >= seen;
    if (surface || seam) agreed = b, found = true;
  }
  // As good a witness as any for the next round: threshold 0.
  if (found) out_0 = vec4(float(agreed), weight_of(pixel, agreed), 0.0, end_of(pixel, agreed));
  return true;
}
