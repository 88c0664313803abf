// Hashes for everything that is random but must stay the same: pcg3d (Jarzynski, Olano 2020), first word.
uint hash_of(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v.x;
}
// [0, 1), 24 bits.
float unit_from_hash(uint h) { return float(h >> 8u) * (1.0 / 16777216.0); }
