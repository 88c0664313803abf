// Blocks of a loop on all cores, with progress and cancellation.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "core/progress.h"

namespace sfumato::synth {

/// Calls `body(begin, end)` for blocks that cover [0, count). Bodies must write to places of their own.
template <class Body>
void parallel_blocks(std::size_t count, std::size_t block, Progress& progress, std::string_view text,
                     Body&& body) {
  const std::size_t blocks = (count + block - 1) / block;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t b = range.begin(); b != range.end(); ++b) {
                        progress.check();
                        body(b * block, std::min(count, (b + 1) * block));
                        progress.update(double(++done) / double(blocks), text);
                      }
                    });
}

}  // namespace sfumato::synth
