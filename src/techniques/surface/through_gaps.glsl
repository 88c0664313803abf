// Points that hidden point removal took away, where nothing that is in front of them was drawn after all: between the
// leaves of a tree, through which the ground is seen. The operator looks farther (4 spacings to each side) than gaps
// are closed, and what lies behind is nearer the truth there than the background.

layout(binding = UNIT_MORE_INPUTS) uniform sampler2D square_colors;  // and shadow factors, of squares of 2x2 px
layout(binding = UNIT_MORE_INPUTS + 1) uniform sampler2D about;          // of 16x16 px: y, whether points are hidden

const float through_scale = 0.7;    // radius around a hidden point, point spacings
const float enclosure_scale = 6.0;  // how far around to look for what is seen, point spacings
const float steadying = 0.02;  // of the plane through few points, squares of the radius

// The surface through the hidden points around a pixel.
struct Behind {
  vec3 color;
  float shadow;   // factor: that of the best lit point, for an opening that one sees through lets light through
  float depth;    // eye
  vec2 slope;     // change of depth sideways in eye space
  float support;  // sum of weights; 0: there are none, and nothing else is set
};

bool is_any_hidden(vec2 place, float r) {
  ivec2 first = ivec2(floor((place - r) / 16.0)), last = ivec2(floor((place + r) / 16.0));
  bool is_any = false;
  for (ivec2 t = first; t.y <= last.y && !is_any;) {
    is_any = texelFetch(about, t, 0).y > 0.0;
    if (++t.x > last.x) t = ivec2(first.x, t.y + 1);
  }
  return is_any;
}

// Whether no quarter of the compass is free of what is seen within r px.
bool is_enclosed(vec2 place, float r) {
  return free_runs(sectors_around(place - vec2(offset), place, r, 4.0), 8) == 0u;
}

// `spacing` of points, px. Nothing where it is not `wanted`: software GL runs both sides of a branch, but leaves loops.
Behind hidden_around(ivec2 pixel, float spacing, bool wanted) {
  vec2 place = vec2(pixel + offset) + 0.5;
  float r = wanted ? max(through_scale * spacing, 2.5) : 0.0;
  wanted = wanted && is_any_hidden(place, r) && is_enclosed(place, wanted ? enclosure_scale * spacing : 0.0);
  ivec2 first = max(ivec2(floor(0.5 * (place - r))), ivec2(0));
  ivec2 last = wanted ? min(ivec2(floor(0.5 * (place + r))), first + 15) : first - 1;
  // Weighted sums, for the plane of least squares of depth over place.
  vec3 color = vec3(0.0);
  vec2 sum_d = vec2(0.0), sum_dz = vec2(0.0);
  vec3 sum_dd = vec3(steadying, steadying, 0.0);
  float support = 0.0, lit = 0.0, sum_z = 0.0;
  float first_z = 0.0;  // depths are counted from the first, so that sums do not cancel
  for (ivec2 t = first; t.y <= last.y;) {
    vec4 point = texelFetch(clusters, t, 0);
    vec2 d = (pixel_from_eye(point.xyz) + vec2(offset) - place) / r;
    float rest = max(1.0 - dot(d, d), 0.0), w = point.w < 0.0 ? -point.w * rest * rest : 0.0;
    if (w > 0.0) {
      first_z = support > 0.0 ? first_z : point.z;
      float z = first_z - point.z;
      support += w;
      vec4 own = texelFetch(square_colors, t, 0);
      color += w * own.rgb;
      lit = max(lit, own.a);
      sum_d += w * d;
      sum_z += w * z;
      sum_dz += w * z * d;
      sum_dd += w * vec3(d * d, d.x * d.y);
    }
    if (++t.x > last.x) t = ivec2(first.x, t.y + 1);
  }
  float inverse = 1.0 / max(support, 1e-6);
  sum_d *= inverse;
  vec2 b = inverse * (sum_dz - sum_d * sum_z);
  vec3 a = inverse * sum_dd - vec3(sum_d * sum_d, sum_d.x * sum_d.y);
  vec2 slope = vec2(a.y * b.x - a.z * b.y, a.x * b.y - a.z * b.x) / max(a.x * a.y - a.z * a.z, 1e-6);
  float depth = inverse * sum_z - first_z;
  return Behind(inverse * color, lit, depth, vec2(slope.x, -slope.y) * pixels_at(depth) / max(r, 1.0),
                support);
}
