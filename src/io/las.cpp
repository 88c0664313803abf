#include "io/las.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "core/subsample.h"
#include "io/decoder_pool.h"
#include "io/excerpt.h"
#include "io/format.h"
#include "io/las_points.h"
#include "io/las_records.h"
#include "io/record_tap.h"

namespace sfumato::io {
namespace las {
namespace {

// Memory that is taken on the word of a compressed file: so much costs little when the word is wrong. Beyond
// it, and beyond what compresses 64-fold, the cloud grows only as points come out.
constexpr std::uint64_t trusted_bytes = 16 << 20, trusted_ratio = 64;
// Chunks of a file that may end their decoder.
constexpr int most_ended = 20;

bool is_trusted(const InputFile& file, std::uint64_t cloud_bytes) {
  return cloud_bytes <= std::max(trusted_bytes, trusted_ratio * file.size());
}

using Stats = PointCollector::Stats;

std::vector<std::uint8_t> first_record(const InputFile& file, const Header& header, std::uint64_t byte) {
  // The first point of a chunk, and so of a file, is stored as it is, compressed or not.
  std::vector<std::uint8_t> record(header.count ? header.record_length : 0);
  file.read(byte, record.data(), record.size());
  return record;
}

/// Records [begin, end) of `total`.
struct RecordRange {
  std::uint64_t begin = 0, end = 0, total = 0;
  bool is_part = false;  ///< of a file, which may be all of it
  std::uint64_t count() const { return end - begin; }
};

/// Which points are kept where all of them are too many for memory. Of a part of a file, those that are kept
/// of the whole.
class Thinning {
 public:
  /// Throws Error(out_of_memory) when the cloud does not fit and nobody asked for fewer points.
  Thinning(const InputFile& file, const Header& header, const RecordRange& range, std::size_t bytes_per_point,
           const ReadOptions& options)
      : range_(range), length_(header.record_length), tap_(options.tap) {
    if (tap_) tap_->begin(file.read_text(0, std::size_t(header.point_data)), length_, range.total);
    const std::uint64_t limit = memory_limit(), most = limit / bytes_per_point;
    const bool is_thinned =
        range.is_part && options.max_points && *options.max_points < range.total;  // else behind it
    // A number of points beyond what so large a file can hold is damage, and found as such where they end.
    const bool is_beyond = range.count() > most && is_trusted(file, range.count() * bytes_per_point);
    if (is_thinned || (is_beyond && options.max_points && *options.max_points <= most))
      kept_.emplace(range.total, *options.max_points);
    if (!is_beyond || kept_) return;
    char text[160];
    std::snprintf(text, sizeof text, ": %llu points take about %.3g GB, and %.3g GB are there for them; ",
                  static_cast<unsigned long long>(range.count()),
                  double(range.count()) * double(bytes_per_point) / 1e9, double(limit) / 1e9);
    throw Error(ErrorCode::out_of_memory,
                file.path().string() + text +
                    "give them levels (sfumato build IN... -o OUT.copc.laz) or take fewer (--max-points N)");
  }
  std::uint64_t points() const { return before(range_.end); }
  /// Points kept of those of the range before `i`.
  std::uint64_t before(std::uint64_t i) const {
    return kept_ ? kept_->before(i) - kept_->before(range_.begin) : i - range_.begin;
  }
  /// Hands those of the records that are kept to the collector; the others are overwritten.
  void store(PointCollector& points, std::uint64_t first, std::uint8_t* records, std::size_t count,
             Stats& stats) const {
    if (tap_) tap_->take(first, records, count);
    if (!kept_) return points.unpack(before(first), records, count, stats);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i)
      if (kept_->takes(first + i)) std::memmove(records + length_ * kept++, records + length_ * i, length_);
    points.unpack(before(first), records, kept, stats);
  }
  /// What the report says of all points, and where the kept ones lie in the file.
  void report(ReadResult& result) const {
    if (!kept_) return;
    result.report.points = result.report.points_finite = range_.count();
    const std::uint64_t first = kept_->before(range_.begin);
    result.cloud.source_index.resize(points());
    for (std::uint64_t k = 0; k < points(); ++k)
      result.cloud.source_index[k] = std::uint32_t(kept_->place(first + k));
    if (!range_.is_part)
      result.report.notes.push_back("all points take more memory than there is: " + std::to_string(points()) +
                                    " are kept while reading, and the statistics are theirs");
  }

 private:
  RecordRange range_;
  std::size_t length_;
  RecordTap* tap_;
  std::optional<Subsample> kept_;
};

/// `whole`: null where all of the file is read.
PointCollector collector_of(const InputFile& file, const Header& header, std::uint64_t first_byte,
                            const WholeFile* whole) {
  if (whole) return {header, *whole};
  return {header, first_record(file, header, first_byte)};
}

ReadResult read_uncompressed(const InputFile& file, const Header& header, const RecordRange& range,
                             const WholeFile* whole, const ReadOptions& options, Progress& progress) {
  PointCollector points = collector_of(file, header, header.point_data, whole);
  const Thinning thinning(file, header, range, points.bytes_per_point(), options);
  points.resize(thinning.points());  // the header check has seen that the file holds them
  const std::size_t block = records_at_a_time(header.record_length),
                    blocks = (range.count() + block - 1) / block;
  std::vector<Stats> stats(blocks, points.empty_stats());
  parallel_tasks(blocks, progress, "reading points", [&](std::size_t i) {
    const std::size_t first = range.begin + i * block,
                      count = std::min<std::size_t>(block, range.end - first);
    std::vector<std::uint8_t> records(count * header.record_length);
    file.read(header.point_data + first * header.record_length, records.data(), records.size());
    thinning.store(points, first, records.data(), count, stats[i]);
  });
  ReadResult result = points.finish(stats, progress);
  thinning.report(result);
  return result;
}

ReadResult read_chunks(
    const InputFile& file, const Header& header, const LazLayout& layout, const std::vector<LazChunk>& chunks,
    const ReadOptions& options, Progress& progress,
    std::vector<std::string>* damage = nullptr,  // when given: a place for each chunk's error
    const WholeFile* whole = nullptr, const KeptChunks& kept = {}) {
  RecordRange range;
  if (!chunks.empty()) range = {chunks.front().first, chunks.back().first + chunks.back().count};
  range.total = whole ? header.count : range.count(), range.is_part = whole;
  PointCollector points = collector_of(file, header, chunks.empty() ? 0 : chunks.front().byte, whole);
  const Thinning thinning(file, header, range, points.bytes_per_point(), options);
  const std::uint64_t total = thinning.points();
  const bool grows = !is_trusted(file, total * points.bytes_per_point());
  if (!grows) points.resize(total);
  std::vector<Stats> stats(chunks.size(), points.empty_stats());
  std::atomic<int> ended = 0;
  const auto decode_all = [&](std::size_t i) {
    const LazChunk& chunk = chunks[i];
    const ChunkCache::Key key{kept.file, chunk.byte};
    const ChunkCache::Records records = kept.cache ? kept.cache->find(key) : nullptr;
    // Of another length when the file is not the one that they were decoded from.
    if (records && records->size() == std::size_t(chunk.count) * layout.record_length) {
      std::vector<std::uint8_t> copy = *records;
      if (grows) points.resize(thinning.before(chunk.first + chunk.count));
      return thinning.store(points, chunk.first, copy.data(), chunk.count, stats[i]);
    }
    LazDecoder decoder(file, layout, chunk, false, progress);
    std::vector<std::uint8_t> decoded;
    std::size_t done = 0;
    for (std::span<std::uint8_t> some; !(some = decoder.next()).empty();) {
      progress.check();
      if (kept.cache) decoded.insert(decoded.end(), some.begin(), some.end());
      const std::size_t count = some.size() / layout.record_length;
      if (grows) points.resize(thinning.before(chunk.first + done + count));
      thinning.store(points, chunk.first + done, some.data(), count, stats[i]);
      done += count;
    }
    if (kept.cache && done == chunk.count) kept.cache->keep(key, std::move(decoded));
  };
  const auto decode = [&](std::size_t i) {
    try {
      decode_all(i);
    } catch (const Error& error) {
      if (!damage || error.code() != ErrorCode::bad_input) throw;
      (*damage)[i] = error.what();
      // Each may have cost two seconds: this is no accident.
      if ((*damage)[i].find("ended their decoder") != std::string::npos && ++ended > most_ended) throw;
    }
  };
  if (!grows)
    parallel_tasks(chunks.size(), progress, "decoding points", decode);
  else  // one after the other, as the cloud grows
    for (std::size_t i = 0; i < chunks.size(); ++i) decode(i);
  ReadResult result = points.finish(stats, progress);
  thinning.report(result);
  return result;
}

// One decoder from the first point to the last.
ReadResult read_run(const InputFile& file, const Header& header, const LazLayout& layout, const LazChunk& run,
                    const ReadOptions& options, Progress& progress) {
  PointCollector points(header, first_record(file, header, run.byte));
  const Thinning thinning(file, header, {0, header.count, header.count}, points.bytes_per_point(), options);
  LazDecoder decoder(file, layout, run, true, progress);
  Stats stats = points.empty_stats();
  std::uint64_t done = 0;
  for (std::span<std::uint8_t> records; !(records = decoder.next()).empty();) {
    progress.check();
    const std::size_t count = records.size() / header.record_length;
    points.resize(thinning.before(done + count));
    thinning.store(points, done, records.data(), count, stats);
    done += count;
    progress.update(double(done) / double(header.count), "decoding points");
  }
  ReadResult result = points.finish({stats}, progress);
  thinning.report(result);
  return result;
}

void note_decoders(ReadResult& result) {
  if (const std::string reason = why_no_decoders(); !reason.empty())
    result.report.notes.push_back("LASzip decodes in this process, which a damaged file may crash: " +
                                  reason);
}

// What of these chunks can be decoded.
ReadResult read_intact(const InputFile& file, const Header& header, const LazLayout& layout,
                       std::vector<LazChunk> wanted, const ReadOptions& options, Progress& progress,
                       const WholeFile* whole = nullptr, const KeptChunks& kept = {}) {
  std::vector<std::string> damage;
  std::uint64_t missing = 0;
  const std::uint64_t begin = whole && !wanted.empty() ? wanted.front().first : 0;
  while (true) {
    std::uint64_t first = begin;
    for (LazChunk& chunk : wanted) chunk.first = first, first += chunk.count;
    std::vector<std::string> errors(wanted.size());
    ReadResult result = read_chunks(file, header, layout, wanted, options, progress, &errors, whole, kept);
    std::vector<LazChunk> intact;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (errors[i].empty())
        intact.push_back(wanted[i]);
      else
        damage.push_back(errors[i]), missing += wanted[i].count;
    }
    if (intact.size() == wanted.size()) {
      result.report.damage = std::move(damage);
      result.report.points += missing;
      result.report.points_missing = missing;
      return result;
    }
    wanted = std::move(intact);  // once more without them: damage is rare
  }
}

ReadResult read_compressed(const InputFile& file, const Header& header, const ReadOptions& options,
                           Progress& progress) {
  const LazChunks found = find_chunks(file, header);
  ReadResult result =
      found.is_run     ? read_run(file, header, found.layout, found.chunks.front(), options, progress)
      : options.strict ? read_chunks(file, header, found.layout, found.chunks, options, progress)
                       : read_intact(file, header, found.layout, found.chunks, options, progress);
  if (result.cloud.empty() && !result.report.damage.empty())
    throw Error(ErrorCode::bad_input, result.report.damage.front());
  if (!found.note.empty()) result.report.notes.push_back(found.note);
  note_decoders(result);
  return result;
}

constexpr std::size_t format_byte = 104;

}  // namespace

WholeFile whole_file(const std::filesystem::path& path, Progress& progress) {
  const InputFile file(path);
  const Header header = read_header(file);
  WholeFile whole;
  if (header.count == 0) return whole;
  std::optional<ReadResult> sample;
  if (header.compressed) {
    const std::vector<LazChunk> chunks = find_chunks(file, header).chunks;
    whole.first_record = first_record(file, header, chunks.front().byte);
    sample = excerpt_chunks(path, chunks, sample_points, progress);
  } else {
    whole.first_record = first_record(file, header, header.point_data);
    sample = header.count < least_cut_points ? read_las(path, {}, progress)
                                             : excerpt_las(path, sample_points, {}, progress);
  }
  if (!sample->cloud.colors.empty()) whole.color_bits = sample->cloud.las->color_bits;
  whole.origin = origin_of(header, *sample, header_bounds(file));
  return whole;
}

}  // namespace las

std::uint64_t memory_limit() {
  if (const char* text = std::getenv("SFUMATO_MEMORY"))
    if (const unsigned long long bytes = std::strtoull(text, nullptr, 10); bytes > 0) return bytes;
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? std::uint64_t(pages) * std::uint64_t(size) / 4 * 3 : ~std::uint64_t{0};
}

bool is_las(std::string_view head) { return head.starts_with("LASF"); }

bool is_laz(std::string_view head) {
  return is_las(head) && head.size() > las::format_byte && (std::uint8_t(head[las::format_byte]) & 0x80) != 0;
}

bool is_copc(std::string_view head) {
  // COPC puts its record right behind a header of 375 bytes; the user id follows two reserved bytes.
  return is_laz(head) && head.size() > 382 && head.substr(377, 5) == std::string_view("copc\0", 5);
}

ReadResult read_las(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const las::InputFile file(path);
  const las::Header header = las::read_header(file);
  ReadResult result =
      header.compressed
          ? las::read_compressed(file, header, options, progress)
          : las::read_uncompressed(file, header, {0, header.count, header.count}, nullptr, options, progress);
  // Columns of nothing but zeros were left out to save memory; a format that is not LAS would not know of
  // them.
  for (const auto& column :
       {std::pair("user_data", StoredType::uint8), std::pair("point_source_id", StoredType::uint16)})
    if (options.every_attribute && !result.cloud.scalar(column.first) &&
        std::any_of(result.report.attributes.begin(), result.report.attributes.end(),
                    [&](const AttributeStats& attribute) { return attribute.name == column.first; }))
      result.cloud.set_scalar(
          {column.first, 0, std::vector<float>(result.cloud.size(), 0.0f), column.second});
  return result;
}

std::optional<ReadResult> read_part_of_las(const std::filesystem::path& path, const ReadOptions& options,
                                           Progress& progress) {
  const las::InputFile file(path);
  const las::Header header = las::read_header(file);
  if (header.count < least_cut_points || options.tap) return std::nullopt;
  const Part part = *options.part;
  if (!header.compressed) {
    const las::WholeFile whole = las::whole_file(path, progress);
    return las::read_uncompressed(file, header,
                                  {part.begin(header.count), part.end(header.count), header.count, true},
                                  &whole, options, progress);
  }
  las::LazChunks found = las::find_chunks(file, header);
  if (found.is_run) return std::nullopt;
  std::erase_if(found.chunks, [&](const las::LazChunk& chunk) {
    return !part.holds(chunk.first, chunk.count, header.count);
  });
  const las::WholeFile whole = las::whole_file(path, progress);
  ReadResult result =
      options.strict
          ? las::read_chunks(file, header, found.layout, found.chunks, options, progress, nullptr, &whole)
          : las::read_intact(file, header, found.layout, found.chunks, options, progress, &whole);
  las::note_decoders(result);
  return result;
}

ReadResult read_las_chunks(const std::filesystem::path& path, const std::vector<las::LazChunk>& chunks,
                           Progress& progress, const KeptChunks& kept, const las::WholeFile* whole) {
  const las::InputFile file(path);
  const las::Header header = las::read_header(file);
  const las::LazLayout layout = las::read_laz_layout(file, header);
  std::vector<las::LazChunk> wanted = chunks;
  for (las::LazChunk& chunk : wanted) chunk.first = 0;  // counted among themselves
  ReadResult result = las::read_intact(file, header, layout, wanted, {}, progress, whole, kept);
  las::note_decoders(result);
  result.report.file = path;
  result.report.format = "copc";
  return result;
}

}  // namespace sfumato::io
