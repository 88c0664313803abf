// Points by their source index. A large cloud has several buffers of places; the pass runs for each of them and each
// chunk, and a point is in one.
#include "bindings.glsl"

layout(binding = UNIT_PLACES) uniform usamplerBuffer places;

uniform uint places_first;
uniform uint places_count;
uniform uint chunk_first;
uniform uint chunk_count;
uniform bool write_background;  // the first of these runs

// Place within the chunk, or -1: another run finds it.
int place_in_chunk(uint source) {
  if (source - places_first >= places_count) return -1;
  uint place = texelFetch(places, int(source - places_first)).x - chunk_first;
  return place < chunk_count ? int(place) : -1;
}
