#include "copc/sources.h"

#include <algorithm>
#include <cstdio>

#include "analysis/upright.h"
#include "copc/spool.h"
#include "io/color_depth.h"
#include "io/io.h"
#include "io/las.h"
#include "io/las_layout.h"

namespace sfumato::copc {
namespace {

using io::las::RecordFile;

// What a cloud in memory takes for each byte of its file: text and packed binaries are near 1, columns of one
// byte become four.
constexpr double memory_of_file_byte = 2.5;

class LasSource final : public Source {
 public:
  explicit LasSource(const std::filesystem::path& file) : records_(file) {
    if (!records_.note().empty()) notes.push_back(records_.note());
  }
  const io::las::Header& header() const override { return records_.header(); }
  std::optional<Bounds> bounds() const override { return records_.bounds(); }
  const std::vector<RecordFile::Part>& parts() const override { return records_.parts(); }
  void read(std::size_t part, const Sink& sink) const override { records_.read(part, sink); }

 private:
  RecordFile records_;
};

class CloudSource final : public Source {
 public:
  CloudSource(const io::ReadResult& result, const std::filesystem::path& output, Progress& progress)
      : records_(output.parent_path(), output), bounds_(sfumato::bounds(result.cloud)) {
    const PointCloud& cloud = result.cloud;
    const io::las::WriteLayout layout = io::las::choose_layout(cloud);
    header_.format = layout.format;
    header_.record_length = layout.record_length;
    header_.count = cloud.size();
    header_.scale = layout.scale;
    header_.offset = layout.offset;
    if (!layout.extra.empty())
      header_.vlrs.push_back({"LASF_Spec", 4, 0, io::las::extra_bytes_record(layout.extra)});
    bool is_wkt = false;
    for (io::las::CrsRecord& record : io::las::crs_records(cloud.crs, is_wkt))
      header_.vlrs.push_back({"LASF_Projection", record.record_id, 0, std::move(record.data)});
    header_.global_encoding =
        std::uint16_t((is_wkt ? 16 : 0) | (cloud.las ? cloud.las->time_and_returns : 0));
    notes = result.report.notes;
    notes.insert(notes.end(), layout.notes.begin(), layout.notes.end());
    const UpAxis up = cloud.up == UpAxis::pos_z || cloud.up_is_known
                          ? cloud.up
                          : analysis::guess_upright(cloud, progress).up;
    if (up != UpAxis::pos_z)
      notes.push_back(to_string(up) + " is up in it, and COPC files are taken as +Z up: render with --up " +
                      to_string(up));
    const std::size_t block = io::las::records_at_a_time(layout.record_length);
    std::vector<std::uint8_t> records;
    for (std::size_t first = 0; first < cloud.size(); first += block) {
      progress.check();
      const std::size_t count = std::min(block, cloud.size() - first);
      records.assign(count * layout.record_length, 0);
      layout.pack(cloud, first, count, records.data());
      records_.write(first * layout.record_length, records);
      parts_.push_back({first, count});
    }
    // The records lie up to half a step beside the points.
    bounds_.min -= layout.scale;
    bounds_.max += layout.scale;
  }

  const io::las::Header& header() const override { return header_; }
  std::optional<Bounds> bounds() const override { return bounds_; }
  const std::vector<RecordFile::Part>& parts() const override { return parts_; }
  void read(std::size_t part, const Sink& sink) const override {
    const auto [first, count] = parts_[part];
    std::vector<std::uint8_t> records(count * header_.record_length);
    records_.read(first * header_.record_length, records);
    sink(first, records.data(), count);
  }

 private:
  TemporaryFile records_;
  Bounds bounds_;
  io::las::Header header_;
  std::vector<RecordFile::Part> parts_;
};

void refuse_large(const std::filesystem::path& file, std::uint64_t size, std::uint64_t memory) {
  const double needed = memory_of_file_byte * double(size);
  if (needed <= double(memory)) return;
  char text[96];
  std::snprintf(text, sizeof text, "takes about %.3g GB, and --memory is %.3g GB", needed / 1e9,
                double(memory) / 1e9);
  throw Error(ErrorCode::out_of_memory,
              file.string() + ": a file of this format is read as a whole, which " + text +
                  "; raise --memory, or split the file or convert it to .las elsewhere");
}

}  // namespace

std::unique_ptr<Source> open_source(const std::filesystem::path& file, const std::filesystem::path& output,
                                    std::uint64_t memory, Progress& progress) {
  std::unique_ptr<Source> source;
  std::uint64_t size = 0;
  bool is_las = false;
  {
    const io::File opened(file);
    size = opened.size();
    is_las = io::is_las(opened.read_text(0, 4));
  }
  if (is_las) {
    source = std::make_unique<LasSource>(file);
  } else {
    refuse_large(file, size, memory);
    io::ReadOptions options;
    options.every_attribute = options.strict = true;
    const io::ReadResult result = io::read(file, options, progress);
    try {
      source = std::make_unique<CloudSource>(result, output, progress);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::usage) throw;  // what LAS cannot hold says so without the file's name
      throw Error(error.code(), file.string() + ": " + error.what());
    }
  }
  source->name = file.string();
  return source;
}

int color_bits_of(const Source& source, Progress& progress) {
  const io::las::Header& header = source.header();
  if (!io::las::has_color(header.format)) return 0;
  const std::size_t byte = header.format == 2   ? 20
                           : header.format >= 6 ? 30
                                                : 28,
                    parts = source.parts().size();
  io::ColorDepth depth;
  std::size_t last = parts;
  for (const std::size_t part : {std::size_t(0), parts / 2, parts - 1}) {
    if (part == last || parts == 0) continue;
    progress.check();
    source.read(last = part, [&](std::uint64_t, const std::uint8_t* records, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t* at = records + i * header.record_length + byte;
        depth.add(io::las::get<std::uint16_t>(at), io::las::get<std::uint16_t>(at + 2),
                  io::las::get<std::uint16_t>(at + 4));
      }
    });
  }
  return depth.bits();
}

}  // namespace sfumato::copc
