// Strokes of the cloud's points: which are drawn in this view, and how large they are.
#include "cloud.glsl"
#include "frame.glsl"
#include "hash.glsl"

layout(binding = UNIT_INPUT) uniform samplerBuffer stroke_tangents;  // t in cloud space, s
layout(binding = UNIT_INPUT + 1) uniform usamplerBuffer stroke_traits;  // seed, mean colour and elongation, extent, room and detail by s

uniform float stroke_aspect;   // length / width of the quad
uniform float stroke_share;    // of the quad that is painted
uniform float least_length;    // half length of the quad, of the image's height
uniform float coverage;        // strokes over a point
uniform float detail;          // 0: strokes follow neither detail nor borders
uniform bool two_layers;
uniform vec2 evidence;         // px: how far beside a point, and between points, paint may lie

const float least_coverage = 1.6;  // of strokes as small as the spacing allows; what they leave open is underpainted

struct StrokeSize {
  float half_length, half_width;  // of the quad, scene units
  float chance;                   // share of the points here that become strokes
  bool small_cluster;
};

float traits_random(uint seed, uint which) { return unit_from_hash(hash_of(uvec3(seed, which, 0x5f3759dfu))); }

StrokeSize stroke_size(int i, float depth) {
  uvec4 traits = texelFetch(stroke_traits, i);
  float s = texelFetch(stroke_tangents, i).w;
  float area = 0.5 * s * s;  // of surface per point: a square grid of spacing h has s = sqrt(2) h
  // The painted half of a stroke is about sqrt(share) of its quad's.
  float painted = sqrt(stroke_share), to_spacing = area / (4.0 * stroke_share);
  float wanted = max(least_length * frame.picture_size.y / pixels_at(depth), sqrt(coverage * to_spacing * stroke_aspect));
  float extent = uintBitsToFloat(traits.z);
  vec2 reach = s * unpackHalf2x16(traits.w);  // room, detail
  // A cluster smaller than a stroke is painted with smaller ones (dos Anjos 2017, Sec. 3.2.1), and so are borders of
  // clusters, creases, ends of the points, and whatever a stroke of one colour would paint over.
  float fit_cluster = 0.5 * extent / wanted, fit_room = 0.9 * reach.x / (painted * wanted);
  float fit_detail = 0.5 * reach.y / (max(detail, 1e-3) * painted * wanted);
  float fit = clamp(min(fit_cluster, min(fit_room, fit_detail)), 0.0, 1.0), covered = fit;
  if (detail == 0.0) fit = least_length > 0.0 ? clamp(fit_cluster, 0.28, 1.0) : 1.0, covered = 1.0;
  // Rounder brushes (Sec. 3.3.2) where strokes are as small as points: there direction says little; in compact clusters.
  uint elongation = (traits.y >> 24u) % 3u;
  float aspect = mix(min(stroke_aspect, 1.3), stroke_aspect, fit);
  if (elongation == 0u && fit_cluster < 1.0) aspect = min(aspect, mix(1.4, stroke_aspect, fit_cluster));
  // Not shorter than the spacing allows: with every point a stroke, so many of them lie over a point.
  float sparse = sqrt(mix(min(coverage, least_coverage), coverage, covered) * to_spacing * aspect);
  float length = max(wanted * fit, sparse) * (1.0 + 0.5 * fit * (traits_random(traits.x, 1u) - 0.5));
  // Points too far apart to be closed are dabs as large as one point vouches for, and not planks.
  float one = max(least_length * frame.picture_size.y, evidence.x / painted) / pixels_at(depth);
  float lone = smoothstep(1.5 * evidence.y, 2.0 * evidence.y, 0.7071 * s * pixels_at(depth));
  length = mix(length, min(length, one), lone);
  StrokeSize size;
  size.chance = coverage * to_spacing * aspect / (length * length);
  size.small_cluster = two_layers && fit_cluster < 0.7;
  size.half_width = length / aspect;
  // Longer in elongated clusters, but dots stay dots.
  bool dots = least_length > 0.0 && stroke_aspect <= 1.0;
  size.half_length = length * (dots ? 1.0 : 1.0 + fit * vec3(0.0, 0.25, 0.6)[elongation]);
  return size;
}
