// All fragments of a pixel, however many there are: the dynamic fragment buffer of Maule et al. 2012. One
// pass counts, a prefix sum on the GPU gives every pixel its place, the buffer is sized from the sum, a
// second pass stores.
//
//   list.begin(width, height);
//   ... draw with blending `add` into Framebuffer({&list.counts()}); the fragment adds how many records it
//   will store list.allocate(who); list.bind_store();  ... draw again; the fragment calls store_fragment() of
//   shaders/fragment_list.glsl list.finish_store(); list.bind_read();   ... a screen pass reads the records
//   of its pixel, in any order, and may sort them in place
//
// A record is two 32-bit words. Memory: 8 bytes a record, 12 bytes a pixel. At most `most_records()` records,
// the driver's largest texture buffer (1 GiB on llvmpipe): beyond it `allocate` throws Error(out_of_memory).
#pragma once

#include <cstdint>
#include <string>

#include "gl/buffer.h"
#include "gl/program.h"
#include "gl/texture.h"
#include "passes/prefix_sum.h"

namespace sfumato {

class FragmentList {
 public:
  void begin(int width, int height);
  /// R32F: records of every pixel, exact up to 2^24 of them.
  const gl::Texture& counts() const { return counts_; }
  /// Places for what was counted; returns how many records there are. `who` begins the message of an error.
  std::uint64_t allocate(const std::string& who);
  void bind_store() const;
  void finish_store() const;
  void bind_read() const;
  /// R32UI: records stored in every pixel.
  const gl::Texture& stored() const { return stored_; }
  static std::uint64_t most_records();

 private:
  gl::Texture counts_, stored_;
  gl::TextureBuffer offsets_, records_;
  gl::Program to_words_;
  PrefixSum prefix_sum_;
};

}  // namespace sfumato
