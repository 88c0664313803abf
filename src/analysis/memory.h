// Large temporary arrays.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace sfumato::analysis {

/// Neighbours that two steps need are kept up to this size; beyond it they are found a second time, which
/// takes longer but does not fill the memory.
inline constexpr std::size_t most_kept_bytes = std::size_t(1) << 30;

/// `count` values that are not set: the memory is first touched where it is first written, by all threads
/// that write, and in large pages where the system has them. Clearing a vector would touch it on one thread.
template <class T>
std::unique_ptr<T[]> unset_array(std::size_t count) {
  static_assert(std::is_trivially_destructible_v<T>);
  auto values = std::make_unique_for_overwrite<T[]>(count);
  constexpr std::uintptr_t page = std::uintptr_t(2) << 20;
  const std::uintptr_t begin = reinterpret_cast<std::uintptr_t>(values.get());
  const std::uintptr_t first = (begin + page - 1) / page * page;
  const std::uintptr_t last = (begin + count * sizeof(T)) / page * page;
  if (first < last) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
  return values;
}

}  // namespace sfumato::analysis
