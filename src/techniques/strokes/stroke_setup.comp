// Listed points to strokes, ready to be drawn (stroke_record.glsl).
#include "techniques/strokes/stroke_points.glsl"
#include "techniques/strokes/stroke_record.glsl"
#include "work_groups.glsl"

layout(local_size_x = 64) in;
layout(binding = UNIT_LIST) uniform usamplerBuffer stroke_list;
layout(std430, binding = 0) writeonly buffer Records { uvec4 records[]; };
layout(std430, binding = 1) writeonly buffer Keys { uint keys[]; };  // bits of positive floats sort like them

uniform int stroke_count;
uniform int first_record;
uniform float noise;       // radians
uniform float opacity;
uniform float variation;
uniform float saturation;
uniform float flatten;
uniform float divided_color;
uniform float second_lightness;  // the second layer is lighter by this
uniform bool has_shadow;
uniform bool is_one_place;  // all points are in one: what normal they have was made up, or says nothing of a surface

vec3 unpack_mean(uint code) { return linear_from_srgb(unpackUnorm4x8(code).rgb); }

void main() {
  int k = int(gl_GlobalInvocationID.x + group_row() * gl_NumWorkGroups.x * gl_WorkGroupSize.x);
  if (k >= stroke_count) return;
  int i = int(texelFetch(stroke_list, k).x);
  bool second = k > 0 && int(texelFetch(stroke_list, k - 1).x) == i;

  vec3 center = (frame.eye_from_cloud * vec4(point_position(i), 1.0)).xyz;
  mat3 turn = mat3(frame.eye_from_cloud);
  vec3 normal = is_one_place ? to_camera(center) : normalize(turn * point_normal(i));
  vec3 along = turn * texelFetch(stroke_tangents, i).xyz;
  along -= dot(along, normal) * normal;  // exact for a normal of 16 bits
  if (is_one_place && dot(along, along) < 1e-6) along = cross(normal, abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0));
  along = normalize(along);
  vec3 across = cross(normal, along);
  uvec4 traits = texelFetch(stroke_traits, i);
  StrokeSize size = stroke_size(i, -center.z);
  uint layer = second ? 16u : 0u;

  // The whole stroke turns by the point's own noise.
  float theta = noise * (2.0 * traits_random(traits.x, layer + 2u) - 1.0);
  vec3 t = cos(theta) * along + sin(theta) * across, b = cross(normal, t);
  float scale = second ? 0.5 : 1.0;  // the second texture has half the sigma

  vec3 color = mix(point_color(i), unpack_mean(traits.y), flatten);
  float light = 1.0 + variation * (traits_random(traits.x, layer + 3u) - 0.5) + (second ? second_lightness : 0.0);
  float grey = dot(color, vec3(0.2126, 0.7152, 0.0722));
  color = clamp(mix(vec3(grey), color, saturation) * light, 0.0, 1.0);
  // Three leanings that cancel, as far as the brightest channel has room.
  vec3 lean = vec3(-0.5);
  lean[int(3.0 * traits_random(traits.x, layer + 5u)) % 3] = 1.0;
  float brightest = max(max(color.r, color.g), max(color.b, 1e-3));
  color *= 1.0 + min(divided_color, 1.0 / brightest - 1.0) * lean;

  // One order for the whole stroke: its distance, shuffled among strokes that overlap. The second lies on top.
  float distance = frame.orthographic != 0 ? -center.z : length(center);
  float key = distance + (0.6 * (traits_random(traits.x, layer + 4u) - 0.5) - (second ? 0.6 : 0.0)) * size.half_length;
  float width_px = 2.0 * scale * size.half_width * pixels_at(-center.z);

  StrokeRecord r;
  r.center = center;
  r.key = max(key, 0.0);
  r.along = scale * size.half_length * t;
  r.variant = hash_of(uvec3(traits.x, layer, 5u)) & 63u;
  r.across = scale * size.half_width * b;
  r.lod = clamp(log2(64.0 / max(width_px, 1.0)), 0.0, 3.0);
  r.normal = normal;
  r.opacity = opacity;
  r.color = color;
  r.shadow = has_shadow ? point_shadow(i) : 1.0;
  r.source = point_source_index(i);
  r.lot = hash_of(uvec3(hash_of(floatBitsToUint(color)), hash_of(floatBitsToUint(point_normal(i))),
                        hash_of(floatBitsToUint(vec3(size.half_length, size.half_width, along.x)))));
  r.lift = second ? 0.25 * size.half_width : 0.0;
  keys[first_record + k] = floatBitsToUint(r.key);
  int at = stroke_texels * (first_record + k);
  for (int n = 0; n < stroke_texels; ++n) records[at + n] = stroke_texel(r, n);
}
