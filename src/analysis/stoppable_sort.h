// Sorting millions of things takes longer than a user who wants to stop should wait.
#pragma once

#include <tbb/parallel_sort.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "core/progress.h"

namespace sfumato::analysis {

/// Sorts on all cores; throws Cancelled, and leaves things in any order, when `progress` asks for it.
template <class T, class Less = std::less<>>
void stoppable_sort(std::vector<T>& things, const Progress& progress, const Less& less = {}) {
  tbb::parallel_sort(things.begin(), things.end(), [&](const T& a, const T& b) {
    static thread_local unsigned compared = 0;
    if (++compared % 65536 == 0) progress.check();
    return less(a, b);
  });
}

/// For loops over millions of things: asks `progress` once in a while.
inline void check_at(std::size_t i, const Progress& progress) {
  if (i % 65536 == 65535) progress.check();
}

}  // namespace sfumato::analysis
