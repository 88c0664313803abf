// Lists too long for local memory: each is a heap in the buffer, which is emptied while visiting. A pass does what its
// rounds allow, the next one goes on; what that needs is kept in the place of records that were visited.
// Steps of the heap that were made, while it grows; with the highest bit, the records left in it.
layout(r32ui, binding = IMAGE_PROGRESS) uniform uimage2D progress_image;

const uint visiting = 0x80000000u, finished = 0xffffffffu;

int records_at;  // first record of this pixel in the buffer
int kept_at;     // where the next words are kept

uvec2 stored(int k) { return imageLoad(fragment_image, records_at + k).xy; }
void store(int k, uvec2 record) { imageStore(fragment_image, records_at + k, uvec4(record, 0u, 0u)); }
void keep(uvec2 words) { store(kept_at++, words); }
void keep(vec2 words) { keep(floatBitsToUint(words)); }
uvec2 kept_words() { return stored(kept_at++); }
vec2 kept() { return uintBitsToFloat(kept_words()); }

// Of the model: with what is kept here no more than `most_kept` records' worth.
void keep_points();
void resume_points();

void keep_ray() {
  keep(color.rg);
  keep(vec2(color.b, transmittance));
  keep(weighted.rg);
  keep(weighted.ba);
  keep(plain.rg);
  keep(plain.ba);
  keep(uvec2(floatBitsToUint(last_t), uint(open_count)));
  keep_points();
}
void resume_ray() {
  color.rg = kept();
  vec2 rest = kept();
  color.b = rest.x;
  transmittance = rest.y;
  weighted.rg = kept();
  weighted.ba = kept();
  plain.rg = kept();
  plain.ba = kept();
  uvec2 words = kept_words();
  last_t = uintBitsToFloat(words.x);
  open_count = int(words.y);
  resume_points();
}

// The record at k goes down until none below it comes before it.
void sift_down(uvec2 record, int k, int count) {
  for (int child = 2 * k + 1; child < count; child = 2 * k + 1) {
    uvec2 smaller = stored(child);
    if (child + 1 < count) {
      uvec2 other = stored(child + 1);
      if (before(other, smaller)) {
        smaller = other;
        ++child;
      }
    }
    if (!before(smaller, record)) break;
    store(k, smaller);
    k = child;
  }
  store(k, record);
}

bool filter_pixel(ivec2 pixel) {
  int count = int(imageLoad(fragment_cursor, pixel).x);
  uint progress = imageLoad(progress_image, pixel).x;
  if (progress == finished || is_short(count)) return false;
  records_at = first_fragment(pixel);
  int sift = findMSB(count) + 2, rounds = most_rounds, left = count;
  begin_ray(pixel);
  if (progress < visiting) {
    int built = int(progress);
    for (; built < count / 2 && rounds >= sift; ++built, rounds -= sift) {
      int k = count / 2 - 1 - built;
      sift_down(stored(k), k, count);
    }
    progress = uint(built);
    // Only when enough can be visited at once that what is kept fits into their place.
    if (built == count / 2 && rounds >= most_kept * (sift + visit_rounds)) progress = visiting | uint(left);
  } else {
    left = int(progress & ~visiting);
    kept_at = left;
    resume_ray();
  }
  if (progress >= visiting) {
    for (; left > 0 && transparent() && rounds >= sift + visit_rounds; rounds -= sift + visit_rounds) {
      uvec2 record = stored(0);
      --left;
      sift_down(stored(left), 0, left);
      visit(record);
    }
    if (left == 0 || !transparent()) {
      imageStore(progress_image, pixel, uvec4(finished));
      out_0 = over_solid(pixel);
      return true;
    }
    progress = visiting | uint(left);
    kept_at = left;
    keep_ray();
  }
  imageStore(progress_image, pixel, uvec4(progress));
  atomicAdd(unfinished_count, 1u);
  return false;
}
