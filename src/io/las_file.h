// What the LAS, LAZ and COPC readers share: positioned reads, little-endian values, one-line errors, workers.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>

#include "core/progress.h"
#include "io/file.h"

namespace sfumato::io::las {

static_assert(std::endian::native == std::endian::little, "LAS values are copied as they lie in the file");

/// A value of the file at `bytes`, which need not be aligned.
template <class T>
T get(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class T>
void put(std::uint8_t* bytes, T value) {
  std::memcpy(bytes, &value, sizeof value);
}

/// A file whose reads are checked against its size, with errors that name the byte.
class InputFile : public File {
 public:
  using File::File;
  /// Fills `size` bytes of `out` from `offset`; throws Error(bad_input) when the file ends before.
  void read(std::uint64_t offset, std::uint8_t* out, std::uint64_t size) const;
  /// Throws Error(bad_input). `what`: found, expected; what to do.
  [[noreturn]] void fail(std::uint64_t byte, const std::string& what) const;
};

/// Number of decoding threads: SFUMATO_THREADS when it is set (1 to 256), else the machine's.
unsigned worker_count();

/// Calls task(0) ... task(count - 1) on `worker_count()` threads, in increasing order of start. The first
/// exception (by index) ends the work and is rethrown; `progress` is updated and asked after each task.
void parallel_tasks(std::size_t count, Progress& progress, const std::string& text,
                    const std::function<void(std::size_t)>& task);

}  // namespace sfumato::io::las
