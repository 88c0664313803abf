// Where the bytes of a File lie: on disk, packed in another file, or at a server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace sfumato::io {

/// Reads are positional; several threads may share one.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  std::uint64_t size = 0;
  /// What the extension is that of: inside a .gz or .zip, and of a URL without its query.
  std::filesystem::path name;
  /// Exactly so many bytes, all within `size`. Throws Error(io).
  virtual void read(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
};

/// A handle of the system, closed at the end. `path` is for messages.
std::shared_ptr<ByteSource> disk_source(int handle, const std::filesystem::path& path);

/// What is in a gzip file or the one cloud in a zip, in a temporary file; null where `file` is neither, or a
/// zip of arrays. Kept until another is unpacked, for a file is opened several times.
std::shared_ptr<ByteSource> unpacked_source(const std::shared_ptr<ByteSource>& file,
                                            const std::filesystem::path& path);

/// "http://..." or "https://...".
bool is_remote(const std::filesystem::path& path);
/// What lies there, read by ranges where the server has them, else fetched as a whole. Throws Error(io).
std::shared_ptr<ByteSource> remote_source(const std::filesystem::path& url);

/// A temporary file without a name, gone with its last handle.
int open_temporary();
/// Appends; throws Error(io) when the disk is full.
void append_to(int handle, const void* bytes, std::size_t count);

}  // namespace sfumato::io
