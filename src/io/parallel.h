// A few threads that share one piece of work, for readers.
#pragma once

#include <algorithm>
#include <exception>
#include <thread>
#include <vector>

#include "core/threads.h"

namespace sfumato::io {

inline std::size_t thread_count() { return std::clamp<std::size_t>(sfumato::thread_count(), 1, 16); }

/// Calls `work(i)` for i in [0, count), each on its own thread (the last on the caller's), and waits. Of
/// several exceptions the one with the lowest i is thrown, so that errors do not depend on timing.
template <class Work>
void in_parallel(std::size_t count, Work&& work) {
  std::vector<std::exception_ptr> errors(count);
  const auto guarded = [&](std::size_t i) {
    try {
      work(i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i + 1 < count; ++i) threads.emplace_back(guarded, i);
    if (count > 0) guarded(count - 1);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace sfumato::io
