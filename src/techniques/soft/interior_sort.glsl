// The records of a pixel in ascending order: up to 256 in local memory, more in place in the buffer.
#include "fragment_list.glsl"

layout(binding = UNIT_FRAGMENTS) uniform usamplerBuffer fragments;

const int most_local = 256;
uvec2 local_records[most_local];
int records_at;  // first record of this pixel in the buffer, when they are not local
bool records_local;

bool before(uvec2 a, uvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

uvec2 sorted_record(int k) {
  return records_local ? local_records[k] : imageLoad(fragment_image, records_at + k).xy;
}

void sort_local(int count) {
  uvec2 merged[most_local];
  for (int width = 1; width < count; width *= 2) {
    for (int low = 0; low < count; low += 2 * width) {
      int middle = min(low + width, count), high = min(low + 2 * width, count), a = low, b = middle;
      for (int k = low; k < high; ++k) {
        bool take_a = a < middle && (b >= high || !before(local_records[b], local_records[a]));
        merged[k] = take_a ? local_records[a++] : local_records[b++];
      }
    }
    for (int k = 0; k < count; ++k) local_records[k] = merged[k];
  }
}

uvec2 stored(int k) { return imageLoad(fragment_image, records_at + k).xy; }
void store(int k, uvec2 record) { imageStore(fragment_image, records_at + k, uvec4(record, 0u, 0u)); }

void sift_down(int k, int count) {
  uvec2 record = stored(k);
  while (true) {
    int child = 2 * k + 1;
    if (child >= count) break;
    uvec2 larger = stored(child);
    if (child + 1 < count) {
      uvec2 other = stored(child + 1);
      if (before(larger, other)) {
        larger = other;
        ++child;
      }
    }
    if (!before(record, larger)) break;
    store(k, larger);
    k = child;
  }
  store(k, record);
}

void sort_in_place(int count) {
  for (int k = count / 2 - 1; k >= 0; --k) sift_down(k, count);
  for (int last = count - 1; last > 0; --last) {
    uvec2 largest = stored(0);
    store(0, stored(last));
    store(last, largest);
    sift_down(0, last);
  }
}

// Returns how many records there are.
int sort_records(ivec2 pixel) {
  int count = int(imageLoad(fragment_cursor, pixel).x);
  records_at = first_fragment(pixel);
  records_local = count <= most_local;
  if (records_local) {
    for (int k = 0; k < count; ++k) local_records[k] = texelFetch(fragments, records_at + k).xy;
    sort_local(count);
  } else {
    sort_in_place(count);
  }
  return count;
}
