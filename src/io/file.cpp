#include "io/file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "io/byte_source.h"

namespace sfumato::io {
namespace {

/// All of standard input in memory; -1 with errno when it cannot be had. A redirected file is taken as it is.
int take_standard_input() {
  struct stat info {};
  if (::fstat(STDIN_FILENO, &info) == 0 && S_ISREG(info.st_mode))
    return ::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
  const int memory = ::memfd_create("standard input", MFD_CLOEXEC);
  std::vector<char> block(1 << 20);
  while (memory >= 0) {
    ssize_t got = ::read(STDIN_FILENO, block.data(), block.size());
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) return memory;
    for (const char* at = block.data(); got > 0;) {
      const ssize_t done = ::write(memory, at, std::size_t(got));
      if (done < 0 && errno != EINTR) break;
      at += std::max<ssize_t>(done, 0), got -= std::max<ssize_t>(done, 0);
    }
    if (got != 0) break;
  }
  return -1;
}

int open_standard_input() {
  static const int kept = take_standard_input();
  return kept < 0 ? -1 : ::fcntl(kept, F_DUPFD_CLOEXEC, 3);
}

class DiskSource final : public ByteSource {
 public:
  DiskSource(int handle, std::filesystem::path path) : handle_(handle), path_(std::move(path)) {
    name = path_;
  }
  ~DiskSource() override { ::close(handle_); }

  void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    while (!bytes.empty()) {
      const ssize_t got = ::pread(handle_, bytes.data(), bytes.size(), off_t(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        throw Error(ErrorCode::io, path_.string() + ": byte " + std::to_string(offset) + ": read failed (" +
                                       cause_of(errno) + "); check the disk");
      if (got == 0)
        throw Error(ErrorCode::io,
                    path_.string() + ": byte " + std::to_string(offset) +
                        ": the file ends here but was longer when opened; wait until it is written");
      bytes = bytes.subspan(std::size_t(got));
      offset += std::uint64_t(got);
    }
  }

 private:
  int handle_;
  std::filesystem::path path_;
};

}  // namespace

std::shared_ptr<ByteSource> disk_source(int handle, const std::filesystem::path& path) {
  return std::make_shared<DiskSource>(handle, path);
}

int open_temporary() {
  std::string name = (std::filesystem::temp_directory_path() / "sfumato-input-XXXXXX").string();
  const int handle = ::mkostemp(name.data(), O_CLOEXEC);
  if (handle < 0)
    throw Error(ErrorCode::io, name + ": cannot make a temporary file (" + cause_of(errno) + "); set TMPDIR");
  ::unlink(name.c_str());
  return handle;
}

void append_to(int handle, const void* bytes, std::size_t count) {
  for (auto at = static_cast<const char*>(bytes); count > 0;) {
    const ssize_t done = ::write(handle, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0)
      throw Error(ErrorCode::io,
                  "what is unpacked or fetched does not fit into the folder of temporary files (" +
                      cause_of(errno) + "); set TMPDIR to another");
    at += done, count -= std::size_t(done);
  }
}

std::string cause_of(int error) { return std::generic_category().message(error); }

bool is_standard_input(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdin" || path == "/dev/fd/0" || path == "/proc/self/fd/0";
}

File::File(const std::filesystem::path& path) : path_(path) {
  std::shared_ptr<ByteSource> source;
  if (is_remote(path)) {
    source = remote_source(path);
  } else {
    const int handle = is_standard_input(path) ? open_standard_input()
                                               : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (handle < 0)
      throw Error(ErrorCode::io,
                  path.string() + ": cannot open (" + cause_of(errno) + "); check the name and permissions");
    source = disk_source(handle, path);
    struct stat info {};
    const bool known = ::fstat(handle, &info) == 0;
    if (!known || !S_ISREG(info.st_mode))
      throw Error(ErrorCode::io, path.string() + ": not a regular file; name a file on disk");
    source->size = std::uint64_t(info.st_size);
  }
  source_ = source;
  if (const auto inside = unpacked_source(source, path)) source_ = inside;
}

const std::filesystem::path& File::name() const { return source_->name; }
std::uint64_t File::size() const { return source_->size; }
void File::read(std::uint64_t offset, std::span<std::byte> bytes) const { source_->read(offset, bytes); }

std::string File::read_text(std::uint64_t offset, std::size_t count) const {
  std::string text(std::size_t(std::min<std::uint64_t>(count, size() - std::min(offset, size()))), '\0');
  read(offset, std::as_writable_bytes(std::span(text)));
  return text;
}

}  // namespace sfumato::io
