// The lit test of every point (Dobrev 2010, Sec. 4): lit = depth_L < map(x,y) + d_min / max(|<v,n>|, c_min).
// The absolute value and the bound are ours: the printed <v,n> = -n_z is negative towards the light and
// unbounded at grazing angles.
// One visit of the points tests MAPS light maps, so that position, normal and factor are read once for all of
// them.
//   ORTHOGRAPHIC the light is directional
//   LAYER        the maps are layers of see-through casters: what they let pass is multiplied into `passed`
//   PASSED       a lit point gets what see-through casters in front of it let pass
#include "cloud.glsl"
#include "light_map.glsl"
#include "work_groups.glsl"

layout(local_size_x = 128) in;
#ifndef LAYER
layout(r32f, binding = 0) uniform imageBuffer shadow_factor;
uniform float share;   // of a light sample in the average
#else
layout(binding = UNIT_INPUT + MAPS) uniform sampler2D opacity_maps[MAPS];
#endif
#if defined(LAYER) || defined(PASSED)
layout(r32f, binding = 1) uniform imageBuffer passed;
#endif
layout(binding = UNIT_INPUT) uniform sampler2D light_maps[MAPS];
layout(binding = UNIT_FARTHEST) uniform sampler2D farthest_maps[MAPS];  // of each 4 x 4 texels: light_farthest.glsl

struct LightView {  // as in frame.glsl
  mat4 eye_from_cloud;
  vec4 intrinsics;
  float near_plane;
#ifndef LAYER
  float elsewhere;  // light of what is not in the map: nothing casts there, or another face sees it
#endif
};
#ifdef LAYER
uniform LightView views[1];
#define VIEW views[0]
#else
uniform LightView views[MAPS];
#define VIEW views[k]
#endif

uniform float d_min;   // scene units
uniform float d_min_spacings;  // of where the point is, if that is more
uniform float largest_spacing; // scene units
uniform bool has_normals;
uniform bool is_first; // what the points were given before does not count

const float c_min = 0.1;
// Texels from a point to the centre of the nearest one in which the light sees its surface: lit up to the first,
// three spacings, which is as far as the disc of a point reaches in any technique; in shadow from the second on,
// as far as the 5 x 5 texels around a point reach from anywhere within its texel.
const float near_texels = 2.0, far_texels = 2.5;

void main() {
  Batch batch = visible_batch(group_row());
  int in_batch = int(gl_GlobalInvocationID.x);
  if (in_batch >= batch.count) return;
  int i = batch.first + in_batch;
  vec4 position = vec4(point_position(i), 1.0);
  // Where points are sparse, so are those around: their discs in the map reach as far and are off by as much.
  float spacing = min(spacing_in(group_row(), batch, position.xyz), largest_spacing);
  float own_gap = max(d_min, d_min_spacings * spacing);
  vec3 normal = has_normals ? point_normal(i) : vec3(0.0);
  bool has_normal = dot(normal, normal) > 0.25;

#ifdef LAYER
  float factor = is_first ? 1.0 : imageLoad(passed, i).x;
#else
  float factor = is_first ? 0.0 : imageLoad(shadow_factor, i).x;
#ifdef PASSED
  float lit_share = share * imageLoad(passed, i).x;
#else
  float lit_share = share;
#endif
#endif
  for (int k = 0; k < MAPS; ++k) {
    vec3 eye = (VIEW.eye_from_cloud * position).xyz;
    float depth = -eye.z;
    vec3 normal_eye = mat3(VIEW.eye_from_cloud) * normal;
#ifdef ORTHOGRAPHIC
    const float divisor = 1.0;
    float cosine = abs(normal_eye.z);
#else
    float divisor = depth, cosine = abs(dot(normalize(-eye), normal_eye));
#endif
    vec2 pixel = vec2(VIEW.intrinsics.x * eye.x, -VIEW.intrinsics.y * eye.y) / divisor + VIEW.intrinsics.zw;
    // Without a normal, as for a surface tilted by 60 degrees to the light.
    float offset = own_gap / max(has_normal ? cosine : 0.5, c_min);
    ivec2 size = textureSize(light_maps[k], 0);
    bool is_inside = is_in_map(eye, divisor, VIEW.intrinsics, vec2(size));
    if (is_inside && depth >= VIEW.near_plane) {
      ivec2 texel = min(ivec2(pixel), size - 1);
      float map_here = texelFetch(light_maps[k], texel, 0).x, lit = depth < map_here + offset ? 1.0 : 0.0;
      // Without a normal the map knows where the surface is steeper: by how much it recedes across a texel, on the
      // flatter side of each axis, as an outline has the background on one side. (A loop of none costs nothing on
      // software GL, a branch does.)
      float rise = 0.0;
      int axes = lit <= 0.0 && !has_normal && depth < map_here + own_gap / c_min ? 2 : 0;
      for (int axis = 0; axis < axes; ++axis) {
        ivec2 along = ivec2(1 - axis, axis);
        float after = texelFetch(light_maps[k], min(texel + along, size - 1), 0).x;
        float before = texelFetch(light_maps[k], max(texel - along, ivec2(0)), 0).x;
        rise += min(abs(after - map_here), abs(before - map_here));
      }
      if (rise > 0.0) offset = clamp(own_gap + 2.0 * rise, offset, own_gap / c_min);
      lit = depth < map_here + offset ? 1.0 : 0.0;
      // A texel that a caster only touches is dark as a whole. Who stands behind the caster's rim, in the light, has
      // a neighbour in which the light sees the same surface; what else lies behind the rim says nothing about it.
      // Most of what is dark lies behind all of them: four squares hold the five by five texels.
      ivec2 low = max(texel - 2, ivec2(0)) / 4, high = min(texel + 2, size - 1) / 4;
      float farthest = 0.0;
      for (int square = lit > 0.0 ? 4 : 0; square < 4; ++square) {
        ivec2 at = ivec2((square & 1) != 0 ? high.x : low.x, (square & 2) != 0 ? high.y : low.y);
        farthest = max(farthest, texelFetch(farthest_maps[k], at, 0).x);
      }
      int taps = lit > 0.0 || depth - farthest >= offset ? 0 : 25;
      for (int tap = 0; tap < taps; ++tap) {
        ivec2 at = texel + ivec2(tap % 5, tap / 5) - 2;
        float map = texelFetch(light_maps[k], clamp(at, ivec2(0), size - 1), 0).x;
        float nearby = (far_texels - distance(pixel, vec2(at) + 0.5)) / (far_texels - near_texels);
        if (abs(map - depth) < offset) lit = max(lit, min(nearby, 1.0));
      }
#ifdef LAYER
      factor *= 1.0 - (1.0 - lit) * texelFetch(opacity_maps[k], texel, 0).x;
#else
      factor += lit * lit_share;
#endif
    }
#ifndef LAYER
    else factor += (is_inside && depth > 0.0 ? 1.0 : VIEW.elsewhere) * lit_share;  // nothing casts before the near plane
#endif
  }
#ifdef LAYER
  imageStore(passed, i, vec4(factor));
#else
  imageStore(shadow_factor, i, vec4(factor));
#endif
}
