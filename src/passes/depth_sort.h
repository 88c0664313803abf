// Points in drawing order: a stable radix sort by 32-bit keys, on the GPU in plain OpenGL 4.5 compute, on
// software GL on the CPU (45 Mkeys/s on one core of it, where a compute pass would emulate a GPU).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gl/buffer.h"
#include "gl/context.h"
#include "gl/program.h"
#include "passes/prefix_sum.h"

namespace sfumato {

/// Key of what is not to be drawn: sorted last.
constexpr std::uint32_t no_depth_key = 0xffffffffu;

/// Places of `keys` by ascending key; equal keys stay in the order of `initial` (a permutation, or empty for
/// 0, 1, 2 ...). Places whose key is no_depth_key are left out.
std::vector<std::uint32_t> radix_order(std::span<const std::uint32_t> keys,
                                       std::span<const std::uint32_t> initial);

class DepthSort {
 public:
  /// Sorts `count` keys of a buffer as radix_order does. `initial` is only read when `initial_changed`.
  /// Automatic place: as SFUMATO_DEPTH_SORT=gpu|cpu says, else the CPU on software GL.
  void run(const gl::Buffer& keys, std::uint32_t count, std::span<const std::uint32_t> initial,
           bool initial_changed, gl::Place place = gl::Place::automatic);
  /// R32UI: places in order.
  const gl::TextureBuffer& order() const { return order_; }
  /// How many of them to draw; the GPU keeps those without a key, at the end.
  std::uint32_t drawn() const { return drawn_; }

 private:
  void run_on_gpu(const gl::Buffer& keys, std::uint32_t count);
  gl::TextureBuffer order_;
  gl::Buffer initial_, scratch_order_, counts_;
  gl::Program count_, scatter_;
  PrefixSum prefix_sum_;
  std::uint32_t drawn_ = 0;
};

}  // namespace sfumato
