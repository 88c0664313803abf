#include "copc/spool.h"

#include <fcntl.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <system_error>

#include "core/error.h"

namespace sfumato::copc {
namespace {

// A bin beyond this goes to the disk at once; smaller ones when all together are too many.
constexpr std::size_t full_bin = 4 << 20;

std::string gigabytes(double bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g GB", bytes / 1e9);
  return text;
}

std::string cause(int error) { return std::generic_category().message(error); }

}  // namespace

TemporaryFile::TemporaryFile(const std::filesystem::path& folder, std::filesystem::path purpose)
    : folder_(folder.empty() ? "." : folder), purpose_(std::move(purpose)) {
  handle_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (handle_ < 0) {  // a file system without such files: a name, for a moment
    std::string name = (folder_ / ".sfumato-XXXXXX").string();
    handle_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (handle_ >= 0) ::unlink(name.c_str());
  }
  if (handle_ < 0)
    throw Error(ErrorCode::io, purpose_.string() + ": cannot create temporary files beside it (" +
                                   cause(errno) + "); check the folder and its permissions");
}

TemporaryFile::~TemporaryFile() { ::close(handle_); }

void TemporaryFile::write(std::uint64_t at, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::pwrite(handle_, bytes.data(), bytes.size(), off_t(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0)
      throw Error(ErrorCode::io, purpose_.string() + ": cannot keep points beside it, " +
                                     gigabytes(double(at)) + " are there (" + cause(errno) +
                                     "); free room in " + folder_.string() + " or write to another disk");
    bytes = bytes.subspan(std::size_t(done));
    at += std::uint64_t(done);
  }
}

void TemporaryFile::read(std::uint64_t at, std::span<std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t done = ::pread(handle_, bytes.data(), bytes.size(), off_t(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0)
      throw Error(ErrorCode::io, purpose_.string() + ": cannot read the points kept beside it (" +
                                     (done < 0 ? cause(errno) : "they end early") + "); check the disk");
    bytes = bytes.subspan(std::size_t(done));
    at += std::uint64_t(done);
  }
}

void TemporaryFile::forget(std::uint64_t at, std::uint64_t size) {
  if (size > 0) ::fallocate(handle_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, off_t(at), off_t(size));
}

void Spool::append(const Key& key, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  Bin& bin = bins_[key];
  const std::size_t before = bin.tail.capacity();
  bin.tail.insert(bin.tail.end(), bytes.begin(), bytes.end());
  bin.size += bytes.size();
  held_ += bin.tail.capacity() - before;
  if (held_ <= memory_) return;
  if (bin.tail.size() >= full_bin) write_out(bin);
  if (held_ <= memory_) return;
  for (auto& [other, each] : bins_) write_out(each);
#ifdef __GLIBC__
  // Tails that grew beside each other leave holes that no later tail fits into: 4.5 GB for 1 GB of tails,
  // when a thousand million points were read.
  ::malloc_trim(0);
#endif
}

void Spool::write_out(Bin& bin) {
  if (bin.tail.empty()) return;
  if (!file_) file_ = std::make_unique<TemporaryFile>(folder_, purpose_);
  file_->write(end_, bin.tail);
  if (!bin.extents.empty() && bin.extents.back().at + bin.extents.back().size == end_)
    bin.extents.back().size += bin.tail.size();
  else
    bin.extents.push_back({end_, bin.tail.size()});
  end_ += bin.tail.size();
  held_ -= bin.tail.capacity();
  bin.tail = {};
}

Spool::Bin Spool::take(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto found = bins_.find(key);
  if (found == bins_.end()) return {};
  Bin bin = std::move(found->second);
  bins_.erase(found);
  held_ -= bin.tail.capacity();
  return bin;
}

std::vector<std::uint8_t> Spool::load(Bin&& bin) {
  if (bin.extents.empty()) return std::move(bin.tail);
  std::vector<std::uint8_t> bytes(bin.size);
  std::size_t at = 0;
  for (const Bin::Extent& extent : bin.extents) {
    file_->read(extent.at, {bytes.data() + at, std::size_t(extent.size)});
    file_->forget(extent.at, extent.size);
    at += extent.size;
  }
  std::copy(bin.tail.begin(), bin.tail.end(), bytes.begin() + std::ptrdiff_t(at));
  return bytes;
}

std::vector<std::uint8_t> Spool::load_some(Bin& bin, std::size_t limit, std::size_t unit) {
  if (!bin.tail.empty()) {
    bin.size -= bin.tail.size();
    return std::move(bin.tail);
  }
  if (bin.extents.empty()) return {};
  Bin::Extent& extent = bin.extents.back();
  const std::size_t size =
      std::min<std::uint64_t>(extent.size, std::max(limit / unit, std::size_t{1}) * unit);
  std::vector<std::uint8_t> bytes(size);
  file_->read(extent.at + extent.size - size, bytes);
  file_->forget(extent.at + extent.size - size, size);
  extent.size -= size;
  bin.size -= size;
  if (extent.size == 0) bin.extents.pop_back();
  return bytes;
}

std::vector<std::pair<Key, std::uint64_t>> Spool::bins() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<Key, std::uint64_t>> all;
  for (const auto& [key, bin] : bins_) all.emplace_back(key, bin.size);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace sfumato::copc
