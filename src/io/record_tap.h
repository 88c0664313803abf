// What is read of a LAS, LAZ or COPC file so far, for who does not want to wait for the rest.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "core/subsample.h"
#include "io/io.h"

namespace sfumato::io {

/// Keeps some of the records that pass by (`ReadOptions::tap`). All of it from any thread.
class RecordTap {
 public:
  /// At most `points` of the file's.
  explicit RecordTap(std::size_t points) : wanted_(points) {}

  /// By the reader: another file, whose bytes before the points are `head`.
  void begin(std::string head, std::size_t record_length, std::uint64_t total);
  /// By the reader: unpacked records [first, first + count) of the file.
  void take(std::uint64_t first, const std::uint8_t* records, std::size_t count);

  /// The points that were kept so far, as the reader gives them; nothing before the first.
  std::optional<ReadResult> so_far() const;

 private:
  mutable std::mutex mutex_;
  std::size_t wanted_ = 0, record_length_ = 0;
  std::uint64_t total_ = 0;
  std::optional<Subsample> kept_;
  std::string head_, records_;
};

}  // namespace sfumato::io
