// A finished picture in the framebuffer of another program, with depths by its projection.
layout(binding = 0) uniform sampler2D picture;    // sRGB, straight alpha, top row first
layout(binding = 1) uniform sampler2D eye_depth;  // along the view axis, +inf where nothing
uniform vec4 depth_row;     // clip z = x + y d, clip w = z + w d
uniform bool half_depth;    // clip depth is -1..1
uniform float farthest;     // the last depth before nothing: near 1, or near 0 where the host's depths are reversed
uniform vec2 depth_range;   // glDepthRange
uniform float opacity;      // of the whole picture
uniform ivec2 corner;       // of the viewport, px
uniform bool is_bottom_up;  // the framebuffer's first row is the lowest

layout(location = 0) out vec4 color;

void main() {
  ivec2 size = textureSize(picture, 0), pixel = ivec2(gl_FragCoord.xy) - corner;
  if (is_bottom_up) pixel.y = size.y - 1 - pixel.y;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) discard;
  vec4 c = texelFetch(picture, pixel, 0);
  c.a *= opacity;
  if (c.a == 0.0) discard;
  // Edges and haze may have no depth: they lie behind everything, and before what compositors take for nothing.
  float d = texelFetch(eye_depth, pixel, 0).r, share = farthest;
  if (!isinf(d)) {
    vec2 clip = depth_row.xz + depth_row.yw * d;
    float ndc = clip.x / clip.y;
    share = clamp(half_depth ? 0.5 * ndc + 0.5 : ndc, 0.0, 1.0);
  }
  gl_FragDepth = mix(depth_range.x, depth_range.y, share);
  color = vec4(c.rgb * c.a, c.a);
}
