// Writing LAS and LAZ (LAS 1.4): choose a point format, the scaling and the extra bytes, then pack record by
// record.
#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <span>

#include "io/atomic_writer.h"
#include "io/las.h"
#include "io/las_layout.h"
#include "io/laz_point.h"

namespace sfumato::io {
namespace las {
namespace {

constexpr std::size_t packed_at_once = 1 << 14;
constexpr std::uint32_t header_size = 375;
constexpr std::size_t longest_vlr = 65535;
const char* const software = "sfumato";

struct OutVlr {
  const char* user_id;
  std::uint16_t record_id;
  std::vector<std::uint8_t> data;
};

/// What the header says about the points.
struct Summary {
  std::array<std::int32_t, 3> low{}, high{};
  std::array<std::uint64_t, 15> by_return{};
};

Summary summarize(const PointCloud& cloud, const WriteLayout& layout, Progress& progress) {
  Summary summary;
  const ScalarField* returns = cloud.scalar("return_number");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % packed_at_once == 0) progress.check();
    const std::array<std::int32_t, 3> steps = layout.steps(cloud, i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      summary.low[axis] = i ? std::min(summary.low[axis], steps[axis]) : steps[axis];
      summary.high[axis] = i ? std::max(summary.high[axis], steps[axis]) : steps[axis];
    }
    const double number = returns ? returns->value(i) : 1;
    if (number >= 1 && number <= 15) ++summary.by_return[std::size_t(number) - 1];
  }
  return summary;
}

std::vector<OutVlr> vlrs_of(const std::filesystem::path& file, const PointCloud& cloud,
                            const WriteLayout& layout, bool& is_wkt) {
  std::vector<OutVlr> vlrs;
  for (CrsRecord& record : crs_records(cloud.crs, is_wkt))
    vlrs.push_back({"LASF_Projection", record.record_id, std::move(record.data)});
  if (!layout.extra.empty()) vlrs.push_back({"LASF_Spec", 4, extra_bytes_record(layout.extra)});
  for (const OutVlr& vlr : vlrs)
    if (vlr.data.size() > longest_vlr)
      throw Error(ErrorCode::usage,
                  file.string() + ": the cloud has " + std::to_string(layout.extra.size()) +
                      " extra attributes or a long coordinate system, and a LAS record holds 65535 "
                      "bytes; write .ply instead");
  return vlrs;
}

laszip_header_struct header_of(const PointCloud& cloud, const WriteLayout& layout, const Summary& summary,
                               bool is_wkt) {
  laszip_header_struct h{};
  h.global_encoding = std::uint16_t((is_wkt ? 16 : 0) | (cloud.las ? cloud.las->time_and_returns : 0));
  h.version_major = 1;
  h.version_minor = 4;
  std::strncpy(h.system_identifier, "conversion", sizeof h.system_identifier);
  std::strncpy(h.generating_software, software, sizeof h.generating_software);
  h.file_creation_day = 1;
  h.file_creation_year = 1970;  // the same cloud gives the same bytes
  h.header_size = header_size;
  h.offset_to_point_data = header_size;  // LASzip adds the records itself
  h.point_data_format = std::uint8_t(layout.format);
  h.point_data_record_length = layout.record_length;
  h.extended_number_of_point_records = cloud.size();
  std::copy(summary.by_return.begin(), summary.by_return.end(), h.extended_number_of_points_by_return);
  if (layout.format < 6) {
    h.number_of_point_records = std::uint32_t(cloud.size());
    for (std::size_t k = 0; k < 5; ++k) h.number_of_points_by_return[k] = std::uint32_t(summary.by_return[k]);
  }
  double* const scales[3] = {&h.x_scale_factor, &h.y_scale_factor, &h.z_scale_factor};
  double* const offsets[3] = {&h.x_offset, &h.y_offset, &h.z_offset};
  double* const lows[3] = {&h.min_x, &h.min_y, &h.min_z};
  double* const highs[3] = {&h.max_x, &h.max_y, &h.max_z};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = layout.scale[axis] * summary.low[std::size_t(axis)] + layout.offset[axis];
    const double b = layout.scale[axis] * summary.high[std::size_t(axis)] + layout.offset[axis];
    *scales[axis] = layout.scale[axis];
    *offsets[axis] = layout.offset[axis];
    *lows[axis] = std::min(a, b);
    *highs[axis] = std::max(a, b);
  }
  return h;
}

// The header's 375 bytes and the records behind it, as they lie in an uncompressed file.
std::vector<std::uint8_t> header_bytes(const laszip_header_struct& h, const std::vector<OutVlr>& vlrs) {
  std::vector<std::uint8_t> bytes(header_size);
  std::uint8_t* b = bytes.data();
  std::memcpy(b, "LASF", 4);
  put(b + 6, h.global_encoding);
  b[24] = h.version_major;
  b[25] = h.version_minor;
  std::memcpy(b + 26, h.system_identifier, 32);
  std::memcpy(b + 58, h.generating_software, 32);
  put(b + 90, h.file_creation_day);
  put(b + 92, h.file_creation_year);
  put(b + 94, h.header_size);
  put<std::uint32_t>(b + 100, std::uint32_t(vlrs.size()));
  b[104] = h.point_data_format;
  put(b + 105, h.point_data_record_length);
  put(b + 107, h.number_of_point_records);
  std::memcpy(b + 111, h.number_of_points_by_return, 20);
  const double numbers[12] = {h.x_scale_factor, h.y_scale_factor, h.z_scale_factor, h.x_offset,
                              h.y_offset,       h.z_offset,       h.max_x,          h.min_x,
                              h.max_y,          h.min_y,          h.max_z,          h.min_z};
  std::memcpy(b + 131, numbers, sizeof numbers);
  put(b + 247, h.extended_number_of_point_records);
  std::memcpy(b + 255, h.extended_number_of_points_by_return, 120);
  for (const OutVlr& vlr : vlrs) {
    std::uint8_t head[vlr_header_size] = {};
    std::memcpy(head + 2, vlr.user_id, std::strlen(vlr.user_id));
    put(head + 18, vlr.record_id);
    put(head + 20, std::uint16_t(vlr.data.size()));
    bytes.insert(bytes.end(), head, head + sizeof head);
    bytes.insert(bytes.end(), vlr.data.begin(), vlr.data.end());
  }
  put<std::uint32_t>(bytes.data() + 96, std::uint32_t(bytes.size()));
  return bytes;
}

void write_records(const PointCloud& cloud, const WriteLayout& layout, Progress& progress,
                   const std::function<void(std::span<const std::uint8_t>)>& sink) {
  std::vector<std::uint8_t> records;
  for (std::size_t first = 0; first < cloud.size(); first += packed_at_once) {
    progress.check();
    const std::size_t count = std::min(packed_at_once, cloud.size() - first);
    records.assign(count * layout.record_length, 0);
    layout.pack(cloud, first, count, records.data());
    sink(records);
    progress.update(double(first + count) / double(cloud.size()), "writing points");
  }
}

class LazWriter {
 public:
  LazWriter(const std::filesystem::path& path, AtomicWriter& writer)
      : path_(path), buffer_(writer), stream_(&buffer_) {
    if (laszip_create(&laszip_) != 0)
      throw Error(ErrorCode::out_of_memory, "LASzip cannot be started: no memory");
  }
  ~LazWriter() { laszip_destroy(laszip_); }
  LazWriter(const LazWriter&) = delete;
  LazWriter& operator=(const LazWriter&) = delete;

  void open(const laszip_header_struct& header, const std::vector<OutVlr>& vlrs) {
    check(laszip_set_header(laszip_, &header));
    check(laszip_preserve_generating_software(laszip_, 1));
    for (const OutVlr& vlr : vlrs)
      check(laszip_add_vlr(laszip_, vlr.user_id, vlr.record_id, laszip_U16(vlr.data.size()), "",
                           vlr.data.data()));
    check(laszip_request_native_extension(laszip_, 1));
    check(laszip_open_writer_stream(laszip_, stream_, 1, 0));
    check(laszip_get_point_pointer(laszip_, &point_));
    format_ = header.point_data_format;
    record_length_ = header.point_data_record_length;
  }

  void write(std::span<const std::uint8_t> records) {
    for (std::size_t at = 0; at < records.size(); at += record_length_) {
      unpack_point(records.data() + at, format_, *point_);
      check(laszip_write_point(laszip_));
    }
  }

  void close() {
    check(laszip_close_writer(laszip_));
    buffer_.finish();
  }

 private:
  void check(laszip_I32 result) {
    buffer_.rethrow();
    if (result == 0 && stream_) return;
    laszip_CHAR* message = nullptr;
    laszip_get_error(laszip_, &message);
    std::string text = message && *message ? message : "LASzip does not say why";
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw Error(ErrorCode::io, path_.string() + ": writing failed (" + text + ")");
  }

  std::filesystem::path path_;
  WriterBuffer buffer_;
  std::ostream stream_;
  laszip_POINTER laszip_ = nullptr;
  laszip_point_struct* point_ = nullptr;
  int format_ = 0;
  std::size_t record_length_ = 0;
};

}  // namespace
}  // namespace las

WriteReport write_las(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const las::WriteLayout layout = las::choose_layout(cloud);
  bool is_wkt = false;
  const std::vector<las::OutVlr> vlrs = las::vlrs_of(file, cloud, layout, is_wkt);
  const las::Summary summary = las::summarize(cloud, layout, progress);
  const std::vector<std::uint8_t> head =
      las::header_bytes(las::header_of(cloud, layout, summary, is_wkt), vlrs);
  AtomicWriter writer(file);
  writer.write(std::as_bytes(std::span(head)));
  las::write_records(cloud, layout, progress,
                     [&](std::span<const std::uint8_t> records) { writer.write(std::as_bytes(records)); });
  writer.commit();
  return {layout.notes};
}

WriteReport write_laz(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  if (file.filename().string().ends_with(".copc.laz"))
    throw Error(
        ErrorCode::usage,
        file.string() +
            ": COPC is written by sfumato build IN... -o OUT.copc.laz; here name a .laz without .copc");
  const las::WriteLayout layout = las::choose_layout(cloud);
  bool is_wkt = false;
  const std::vector<las::OutVlr> vlrs = las::vlrs_of(file, cloud, layout, is_wkt);
  const las::Summary summary = las::summarize(cloud, layout, progress);
  AtomicWriter writer(file);
  {
    las::LazWriter laz(file, writer);
    laz.open(las::header_of(cloud, layout, summary, is_wkt), vlrs);
    las::write_records(cloud, layout, progress,
                       [&](std::span<const std::uint8_t> records) { laz.write(records); });
    laz.close();
  }
  writer.commit();
  return {layout.notes};
}

}  // namespace sfumato::io
