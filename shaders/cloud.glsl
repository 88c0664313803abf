// The points of one chunk, fetched through texture buffers. `i` counts within the chunk.
#include "bindings.glsl"
#include "color.glsl"

layout(binding = UNIT_POSITIONS) uniform samplerBuffer cloud_positions;
layout(binding = UNIT_SOURCE_INDEX) uniform usamplerBuffer cloud_source_index;
layout(binding = UNIT_COLORS) uniform samplerBuffer cloud_colors;
layout(binding = UNIT_NORMALS) uniform samplerBuffer cloud_normals;
layout(binding = UNIT_RADII) uniform samplerBuffer cloud_radii;
layout(binding = UNIT_FIELD) uniform samplerBuffer cloud_field;
layout(binding = UNIT_SHADOW) uniform samplerBuffer cloud_shadow;
layout(binding = UNIT_CASTERS) uniform samplerBuffer cloud_casters;
layout(binding = UNIT_BATCHES) uniform usamplerBuffer cloud_batches;

// What of the cloud's space is left out of the picture, as the walls before a room and its ceiling are.
layout(std140, binding = BLOCK_CUT) uniform Cut {
  vec4 planes[6];  // a point p is left out where dot(xyz, p) + w > 0
  vec4 u, v, up;   // and where dot(up, p) is above the height of the cell that u and v say
  int count, across;
  vec4 heights[900];  // of across x across cells
} cut;

bool is_cut(vec3 position) {
  for (int k = 0; k < cut.count; ++k)
    if (dot(cut.planes[k].xyz, position) + cut.planes[k].w > 0.0) return true;
  vec4 p = vec4(position, 1.0);
  vec2 place = vec2(dot(cut.u, p), dot(cut.v, p));
  if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(cut.across)))) return false;
  int cell = int(place.y) * cut.across + int(place.x);
  return dot(cut.up.xyz, position) > cut.heights[cell / 4][cell % 4];
}

vec3 point_position(int i) { return texelFetch(cloud_positions, i).xyz; }
uint point_source_index(int i) { return texelFetch(cloud_source_index, i).x; }
vec3 point_color(int i) { return linear_from_srgb(texelFetch(cloud_colors, i).rgb); }
float point_radius(int i) { return texelFetch(cloud_radii, i).x; }
// How far it is a disc of a surface, 1, and no dot, 0.
float point_surface(int i) { return abs(texelFetch(cloud_radii, i).y); }
// It lies on a thin sheet that was measured on both sides, and its normal faces away from the other one.
bool point_is_on_side(int i) { return texelFetch(cloud_radii, i).y < 0.0; }
float point_field(int i) { return texelFetch(cloud_field, i).x; }
vec2 point_fields(int i) { return texelFetch(cloud_field, i).xy; }  // of two
float point_shadow(int i) { return texelFetch(cloud_shadow, i).x; }
float caster_opacity(int i) { return texelFetch(cloud_casters, i).x; }

// Unit normal in cloud space, or 0 where the cloud knows none.
vec3 point_normal(int i) {
  vec2 code = texelFetch(cloud_normals, i).xy;
  if (code == vec2(0.0)) return vec3(0.0);
  vec2 e = code * 2.0 - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return normalize(n);
}

struct Batch {
  int first;
  int count;
  vec2 log2_spacing_range;
};
Batch visible_batch(uint k) {
  uvec4 b = texelFetch(cloud_batches, 2 * int(k));
  return Batch(int(b.x), int(b.y), uintBitsToFloat(b.zw));
}
// Point spacing at a place of a visible batch, scene units. The same in every program: footprints depend on it.
float spacing_in(uint k, Batch batch, vec3 position) {
  vec4 plane = uintBitsToFloat(texelFetch(cloud_batches, 2 * int(k) + 1));
  precise float value = dot(plane.xyz, position) + plane.w;
  return exp2(clamp(value, batch.log2_spacing_range.x, batch.log2_spacing_range.y));
}
