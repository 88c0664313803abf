// A fragment back to paint: colour, relief, shadow. In a list it is its place in the order (float bits), its stroke, its
// paint (pack_paint of stroke.frag) and the next of the list; in a picture of the nearest only stroke and paint.
#include "frame.glsl"
#include "techniques/strokes/stroke_plane.glsl"

layout(binding = UNIT_INPUT) uniform usamplerBuffer strokes;
uniform float relief;

struct Paint {
  vec3 color;
  float alpha;
  vec3 normal;  // eye, facing the camera
  float shadow;
  float t;
};

const uint no_fragment = 0xffffffffu;

float fragment_alpha(uvec4 fragment) { return unpackUnorm2x16(fragment.z).x; }

// The same whatever the order of a list and of the points: by place in the order, by lot (strokes of coincident points;
// those of one lot look alike), by place in the file, by layer.
bool comes_before(uvec4 a, uvec4 b) {
  if (a.x != b.x) return a.x < b.x;  // positive floats sort like their bits
  uvec4 ra = texelFetch(strokes, 6 * int(a.y) + 5), rb = texelFetch(strokes, 6 * int(b.y) + 5);
  return ra.z != rb.z ? ra.z < rb.z : ra.x != rb.x ? ra.x < rb.x : a.y < b.y;
}

Paint paint_of(uvec4 fragment, ivec2 pixel) {
  int at = 6 * int(fragment.y);
  vec4 normal = uintBitsToFloat(texelFetch(strokes, at + 3));
  vec4 color = uintBitsToFloat(texelFetch(strokes, at + 4));
  Paint p;
  p.color = color.rgb;
  p.shadow = color.a;
  p.alpha = fragment_alpha(fragment);
  p.t = plane_distance(vec2(pixel) + 0.5, uintBitsToFloat(texelFetch(strokes, at).xyz), normal.xyz);
  vec3 slope = frame.orthographic != 0 ? vec3(0.0, 0.0, -1.0) : eye_from_pixel(vec2(pixel) + 0.5, 1.0);
  p.normal = dot(normal.xyz, slope) > 0.0 ? -normal.xyz : normal.xyz;
  if (relief > 0.0) {
    vec2 rise = unpackSnorm4x8(fragment.z).zw * relief * 5.0;
    vec3 along = normalize(uintBitsToFloat(texelFetch(strokes, at + 1).xyz));
    vec3 across = normalize(uintBitsToFloat(texelFetch(strokes, at + 2).xyz));
    // Light from the upper left, as on a painting on a wall. Rise and fall of a stroke cancel: on the whole the colour stays.
    p.color *= clamp(1.0 - dot(rise.x * along + rise.y * across, vec3(-0.5, 0.6, 0.62)), 0.6, 1.5);
  }
  return p;
}
