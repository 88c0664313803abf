#include "passes/depth_sort.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "gl/commands.h"
#include "gl/pace.h"

namespace sfumato {

std::vector<std::uint32_t> radix_order(std::span<const std::uint32_t> keys,
                                       std::span<const std::uint32_t> initial) {
  struct Entry {
    std::uint32_t key, place;
  };
  std::vector<Entry> entries;
  entries.reserve(keys.size());
  std::uint32_t least = no_depth_key, most = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::uint32_t place = initial.empty() ? std::uint32_t(i) : initial[i], key = keys[place];
    if (key == no_depth_key) continue;
    entries.push_back({key, place});
    least = std::min(least, key);
    most = std::max(most, key);
  }
  // Depths of one view share their leading bits: sort what differs only.
  const int bits = entries.empty() ? 0 : std::bit_width(most - least), passes = (bits + 11) / 12;
  const int digit = passes ? (bits + passes - 1) / passes : 0;
  std::vector<Entry> other(passes ? entries.size() : 0);
  std::vector<std::uint32_t> starts;
  for (int pass = 0; pass < passes; ++pass) {
    const int shift = pass * digit;
    const std::uint32_t mask = (1u << digit) - 1;
    starts.assign(std::size_t(mask) + 1, 0);
    for (const Entry& e : entries) ++starts[(e.key - least) >> shift & mask];
    std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), 0u);
    for (const Entry& e : entries) other[starts[(e.key - least) >> shift & mask]++] = e;
    std::swap(entries, other);
  }
  std::vector<std::uint32_t> order(entries.size());
  std::transform(entries.begin(), entries.end(), order.begin(), [](const Entry& e) { return e.place; });
  return order;
}

void DepthSort::run(const gl::Buffer& keys, std::uint32_t count, std::span<const std::uint32_t> initial,
                    bool initial_changed, gl::Place place) {
  if (place == gl::Place::automatic) place = gl::place_of_work(gl::preferences().depth_sort);
  const std::size_t bytes = count * sizeof(std::uint32_t);
  gl::grow(order_, "drawing order", GL_R32UI, bytes);
  if (place == gl::Place::gpu) {
    if (initial_changed || initial_.bytes() != bytes) {
      std::vector<std::uint32_t> identity;
      if (initial.empty()) {
        identity.resize(count);
        std::iota(identity.begin(), identity.end(), 0u);
        initial = identity;
      }
      initial_ = gl::Buffer("order of equal depths", bytes, initial.data());
    }
    run_on_gpu(keys, count);
    drawn_ = count;
    return;
  }
  std::vector<std::uint32_t> values(count);
  gl::end_stretch();
  keys.download(values.data(), bytes);
  const std::vector<std::uint32_t> order = radix_order(values, initial);
  gl::end_stretch();
  order_.buffer().upload(order.data(), order.size() * sizeof(std::uint32_t));
  drawn_ = std::uint32_t(order.size());
}

void DepthSort::run_on_gpu(const gl::Buffer& keys, std::uint32_t count) {
  constexpr std::uint32_t places_a_block = 256 * 16;  // as in radix_sort.comp
  if (count == 0) return;
  if (!count_) {
    count_ = gl::Program::compute("passes/radix_sort.comp", {"COUNT_DIGITS"});
    scatter_ = gl::Program::compute("passes/radix_sort.comp");
  }
  const std::uint32_t blocks = (count + places_a_block - 1) / places_a_block;
  gl::grow(counts_, "digits of blocks", blocks * 64);
  gl::grow(scratch_order_, "other order", count * 4);
  const gl::Buffer* from = &initial_;
  for (int shift = 0; shift < 32; shift += 4) {
    const gl::Buffer* to = shift % 8 == 0 ? &scratch_order_ : &order_.buffer();
    for (gl::Program* step : {&count_, &scatter_}) {
      keys.bind_storage(0);
      from->bind_storage(1);
      to->bind_storage(2);
      counts_.bind_storage(3);
      step->set("place_count", count).set("block_count", blocks).set("digit_shift", shift).dispatch(blocks);
      gl::barrier(GL_SHADER_STORAGE_BARRIER_BIT);
      if (step == &count_) prefix_sum_.run(counts_, 16 * blocks);
    }
    from = to;
  }
  gl::barrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

}  // namespace sfumato
