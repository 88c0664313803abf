#include "io/excerpt.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/subsample.h"
#include "io/format.h"
#include "io/las.h"
#include "io/las_header.h"
#include "io/laz_table.h"
#include "io/ply_header.h"
#include "io/record_tap.h"

namespace sfumato::io {
namespace {

/// Below that, reading all of it is as good.
constexpr std::uint64_t least_ratio = 4;
/// Places in a file that are looked at: enough that they do not show as stripes, few enough for a disk that
/// seeks.
constexpr std::uint64_t most_runs = 1000;
/// By which the length of lines is judged.
constexpr std::size_t beginning_bytes = 1 << 16;
/// Of text, the beginning with its header and what columns are guessed from.
constexpr std::size_t text_head_bytes = 1 << 14;

/// A file that is nowhere but in memory and goes with this.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : handle_(::memfd_create("excerpt", MFD_CLOEXEC)) {
    for (std::size_t at = 0; handle_ >= 0 && at < bytes.size();) {
      const ssize_t done = ::write(handle_, bytes.data() + at, bytes.size() - at);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) ::close(std::exchange(handle_, -1));
      at += std::size_t(std::max<ssize_t>(done, 0));
    }
    if (handle_ < 0) throw Error(ErrorCode::io, "no memory for an excerpt");
  }
  ~MemoryFile() { ::close(handle_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(handle_); }

 private:
  int handle_ = -1;
};

/// Runs of equal length from everywhere in a range.
struct Runs {
  std::uint64_t count = 0, length = 0, total = 0;

  static std::uint64_t count_for(std::uint64_t points) {
    return std::clamp<std::uint64_t>(points / 16, 1, most_runs);
  }
  std::uint64_t begin(std::uint64_t k) const { return Subsample(total / length, count).place(k) * length; }
};

/// Records of `size` bytes from `begin` on: about `points` of `total`, as they lie in the file; none where it
/// is cut short.
std::string records_of(const File& file, std::uint64_t begin, std::size_t size, std::uint64_t total,
                       std::size_t points, Progress& progress) {
  if (begin > file.size() || (file.size() - begin) / size < total) return {};
  const std::uint64_t count = Runs::count_for(points);
  const Runs runs{count, std::max<std::uint64_t>(1, points / count), total};
  std::string bytes(std::size_t(runs.count * runs.length) * size, '\0');
  for (std::uint64_t k = 0; k < runs.count; ++k) {
    progress.check();
    const std::span<char> run(bytes.data() + k * runs.length * size, std::size_t(runs.length) * size);
    file.read(begin + runs.begin(k) * size, std::as_writable_bytes(run));
  }
  return bytes;
}

struct Lines {
  std::string text;
  std::size_t count = 0;
};

/// Whole lines from `begin` to the end of the file, about `points` of them, those that `is_wanted`. Nothing
/// where the file has few more, going by the length of its first lines.
template <class Wanted>
std::optional<Lines> lines_of(const File& file, std::uint64_t begin, std::size_t points, Progress& progress,
                              Wanted is_wanted) {
  const std::string first = file.read_text(begin, beginning_bytes);
  const auto ends = std::uint64_t(std::count(first.begin(), first.end(), '\n'));
  const std::uint64_t bytes = file.size() - std::min(begin, file.size());
  if (ends == 0) return std::nullopt;
  const std::uint64_t line_bytes = first.size() / ends, wanted = points * line_bytes;
  if (bytes < least_ratio * wanted || wanted == 0) return std::nullopt;
  const std::uint64_t count = Runs::count_for(points);
  const Runs runs{count, (points / count + 2) * line_bytes, bytes};  // two: what is cut at the ends
  Lines lines;
  for (std::uint64_t k = 0; k < runs.count; ++k) {
    progress.check();
    const std::string run = file.read_text(begin + runs.begin(k), std::size_t(runs.length));
    for (std::size_t at = run.find('\n'), end; at != std::string::npos; at = end) {
      end = run.find('\n', at + 1);
      if (end == std::string::npos) break;
      const std::string_view line = std::string_view(run).substr(at + 1, end - at);
      if (line.find_first_not_of(" \t\r\n") == std::string_view::npos || !is_wanted(line)) continue;
      lines.text += line;
      ++lines.count;
    }
  }
  return lines;
}

ReadResult read_excerpt(ReadFunction read, const std::string& bytes, std::uint64_t points_in_file,
                        const ReadOptions& options, Progress& progress) {
  const MemoryFile file(bytes);
  ReadResult result = read(file.path(), options, progress);
  result.report.points = std::max(points_in_file, result.report.points);
  return result;
}

std::optional<ReadResult> excerpt_laz(const std::filesystem::path& path, const las::InputFile& file,
                                      const las::Header& header, std::size_t points, Progress& progress) {
  const las::LazLayout layout = las::read_laz_layout(file, header);
  std::string reason;
  std::optional<std::vector<las::LazChunk>> chunks;
  if (layout.is_chunked) chunks = las::read_chunk_table(file, header, layout, reason);
  if (!chunks || chunks->empty()) return std::nullopt;
  ReadResult result = excerpt_chunks(path, *chunks, points, progress);
  result.report.points = header.count;
  return result;
}

/// A LAS file of these records: the head of another one, which may be compressed, with its numbers put right.
ReadResult read_las_records(std::string head, const std::string& records, std::size_t record_length,
                            std::uint64_t points_in_file, const ReadOptions& options, Progress& progress) {
  const std::uint64_t count = records.size() / record_length;
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  head[104] = char(head[104] & 0x7f);
  put(107, std::uint32_t(count));
  const bool has_long_count = head[25] == 4;
  if (has_long_count) put(247, count), put(243, std::uint32_t(0));  // no extended records behind them
  return read_excerpt(read_las, head + records, points_in_file, options, progress);
}

}  // namespace

ReadResult excerpt_chunks(const std::filesystem::path& path, const std::vector<las::LazChunk>& chunks,
                          std::size_t points, Progress& progress) {
  // The first points of every chunk: what follows them there need not be decoded.
  std::vector<las::LazChunk> begun;
  const std::uint64_t wanted_chunks = std::min<std::uint64_t>(chunks.size(), most_runs);
  for (std::uint64_t k = 0; k < wanted_chunks; ++k) {
    las::LazChunk& chunk =
        begun.emplace_back(chunks[std::size_t(Subsample(chunks.size(), wanted_chunks).place(k))]);
    chunk.held = chunk.count;
    chunk.count = std::uint32_t(
        std::min<std::uint64_t>(chunk.count, std::max<std::uint64_t>(1, points / wanted_chunks)));
  }
  return read_las_chunks(path, begun, progress);
}

std::optional<ReadResult> excerpt_las(const std::filesystem::path& path, std::size_t points,
                                      const ReadOptions& options, Progress& progress) {
  const las::InputFile file(path);
  const las::Header header = las::read_header(file);
  if (header.count < least_ratio * points) return std::nullopt;
  if (header.compressed) return excerpt_laz(path, file, header, points, progress);
  const std::string records =
      records_of(file, header.point_data, header.record_length, header.count, points, progress);
  return read_las_records(file.read_text(0, std::size_t(header.point_data)), records, header.record_length,
                          header.count, options, progress);
}

void RecordTap::begin(std::string head, std::size_t record_length, std::uint64_t total) {
  const std::lock_guard lock(mutex_);
  head_ = std::move(head), record_length_ = record_length, total_ = total;
  kept_.emplace(total, std::min<std::uint64_t>(wanted_, total));
  records_.clear();
}

void RecordTap::take(std::uint64_t first, const std::uint8_t* records, std::size_t count) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t end = kept_->before(first + count);
  for (std::uint64_t k = kept_->before(first); k < end; ++k)
    records_.append(reinterpret_cast<const char*>(records) + (kept_->place(k) - first) * record_length_,
                    record_length_);
}

std::optional<ReadResult> RecordTap::so_far() const {
  std::string head, records;
  std::uint64_t total = 0;
  {
    const std::lock_guard lock(mutex_);
    head = head_, records = records_, total = total_;
  }
  if (records.empty()) return std::nullopt;
  return read_las_records(std::move(head), records, record_length_, total, {}, no_progress());
}

std::optional<ReadResult> excerpt_ply(const std::filesystem::path& path, std::size_t points,
                                      const ReadOptions& options, Progress& progress) {
  const File file(path);
  const PlyHeader header = read_ply_header(file);
  const PlyElement& vertex = header.elements[header.vertex];
  // Elements before the vertices, and lists among their properties, would have to be walked over.
  if (header.vertex != 0 || vertex.has_list() || vertex.count < least_ratio * points) return std::nullopt;
  std::string body;
  std::size_t count = 0;
  if (header.ascii) {
    // Where the vertices end is not known, or where one does.
    if (header.elements.size() > 1 || header.vertex_lines > 1) return std::nullopt;
    const auto lines =
        lines_of(file, header.data_begin, points, progress, [](std::string_view) { return true; });
    if (!lines) return std::nullopt;
    body = lines->text, count = lines->count;
  } else {
    body = records_of(file, header.data_begin, vertex.record_size(), vertex.count, points, progress);
    count = body.size() / vertex.record_size();
  }
  // The header with another number of vertices and without the elements behind them.
  std::string bytes;
  const std::string old = file.read_text(0, std::size_t(header.data_begin));
  int elements = 0;
  for (std::size_t at = 0, end; at < old.size(); at = end) {
    end = std::min(old.find('\n', at), old.size() - 1) + 1;
    const std::string_view line = std::string_view(old).substr(at, end - at);
    if (line.starts_with("element ")) {
      if (++elements == 1) bytes += "element vertex " + std::to_string(count) + "\n";
    } else if (elements < 2 || !line.starts_with("property ")) {
      bytes += line;
    }
  }
  return read_excerpt(read_ply, bytes + body, vertex.count, options, progress);
}

std::optional<ReadResult> excerpt_pcd(const std::filesystem::path& path, std::size_t points,
                                      const ReadOptions& options, Progress& progress) {
  const File file(path);
  const std::string head = file.read_text(0, 1 << 16);
  std::string kept, data;
  std::vector<std::uint64_t> sizes, counts;
  std::uint64_t width = 0, height = 1;
  std::size_t at = 0;
  while (data.empty()) {
    const std::size_t end = head.find('\n', at);
    if (end == std::string::npos) return std::nullopt;
    std::string line = head.substr(at, end - at);
    at = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::string key = line.substr(0, blank), values = line.substr(blank);
    const auto numbers = [&] {
      std::vector<std::uint64_t> all;
      const char* from = values.c_str();
      for (char* behind = nullptr;; from = behind) {
        const std::uint64_t value = std::strtoull(from, &behind, 10);
        if (behind == from) return all;
        all.push_back(std::min<std::uint64_t>(value, 1ull << 32));
      }
    };
    if (key == "DATA")
      data = values.substr(std::min<std::size_t>(1, values.size()));
    else if (key == "WIDTH" && !numbers().empty())
      width = numbers()[0];
    else if (key == "HEIGHT" && !numbers().empty())
      height = numbers()[0];
    else if (key == "SIZE")
      sizes = numbers(), kept += line + "\n";
    else if (key == "COUNT")
      counts = numbers(), kept += line + "\n";
    else if (key != "POINTS")
      kept += line + "\n";
  }
  const std::uint64_t total = width * height;
  if (total < least_ratio * points) return std::nullopt;
  std::string body;
  std::size_t count = 0;
  if (data == "ascii") {
    const auto lines =
        lines_of(file, at, points, progress, [](std::string_view line) { return line[0] != '#'; });
    if (!lines) return std::nullopt;
    body = lines->text, count = lines->count;
  } else if (data == "binary") {
    std::uint64_t size = 0;
    for (std::size_t k = 0; k < sizes.size(); ++k) size += sizes[k] * (k < counts.size() ? counts[k] : 1);
    if (size == 0 || size > 1 << 16) return std::nullopt;
    body = records_of(file, at, std::size_t(size), total, points, progress);
    count = body.size() / size;
  } else {
    return std::nullopt;  // all x, then all y, in one piece
  }
  const std::string number = std::to_string(count);
  return read_excerpt(
      read_pcd, kept + "WIDTH " + number + "\nHEIGHT 1\nPOINTS " + number + "\nDATA " + data + "\n" + body,
      total, options, progress);
}

std::optional<ReadResult> excerpt_obj(const std::filesystem::path& path, std::size_t points,
                                      const ReadOptions& options, Progress& progress) {
  const File file(path);
  const auto lines = lines_of(file, 0, points, progress, [](std::string_view line) {
    return line.starts_with("v ") || line.starts_with("v\t");
  });
  if (!lines || lines->count == 0) return std::nullopt;
  return read_excerpt(read_obj, lines->text, 0, options, progress);
}

std::optional<ReadResult> excerpt_text(const std::filesystem::path& path, std::size_t points,
                                       const ReadOptions& options, Progress& progress) {
  const File file(path);
  std::string head = file.read_text(0, text_head_bytes);
  head.resize(head.rfind('\n') + 1);
  if (head.empty()) return std::nullopt;
  const auto lines = lines_of(file, head.size(), points, progress, [](std::string_view) { return true; });
  if (!lines) return std::nullopt;
  return read_excerpt(read_text, head + lines->text, 0, options, progress);
}

}  // namespace sfumato::io
