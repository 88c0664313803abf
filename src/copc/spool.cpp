#include "copc/spool.h"

#include <fcntl.h>
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
// Pieces of a bin: the first is small, for there may be many bins of few points.
constexpr std::size_t first_piece = 4 << 10, largest_piece = 64 << 10;

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

void Pieces::append(std::span<const std::uint8_t> bytes) {
  size_ += bytes.size();
  while (!bytes.empty()) {
    if (pieces_.empty() || pieces_.back().size == pieces_.back().room) {
      const std::size_t room =
          pieces_.empty() ? first_piece : std::min(2 * pieces_.back().room, largest_piece);
      pieces_.push_back({std::make_unique_for_overwrite<std::uint8_t[]>(room), 0, room});
      room_ += room;
    }
    Piece& last = pieces_.back();
    const std::size_t count = std::min(bytes.size(), last.room - last.size);
    std::copy_n(bytes.begin(), count, last.bytes.get() + last.size);
    last.size += count;
    bytes = bytes.subspan(count);
  }
}

void Pieces::copy_to(std::uint8_t* to) const {
  for_each([&](std::span<const std::uint8_t> piece) { to = std::copy(piece.begin(), piece.end(), to); });
}

void Spool::append(const Key& key, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  Bin& bin = bins_[key];
  const std::size_t before = bin.tail.room();
  bin.tail.append(bytes);
  bin.size += bytes.size();
  held_ += bin.tail.room() - before;
  if (held_ <= memory_) return;
  if (bin.tail.size() >= full_bin) write_out(bin);
  if (held_ <= memory_) return;
  for (auto& [other, each] : bins_) write_out(each);
}

void Spool::write_out(Bin& bin) {
  if (bin.tail.empty()) return;
  if (!file_) file_ = std::make_unique<TemporaryFile>(folder_, purpose_);
  std::uint64_t at = end_;
  bin.tail.for_each([&](std::span<const std::uint8_t> piece) {
    file_->write(at, piece);
    at += piece.size();
  });
  if (!bin.extents.empty() && bin.extents.back().at + bin.extents.back().size == end_)
    bin.extents.back().size += bin.tail.size();
  else
    bin.extents.push_back({end_, bin.tail.size()});
  end_ = at;
  held_ -= bin.tail.room();
  bin.tail = {};
}

Spool::Bin Spool::take(const Key& key) {
  const std::lock_guard lock(mutex_);
  const auto found = bins_.find(key);
  if (found == bins_.end()) return {};
  Bin bin = std::move(found->second);
  bins_.erase(found);
  held_ -= bin.tail.room();
  return bin;
}

std::vector<std::uint8_t> Spool::load(Bin&& bin) {
  std::vector<std::uint8_t> bytes(bin.size);
  std::size_t at = 0;
  for (const Bin::Extent& extent : bin.extents) {
    file_->read(extent.at, {bytes.data() + at, std::size_t(extent.size)});
    file_->forget(extent.at, extent.size);
    at += extent.size;
  }
  bin.tail.copy_to(bytes.data() + at);
  return bytes;
}

std::vector<std::uint8_t> Spool::load_some(Bin& bin, std::size_t limit, std::size_t unit) {
  if (!bin.tail.empty()) {
    std::vector<std::uint8_t> bytes(bin.tail.size());
    bin.tail.copy_to(bytes.data());
    bin.size -= bytes.size();
    bin.tail = {};
    return bytes;
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
