// Soft points of one chunk as spheres in eye space, lit, with the key of their drawing order. Once a view and light.
#include "splat_cloud.glsl"
#include "shading.glsl"
#include "work_groups.glsl"

layout(local_size_x = 128) in;
layout(binding = UNIT_LIST) uniform usamplerBuffer soft_list;  // places within the chunk
layout(binding = UNIT_INPUT) uniform sampler2D solid_t_image;  // ray distance of the first solid hit, or infinity
layout(std430, binding = 0) writeonly buffer Shapes { vec4 shapes[]; };
layout(std430, binding = 1) writeonly buffer Looks { uvec4 looks[]; };
layout(std430, binding = 2) writeonly buffer Keys { uint keys[]; };
layout(std430, binding = 3) writeonly buffer Boxes { uvec2 boxes[]; };  // first and last pixel; last < first: none

uniform uint point_count;
uniform uint first_slot;
uniform float opacity;
uniform float field_threshold;
uniform float modulation_threshold;
uniform float modulation_opacity;  // through the centre, at the field threshold
uniform float smallest_px;      // radius below which a sphere grows and thins out
uniform int concentric_count;   // 0: one for each concentric_spacing_px of the radius
uniform float concentric_spacing_px;

const float most_shells = 32.0;

// Without the specular term: haze does not shine.
vec3 shaded(int i, Splat splat) {
  vec3 normal = point_normal(i);
  if (dot(splat.normal, to_camera(splat.center)) < 0.0) normal = -normal;
  return shaded_color(vec4(point_color(i), 1.0), pixel_from_eye(splat.center), -splat.center.z,
                      vec4(normal, point_shadow(i))).rgb;
}

// Whether a pixel of [first, last] sees farther than `nearest`. More than 8 x 8 pixels are not searched.
bool in_sight(ivec2 first, ivec2 last, float nearest) {
  if (any(greaterThan(last - first, ivec2(7)))) return true;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      if (texelFetch(solid_t_image, ivec2(x, y), 0).x > nearest) return true;
  return false;
}

void main() {
  uint k = gl_GlobalInvocationID.x + group_row() * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  if (k >= point_count) return;
  int i = int(texelFetch(soft_list, int(k)).x);
  Splat splat = cloud_splat(i);
  float distance = frame.orthographic != 0 ? -splat.center.z : length(splat.center);
  float px = splat.radius * pixels_at(max(-splat.center.z, splat_near()));
  float alpha = opacity, cone = modulation_opacity;
  if (px < smallest_px && splat.radius > 0.0) {
    float thinner = px * px / (smallest_px * smallest_px);
    alpha *= thinner;
    cone *= thinner;
    splat.radius *= smallest_px / px;
    px = smallest_px;
  }
  ivec2 first, last;
  bool seen = splat_pixels(splat, first, last);
  float share = modulation_threshold > field_threshold
      ? clamp((point_field(i) - field_threshold) / (modulation_threshold - field_threshold), 0.0, 1.0) : 1.0;
  float shells = concentric_count > 0 ? float(concentric_count) : clamp(px / concentric_spacing_px, 1.0, most_shells);
  // Hidden points keep their key: an order that is reused must not depend on what is solid.
  bool drawn = seen && in_sight(first, last, distance - splat.radius);
  vec3 color = drawn ? shaded(i, splat) : vec3(0.0);

  uint slot = first_slot + k;
  shapes[slot] = vec4(splat.center, drawn ? splat.radius : 0.0);
  looks[slot] = uvec4(packHalf2x16(color.rg), packHalf2x16(vec2(color.b, share)), floatBitsToUint(alpha),
                      packHalf2x16(vec2(shells, 0.0)) | uint(round(cone * 65535.0)) << 16u);
  boxes[slot] = drawn ? uvec2(first.x | first.y << 16, last.x | last.y << 16) : uvec2(1u, 0u);
  // Far points first. Distances are positive but behind an orthographic camera, where nothing is drawn.
  keys[slot] = seen ? ~floatBitsToUint(max(distance, 0.0)) : 0xffffffffu;
}
