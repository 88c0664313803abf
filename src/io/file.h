// Files: bounded positional reads, and writes that appear under their name only when they are complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sfumato::io {

/// A regular file open for reading. Reads are positional (pread), so several threads may share one File, and
/// a file cut short under us is an error instead of the SIGBUS a mapping would give.
class File {
 public:
  /// Throws Error(io) when the file is missing, not regular or not readable.
  explicit File(const std::filesystem::path& path);
  ~File();
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  /// Exactly `bytes.size()` bytes from `offset`; Error(io) when the disk fails or the file got shorter.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// At most `count` bytes from `offset`, fewer at the end of the file.
  std::string read_text(std::uint64_t offset, std::size_t count) const;

 private:
  std::filesystem::path path_;
  int handle_ = -1;
  std::uint64_t size_ = 0;
};

/// Writes to a temporary name in the same folder; `commit` gives the file its name. Without it (an error,
/// Ctrl-C) the temporary is deleted and an older file of that name stays as it was.
class AtomicWriter {
 public:
  explicit AtomicWriter(const std::filesystem::path& path);
  ~AtomicWriter();
  AtomicWriter(const AtomicWriter&) = delete;
  AtomicWriter& operator=(const AtomicWriter&) = delete;

  /// The name to hand to a library that opens files itself; use either that or `write`.
  const std::filesystem::path& temporary() const { return temporary_; }
  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text.data(), text.size()))); }
  /// Flushes to the disk and renames. Error(io) names the path and the cause.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(std::string_view what) const;

  std::filesystem::path path_, temporary_;
  int handle_ = -1;
  std::vector<std::byte> buffer_;
};

}  // namespace sfumato::io
