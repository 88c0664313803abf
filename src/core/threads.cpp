#include "core/threads.h"

#include <algorithm>
#include <atomic>
#include <thread>

namespace sfumato {
namespace {

std::atomic<unsigned> chosen = 0;

}  // namespace

unsigned thread_count() {
  const unsigned count = chosen.load(std::memory_order_relaxed);
  return count ? count : std::max(1u, std::thread::hardware_concurrency());
}

void set_thread_count(unsigned count) { chosen.store(count, std::memory_order_relaxed); }

}  // namespace sfumato
