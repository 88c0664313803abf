// Vectors of a whole cloud.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/parallel.h"

namespace sfumato::io {

/// The vector, empty before, at `count` zeros. First touching the memory takes longer than all the rest of
/// reading where a virtual machine has to fetch it: large pages make it cheaper, and all threads share it.
template <class T>
void allocate(std::vector<T>& values, std::size_t count) {
  values.reserve(count);
  // Below 64 MB, what another thread touched comes out of its cache more slowly than it was shared.
  constexpr std::size_t page = 2 << 20, least_shared = 32;
  const std::uintptr_t first = (std::uintptr_t(values.data()) + page - 1) / page * page;
  const std::uintptr_t last = (std::uintptr_t(values.data()) + count * sizeof(T)) / page * page;
  if (first < last) {
    ::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    const std::size_t pages = (last - first) / page, threads = thread_count();
    in_parallel(pages < least_shared ? 0 : threads, [&](std::size_t t) {
      for (std::size_t i = pages * t / threads; i < pages * (t + 1) / threads; ++i)
        *reinterpret_cast<volatile std::byte*>(first + i * page) = std::byte(0);
    });
  }
  values.resize(count);
}

/// The same for a vector that may hold something already.
template <class T>
void enlarge(std::vector<T>& values, std::size_t count) {
  if (values.empty())
    allocate(values, count);
  else
    values.resize(count);
}

}  // namespace sfumato::io
