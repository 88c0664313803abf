#include "passes/prefix_sum.h"
#include "gl/commands.h"

namespace sfumato {

void PrefixSum::run(const gl::Buffer& buffer, std::uint32_t count) {
  constexpr std::uint32_t words_a_block = 2048;  // as in prefix_sum.comp
  if (!sum_blocks_) {
    sum_blocks_ = gl::Program::compute("passes/prefix_sum.comp", {"SUM_BLOCKS"});
    scan_sums_ = gl::Program::compute("passes/prefix_sum.comp", {"SCAN_SUMS"});
    scan_blocks_ = gl::Program::compute("passes/prefix_sum.comp");
  }
  blocks_ = (count + words_a_block - 1) / words_a_block;
  gl::grow(sums_, "sums of blocks", (blocks_ + 1) * std::size_t(4));
  buffer.bind_storage(0);
  sums_.bind_storage(1);
  sum_blocks_.set("word_count", count).set("block_count", blocks_).dispatch_rows(blocks_);
  gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT);
  scan_sums_.set("block_count", blocks_).dispatch(1);
  gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT);
  scan_blocks_.set("word_count", count).set("block_count", blocks_).dispatch_rows(blocks_);
  gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

std::uint32_t PrefixSum::total() const {
  std::uint32_t value = 0;
  sums_.download(&value, sizeof value, blocks_ * sizeof value);
  return value;
}

}  // namespace sfumato
