// Writes that appear under their name only when they are complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <span>
#include <streambuf>
#include <string_view>
#include <vector>

namespace sfumato::io {

/// `-` and /dev/stdout: the output goes to whoever reads ours.
bool is_standard_output(const std::filesystem::path& path);

/// Symbolic links at the end of `path` followed, also to a file that does not exist yet: writing replaces
/// what they lead to, never the link. Error(io) when they lead in a circle.
std::filesystem::path follow_links(const std::filesystem::path& path);

/// Throws Error(usage) when `path` is there and is no regular file: a device, FIFO or folder is never
/// replaced.
void refuse_special_file(const std::filesystem::path& path);

/// Writes to a file that has no name (or, where the file system cannot do that, a temporary one in the same
/// folder); `commit` gives it its name, or sends it to standard output. Without `commit` (an error, Ctrl-C, a
/// killed process) nothing is left, and an older file of that name stays as it was. The mode of a replaced
/// file is kept.
class AtomicWriter {
 public:
  explicit AtomicWriter(const std::filesystem::path& path);
  ~AtomicWriter();
  AtomicWriter(const AtomicWriter&) = delete;
  AtomicWriter& operator=(const AtomicWriter&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text.data(), text.size()))); }
  /// Where the next byte goes; for formats that complete their header last.
  std::uint64_t tell() const { return at_; }
  void seek(std::uint64_t byte);
  std::uint64_t size() const { return size_; }
  /// Flushes to the disk and names the file. Error(io) names the path and the cause.
  void commit();

 private:
  void open_beside();
  void flush();
  void copy_to_standard_output();
  void give_name();
  [[noreturn]] void fail(std::string_view what) const;

  std::filesystem::path path_, target_,
      temporary_;  ///< as given; behind its links; empty while there is no name
  bool exists_ = false, to_standard_output_ = false;
  int handle_ = -1;
  std::uint64_t at_ = 0, size_ = 0;
  std::vector<std::byte> buffer_;
};

/// An AtomicWriter for libraries that write to a std::ostream. They swallow exceptions: `rethrow` throws what
/// went wrong.
class WriterBuffer final : public std::streambuf {
 public:
  explicit WriterBuffer(AtomicWriter& writer);
  /// Hands everything to the writer, then throws the first error of any write.
  void finish();
  void rethrow() const;

 protected:
  int_type overflow(int_type byte) override;
  std::streamsize xsputn(const char* bytes, std::streamsize count) override;
  int sync() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  AtomicWriter& writer_;
  std::vector<char> block_;
  std::exception_ptr error_;
};

}  // namespace sfumato::io
