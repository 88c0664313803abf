// The finished paint on its ground: canvas under oil, charcoal that the grain of paper takes off the stick, washes whose
// pigment gathers at their edges and in the valleys of the paper. Fixed to the picture, as a ground is.
#include "frame.glsl"
#include "color.glsl"
#include "techniques/strokes/noise.glsl"

layout(binding = UNIT_INPUT) uniform sampler2D paint;    // linear, premultiplied
layout(binding = UNIT_INPUT + 1) uniform sampler2D depths;
uniform int medium;      // 0 paint, 1 charcoal, 2 watercolor
uniform float canvas;    // how much of the ground is seen
uniform float scale;     // px of a picture 720 px high
uniform vec3 ground;     // sRGB

float paper_height(vec2 at) {
  return 0.45 * smooth_noise(at / 1.7, 11u) + 0.2 * smooth_noise(at / 3.9, 12u) + 0.35 * smooth_noise(at / 1.1, 13u);
}

// Threads over and under each other, -1 to 1.
float canvas_height(vec2 at) {
  vec2 thread = at / 3.0;
  ivec2 cell = ivec2(floor(thread));
  vec2 middle = 2.0 * (thread - vec2(cell)) - 1.0;
  bool warp = ((cell.x + cell.y) & 1) == 0;
  float across = warp ? middle.x : middle.y, along = warp ? middle.y : middle.x;
  return 1.0 - 1.2 * across * across - 0.6 * along * along;
}

// Share of the ring around a pixel that lies beyond an outline: nothing there, or something much farther away. Steps in
// depth count for less where they go all ways, as among leaves.
float outline(ivec2 pixel, float depth) {
  float beyond = 0.0, deeper = 0.0;
  int radius = max(int(1.5 * scale), 1);
  ivec2 last = textureSize(paint, 0) - 1;
  for (int k = 0; k < 8; ++k) {
    ivec2 at = clamp(pixel + radius * ivec2[8](ivec2(1, 0), ivec2(1, 1), ivec2(0, 1), ivec2(-1, 1), ivec2(-1, 0), ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1))[k], ivec2(0), last);
    float other = texelFetch(depths, at, 0).x;
    if (!(other < infinity)) beyond += 0.125;
    else if (abs(other - depth) * pixels_at(depth) > 12.0 * float(radius)) deeper += 0.125 * sign(other - depth);
  }
  return beyond + 0.5 * max(deeper, 0.0) * (1.0 - smoothstep(0.3, 0.6, deeper));
}

bool filter_pixel(ivec2 pixel) {
  vec4 here = texelFetch(paint, pixel, 0);
  out_0 = here;
  if (here.a <= 0.0) return true;
  vec2 at = (vec2(pixel) + frame.tile_origin + 0.5) / scale;
  vec3 color = here.rgb / here.a;
  float depth = texelFetch(depths, pixel, 0).x;
  if (medium == 0) {
    // Thin paint shows the threads: a change of light that cancels over a thread.
    color *= 1.0 + 0.35 * canvas * (canvas_height(at) - 0.4);
  } else if (medium == 1) {
    float lightness = dot(srgb_from_linear(color), vec3(0.2126, 0.7152, 0.0722));
    float tone = 1.0 - pow(lightness, 1.2) + 0.7 * outline(pixel, depth);
    // The stick touches the hills first; pressed harder, the valleys too.
    float valley = 1.0 - paper_height(at);
    float deposit = mix(tone, smoothstep(0.9 * valley - 0.25, 0.9 * valley + 0.45, tone), canvas);
    color = linear_from_srgb(mix(ground, vec3(0.09, 0.085, 0.08), clamp(deposit, 0.0, 1.0)));
  } else {
    ivec2 last = textureSize(paint, 0) - 1;
    int radius = max(int(2.0 * scale), 1);
    vec3 around = vec3(0.0);
    float sum = 0.0;
    for (int k = 0; k < 4; ++k) {
      vec4 other = texelFetch(paint, clamp(pixel + radius * ivec2[4](ivec2(1, 0), ivec2(0, 1), ivec2(-1, 0), ivec2(0, -1))[k], ivec2(0), last), 0);
      around += other.rgb;
      sum += other.a;
    }
    // Where a wash ends against a lighter one, its pigment gathers.
    float edge = sum > 0.0 ? clamp(6.0 * dot(around / sum - color, vec3(0.333)), 0.0, 1.0) : 0.0;
    edge = max(edge, 1.6 * outline(pixel, depth));
    float flow = smooth_noise(at / 41.0, 14u) + 0.5 * smooth_noise(at / 17.0, 15u) - 0.75;
    float density = 1.0 + 0.7 * edge + 0.5 * flow + 1.4 * canvas * (0.5 - paper_height(at));
    color = mix(color, linear_from_srgb(ground), 0.04);
    color = clamp(color - (color - color * color) * (density - 1.0), 0.0, 1.0);  // (Bousseau et al. 2006, Eq. 1)
  }
  out_0 = vec4(color * here.a, here.a);
  return true;
}
