// Exclusive prefix sums of unsigned numbers on the GPU, work-efficient, in plain OpenGL 4.5.
#pragma once

#include "gl/buffer.h"
#include "gl/program.h"

namespace sfumato {

class PrefixSum {
 public:
  /// Replaces the first `count` 32-bit words of `buffer` by the sum of all words before them. Up to 2^25
  /// words.
  void run(const gl::Buffer& buffer, std::uint32_t count);
  /// The sum of all words of the last run, 2^32 - 1 when it is that or more; waits for the GPU.
  std::uint32_t total() const;

 private:
  gl::Program sum_blocks_, scan_sums_, scan_blocks_;
  gl::Buffer sums_;
  std::uint32_t blocks_ = 0;
};

}  // namespace sfumato
