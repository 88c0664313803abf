// How loops that do the work of shaders, where OpenGL is software, visit what they draw.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>

#include "gl/commands.h"
#include "gl/pace.h"

namespace sfumato::cpu {

/// Until GL has written what a loop reads of its buffers.
inline void wait_for_gl() {
  gl::barrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
  gl::end_stretch();
  gl::finish();
}

/// `row(y)` for the rows of a picture.
template <class Row>
void for_each_row(int height, const Row& row) {
  constexpr int rows_at_once = 16;
  const Progress& progress = gl::lent_progress();
  tbb::parallel_for(tbb::blocked_range<int>(0, height, rows_at_once), [&](const auto& range) {
    progress.check();
    for (int y = range.begin(); y < range.end(); ++y) row(y);
  });
}

/// Once GL has written what the loop reads, `work(k)` on all cores for all numbers below `count`, each when
/// all before it have begun, until one returns false.
template <class Work>
void in_order(std::size_t count, const Work& work) {
  wait_for_gl();
  const Progress& progress = gl::lent_progress();
  std::atomic<std::size_t> next = 0;
  tbb::parallel_for(0, tbb::this_task_arena::max_concurrency(), [&](int) {
    for (std::size_t k = next++; k < count; k = next++) {
      progress.check();
      if (!work(k)) next = count;
    }
  });
}

}  // namespace sfumato::cpu
