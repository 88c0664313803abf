// Files open for reading, by bounded positional reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace sfumato::io {

class ByteSource;

/// `-` and /dev/stdin: what is piped into the program.
bool is_standard_input(const std::filesystem::path& path);

/// What the system says of an `errno`: "No space left on device".
std::string cause_of(int error);

/// A regular file open for reading. Reads are positional (pread), so several threads may share one File, and
/// a file cut short under us is an error instead of the SIGBUS a mapping would give. Standard input is read
/// to its end once and kept in memory, so that it can be opened again. What is packed by gzip, or alone in a
/// zip, is read as if it lay there unpacked, and "https://..." from its server (io/byte_source.h).
class File {
 public:
  /// Throws Error(io) when the file is missing, not regular or not readable.
  explicit File(const std::filesystem::path& path);
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// The name whose extension says the format: inside a .gz or .zip.
  const std::filesystem::path& name() const;
  std::uint64_t size() const;
  const ByteSource& source() const { return *source_; }
  /// Exactly `bytes.size()` bytes from `offset`; Error(io) when the disk fails or the file got shorter.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// At most `count` bytes from `offset`, fewer at the end of the file.
  std::string read_text(std::uint64_t offset, std::size_t count) const;

 private:
  std::filesystem::path path_;
  std::shared_ptr<const ByteSource> source_;
};

}  // namespace sfumato::io
