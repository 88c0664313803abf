#include "io/atomic_writer.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "io/file.h"

namespace sfumato::io {
namespace {

constexpr std::size_t buffer_size = 1 << 20;
// Short, whatever the file is called: names may have 255 bytes.
constexpr std::string_view temporary_begin = ".sfumato-", temporary_end = ".tmp";

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

std::filesystem::path name_of_handle(int handle) { return "/proc/self/fd/" + std::to_string(handle); }

std::filesystem::path temporary_in(const std::filesystem::path& folder) {
  static std::atomic<unsigned> serial{0};
  return folder / (std::string(temporary_begin) + std::to_string(::getpid()) + "-" +
                   std::to_string(serial++) + std::string(temporary_end));
}

/// Deletes the temporaries of processes that were killed between naming and renaming. Writers hold a lock on
/// theirs, and the kernel lets go of it when they die.
void sweep(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> swept;
  const std::lock_guard lock(mutex);
  if (!swept.insert(folder).second) return;
  DIR* directory = ::opendir(folder.c_str());
  if (!directory) return;
  while (const dirent* entry = ::readdir(directory)) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(temporary_begin) || !name.ends_with(temporary_end)) continue;
    const int handle =
        ::openat(::dirfd(directory), entry->d_name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (handle < 0) continue;
    if (::flock(handle, LOCK_EX | LOCK_NB) == 0) ::unlinkat(::dirfd(directory), entry->d_name, 0);
    ::close(handle);
  }
  ::closedir(directory);
}

}  // namespace

bool is_standard_output(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
  std::filesystem::path at = path;
  std::error_code error;
  for (int i = 0; i < 40; ++i) {  // as many as the kernel follows
    if (!std::filesystem::is_symlink(std::filesystem::symlink_status(at, error))) return at;
    const std::filesystem::path next = std::filesystem::read_symlink(at, error);
    if (error) return at;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  throw Error(ErrorCode::io, path.string() + ": its symbolic links lead in a circle; name another file");
}

void refuse_special_file(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode)) return;
  const char* kind = S_ISDIR(info.st_mode)    ? "a folder"
                     : S_ISFIFO(info.st_mode) ? "a FIFO"
                     : S_ISSOCK(info.st_mode) ? "a socket"
                                              : "a device";
  throw Error(ErrorCode::usage, path.string() + ": is " + kind +
                                    ", which is not replaced; name a file, or - for standard output");
}

AtomicWriter::AtomicWriter(const std::filesystem::path& path)
    : path_(path), to_standard_output_(is_standard_output(path)) {
  if (to_standard_output_) {
    if (::isatty(STDOUT_FILENO))
      throw Error(ErrorCode::usage,
                  path.string() + ": standard output is a terminal; redirect it, or name a file");
    handle_ = ::memfd_create("standard output", MFD_CLOEXEC);
    if (handle_ < 0) fail("cannot get memory for it");
  } else {
    target_ = follow_links(path);
    refuse_special_file(target_);
    open_beside();
  }
  buffer_.reserve(buffer_size);
}

void AtomicWriter::open_beside() {
  struct stat old {};
  exists_ = ::stat(target_.c_str(), &old) == 0;
  if (exists_ && ::access(target_.c_str(), W_OK) != 0) fail("cannot replace it");
  // A name that is too long must not show only when everything has been written.
  if (!exists_ && errno != ENOENT) fail("cannot create it");
  const std::filesystem::path folder = folder_of(target_);
  if (std::error_code error; !std::filesystem::is_directory(folder, error))
    throw Error(ErrorCode::io, path_.string() + ": there is no folder " + folder.string() +
                                   "; make it, or name a file elsewhere");
  sweep(folder);
  handle_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (handle_ >= 0 && ::access(name_of_handle(handle_).c_str(), F_OK) != 0)
    ::close(std::exchange(handle_, -1));
  if (handle_ < 0) {
    const std::filesystem::path temporary = temporary_in(folder);
    handle_ = ::open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (handle_ < 0) fail("cannot create a file beside it");
    temporary_ = temporary;
  }
  ::flock(handle_, LOCK_EX | LOCK_NB);
  if (!exists_) return;
  if ((old.st_uid != ::geteuid() || old.st_gid != ::getegid()) &&
      ::fchown(handle_, old.st_uid, old.st_gid) != 0)
    errno = 0;  // only root gives files away; the mode below still holds
  if (::fchmod(handle_, old.st_mode & 07777) != 0) fail("cannot keep its mode");
}

AtomicWriter::~AtomicWriter() {
  if (handle_ >= 0) ::close(handle_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicWriter::write(std::span<const std::byte> bytes) {
  at_ += bytes.size();
  size_ = std::max(size_, at_);
  while (!bytes.empty()) {
    const std::size_t part = std::min(bytes.size(), buffer_size - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(part));
    bytes = bytes.subspan(part);
    if (buffer_.size() == buffer_size) flush();
  }
}

void AtomicWriter::seek(std::uint64_t byte) {
  flush();
  if (::lseek(handle_, off_t(byte), SEEK_SET) < 0) fail("write failed");
  at_ = byte;
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
  if (to_standard_output_) return copy_to_standard_output();
  if (::fsync(handle_) != 0) fail("write failed");
  give_name();
  temporary_.clear();
  if (::close(std::exchange(handle_, -1)) != 0) fail("write failed");
  // The name itself reaches the disk with its folder; a file system that cannot sync folders is no error.
  if (const int directory = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
      directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
}

void AtomicWriter::give_name() {
  if (temporary_.empty()) {
    const std::filesystem::path nameless = name_of_handle(handle_);
    const auto link_to = [&](const std::filesystem::path& name) {
      return ::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    };
    if (!exists_ && link_to(target_)) return;
    // No call replaces an existing name by a file without one: it needs a name for a moment.
    const std::filesystem::path temporary = temporary_in(folder_of(target_));
    if (!link_to(temporary)) fail("cannot give the finished file its name");
    temporary_ = temporary;
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot give the finished file its name");
}

void AtomicWriter::copy_to_standard_output() {
  std::vector<char> block(buffer_size);
  for (off_t at = 0;;) {
    ssize_t got = ::pread(handle_, block.data(), block.size(), at);
    if (got < 0) fail("cannot read it back");
    if (got == 0) return;
    at += got;
    for (const char* from = block.data(); got > 0;) {
      const ssize_t done = ::write(STDOUT_FILENO, from, std::size_t(got));
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) fail("write failed");
      from += done, got -= done;
    }
  }
}

void AtomicWriter::fail(std::string_view what) const {
  const int error = errno;
  throw Error(ErrorCode::io, path_.string() + ": " + std::string(what) + " (" + cause_of(error) +
                                 "); check the folder, permissions and free space");
}

WriterBuffer::WriterBuffer(AtomicWriter& writer) : writer_(writer), block_(1 << 16) {
  setp(block_.data(), block_.data() + block_.size());
}

int WriterBuffer::sync() {
  if (error_) return -1;
  try {
    writer_.write(std::string_view(pbase(), std::size_t(pptr() - pbase())));
  } catch (...) {
    error_ = std::current_exception();
  }
  setp(block_.data(), block_.data() + block_.size());
  return error_ ? -1 : 0;
}

WriterBuffer::int_type WriterBuffer::overflow(int_type byte) {
  if (sync() != 0) return traits_type::eof();
  if (!traits_type::eq_int_type(byte, traits_type::eof())) sputc(traits_type::to_char_type(byte));
  return traits_type::not_eof(byte);
}

std::streamsize WriterBuffer::xsputn(const char* bytes, std::streamsize count) {
  if (count < epptr() - pptr()) return std::streambuf::xsputn(bytes, count);
  if (sync() != 0) return 0;
  try {
    writer_.write(std::string_view(bytes, std::size_t(count)));
  } catch (...) {
    error_ = std::current_exception();
    return 0;
  }
  return count;
}

WriterBuffer::pos_type WriterBuffer::seekoff(off_type offset, std::ios_base::seekdir from,
                                             std::ios_base::openmode) {
  const off_type here = off_type(writer_.tell()) + (pptr() - pbase());
  if (from == std::ios_base::cur && offset == 0) return pos_type(here);
  const off_type end = std::max(here, off_type(writer_.size()));
  const off_type base = from == std::ios_base::beg ? 0 : from == std::ios_base::end ? end : here;
  return seekpos(pos_type(base + offset), std::ios_base::out);
}

WriterBuffer::pos_type WriterBuffer::seekpos(pos_type position, std::ios_base::openmode) {
  if (sync() != 0 || off_type(position) < 0) return pos_type(off_type(-1));
  try {
    writer_.seek(std::uint64_t(off_type(position)));
  } catch (...) {
    error_ = std::current_exception();
    return pos_type(off_type(-1));
  }
  return position;
}

void WriterBuffer::finish() {
  sync();
  rethrow();
}

void WriterBuffer::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

}  // namespace sfumato::io
