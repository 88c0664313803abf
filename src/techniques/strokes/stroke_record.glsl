// A stroke of this view, six texels in one buffer.
struct StrokeRecord {
  vec3 center;   // eye
  float key;     // place in the order of whole strokes, scene units
  vec3 along;    // eye, half length of the quad
  uint variant;  // of the brush
  vec3 across;   // eye, half width of the quad
  float lod;     // level of the brush's picture
  vec3 normal;   // eye, unit
  float opacity;
  vec3 color;    // linear
  float shadow;
  uint source;   // place in the file
  uint lot;      // by what it looks like: decides between equal distances, then `source`
  float lift;    // scene units nearer in the order of fragments
};
const int stroke_texels = 6;

uvec4 stroke_texel(StrokeRecord r, int n) {
  switch (n) {
    case 0: return uvec4(floatBitsToUint(r.center), floatBitsToUint(r.key));
    case 1: return uvec4(floatBitsToUint(r.along), r.variant);
    case 2: return uvec4(floatBitsToUint(r.across), floatBitsToUint(r.lod));
    case 3: return uvec4(floatBitsToUint(r.normal), floatBitsToUint(r.opacity));
    case 4: return uvec4(floatBitsToUint(r.color), floatBitsToUint(r.shadow));
    default: return uvec4(r.source, floatBitsToUint(r.lift), r.lot, 0u);
  }
}
