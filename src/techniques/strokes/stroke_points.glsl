// Strokes of the cloud's points: which are drawn in this view, and how large they are.
#include "cloud.glsl"
#include "frame.glsl"
#include "hash.glsl"

layout(binding = UNIT_INPUT) uniform samplerBuffer stroke_tangents;  // t in cloud space, s
layout(binding = UNIT_INPUT + 1) uniform usamplerBuffer stroke_traits;  // seed, mean colour and elongation, extent, room

uniform float stroke_aspect;   // length / width of the quad
uniform float stroke_share;    // of the quad that is painted
uniform float least_length;    // half length of the quad, of the image's height
uniform float coverage;        // strokes over a point
uniform bool two_layers;

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
  // Not shorter than the spacing allows: with every point a stroke, `coverage` of them lie over a point.
  float sparse = sqrt(coverage * area * stroke_aspect / (4.0 * stroke_share));
  float wanted = least_length * frame.image_size.y / pixels_at(depth);
  float extent = uintBitsToFloat(traits.z), room = uintBitsToFloat(traits.w);
  // A cluster smaller than a stroke is painted with smaller ones (dos Anjos 2017, Sec. 3.1), and so are the borders
  // of clusters and creases: the painted half of a stroke is about sqrt(share) of its quad's.
  float fit_cluster = 0.5 * extent / wanted, fit_room = 1.2 * room / (sqrt(stroke_share) * wanted);
  float fit = clamp(min(fit_cluster, fit_room), 0.28, 1.0);
  float length = max(wanted * fit, sparse) * mix(0.75, 1.25, traits_random(traits.x, 1u));
  StrokeSize size;
  size.chance = coverage * area * stroke_aspect / (4.0 * stroke_share * length * length);
  size.small_cluster = two_layers && fit_cluster < 0.7;
  size.half_width = length / stroke_aspect;
  size.half_length = length * (1.0 + vec3(0.0, 0.25, 0.6)[(traits.y >> 24u) % 3u]);  // longer in elongated clusters
  return size;
}
