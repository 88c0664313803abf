#include "io/las_file.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "core/threads.h"
#include "io/format.h"

namespace sfumato::io::las {

void InputFile::read(std::uint64_t offset, std::uint8_t* out, std::uint64_t size) const {
  if (offset > this->size() || size > this->size() - offset)
    fail(this->size(), "the file ends here, expected " + std::to_string(size) + " bytes from byte " +
                           std::to_string(offset) + "; the file is truncated, fetch it again");
  File::read(offset, std::as_writable_bytes(std::span(out, size)));
}

void InputFile::fail(std::uint64_t byte, const std::string& what) const {
  bad_input(path(), "byte " + std::to_string(byte), what);
}

unsigned worker_count() {
  if (const char* text = std::getenv("SFUMATO_THREADS")) {
    const long threads = std::strtol(text, nullptr, 10);
    if (threads >= 1 && threads <= 256) return unsigned(threads);
  }
  return sfumato::thread_count();
}

void parallel_tasks(std::size_t count, Progress& progress, const std::string& text,
                    const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::size_t failed = count;
  std::exception_ptr failure;
  auto work = [&] {
    for (std::size_t i; !stop && (i = next++) < count;) {
      try {
        progress.check();
        task(i);
        progress.update(double(++done) / double(count), text);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (i < failed) failure = std::current_exception(), failed = i;
        stop = true;
      }
    }
  };
  const std::size_t threads = std::min<std::size_t>(worker_count(), count);
  {
    std::vector<std::jthread> workers;
    for (std::size_t i = 1; i < threads; ++i) workers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sfumato::io::las
