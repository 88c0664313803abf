#include "io/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace sfumato::io {
namespace {

constexpr std::size_t buffer_size = 1 << 20;

std::string cause(int error) {
  return std::generic_category().message(error);
}

}  // namespace

File::File(const std::filesystem::path& path) : path_(path) {
  handle_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (handle_ < 0)
    throw Error(ErrorCode::io,
                path.string() + ": cannot open (" + cause(errno) + "); check the name and permissions");
  struct stat info {};
  const bool known = ::fstat(handle_, &info) == 0;
  if (!known || !S_ISREG(info.st_mode)) {
    ::close(handle_);
    throw Error(ErrorCode::io, path.string() + ": not a regular file; name a file on disk");
  }
  size_ = std::uint64_t(info.st_size);
}

File::~File() {
  ::close(handle_);
}

void File::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got = ::pread(handle_, bytes.data(), bytes.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw Error(ErrorCode::io, path_.string() + ": byte " + std::to_string(offset) + ": read failed (" +
                                     cause(errno) + "); check the disk");
    if (got == 0)
      throw Error(ErrorCode::io,
                  path_.string() + ": byte " + std::to_string(offset) +
                      ": the file ends here but was longer when opened; wait until it is written");
    bytes = bytes.subspan(std::size_t(got));
    offset += std::uint64_t(got);
  }
}

std::string File::read_text(std::uint64_t offset, std::size_t count) const {
  std::string text(std::size_t(std::min<std::uint64_t>(count, size_ - std::min(offset, size_))), '\0');
  read(offset, std::as_writable_bytes(std::span(text)));
  return text;
}

AtomicWriter::AtomicWriter(const std::filesystem::path& path) : path_(path) {
  static std::atomic<unsigned> serial{0};
  const std::string name = "." + path.filename().string() + "." + std::to_string(::getpid()) + "." +
                           std::to_string(serial++) + ".tmp";
  const std::filesystem::path temporary = path.parent_path() / name;
  handle_ = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (handle_ < 0) fail("cannot create a file beside it");
  temporary_ = temporary;
  buffer_.reserve(buffer_size);
}

AtomicWriter::~AtomicWriter() {
  if (handle_ >= 0) ::close(handle_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicWriter::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t part = std::min(bytes.size(), buffer_size - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(part));
    bytes = bytes.subspan(part);
    if (buffer_.size() == buffer_size) flush();
  }
}

void AtomicWriter::flush() {
  for (std::span<const std::byte> left(buffer_); !left.empty();) {
    const ssize_t done = ::write(handle_, left.data(), left.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) fail("write failed");
    left = left.subspan(std::size_t(done));
  }
  buffer_.clear();
}

void AtomicWriter::commit() {
  flush();
  if (::fsync(handle_) != 0) fail("write failed");
  if (::close(std::exchange(handle_, -1)) != 0) fail("write failed");
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot give the finished file its name");
  temporary_.clear();
  // The name itself reaches the disk with its folder; a file system that cannot sync folders is no error.
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  if (const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
}

void AtomicWriter::fail(std::string_view what) const {
  const int error = errno;
  throw Error(ErrorCode::io, path_.string() + ": " + std::string(what) + " (" + cause(error) +
                                 "); check the folder, permissions and free space");
}

}  // namespace sfumato::io
