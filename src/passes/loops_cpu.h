// How loops that do the work of shaders, where OpenGL is software, visit what they draw.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>

#include "gl/commands.h"
#include "gl/pace.h"

namespace sfumato::cpu {

/// Once GL has written what the loop reads, `work(k)` on all cores for all numbers below `count`, each when
/// all before it have begun, until one returns false.
template <class Work>
void in_order(std::size_t count, const Work& work) {
  gl::barrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
  gl::end_stretch();
  gl::finish();
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
