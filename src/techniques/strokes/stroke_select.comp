// How many strokes each point of the visible batches becomes: 0, 1, or 2 in a small cluster.
#include "techniques/strokes/stroke_points.glsl"
#include "work_groups.glsl"

layout(local_size_x = 128) in;
layout(r8ui, binding = 0) writeonly uniform uimageBuffer flags;
uniform uint slots_per_batch;

void main() {
  Batch batch = visible_batch(group_row());
  int k = int(gl_GlobalInvocationID.x);
  uint strokes = 0u;
  if (k < batch.count) {
    int i = batch.first + k;
    vec3 position = point_position(i), center = (frame.eye_from_cloud * vec4(position, 1.0)).xyz;
    float depth = -center.z;
    if (depth > 1e-4 * frame.far_plane && !is_cut(position)) {
      StrokeSize size = stroke_size(i, depth);
      vec2 beyond = abs(pixel_from_eye(center) - 0.5 * frame.image_size) - 0.5 * frame.image_size;
      bool seen = max(beyond.x, beyond.y) < 1.5 * size.half_length * pixels_at(max(depth - size.half_length, 1e-4 * frame.far_plane));
      if (seen && traits_random(texelFetch(stroke_traits, i).x, 0u) < size.chance) strokes = size.small_cluster ? 2u : 1u;
    }
  }
  imageStore(flags, int(group_row() * slots_per_batch) + k, uvec4(strokes));
}
