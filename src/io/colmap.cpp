// points3D.bin of COLMAP: a count, then points with id, place, colour, error and the pictures that see them.
#include <cmath>
#include <cstring>

#include "io/file.h"
#include "io/format.h"
#include "io/table.h"

namespace sfumato::io {
namespace {

constexpr std::size_t head_bytes = 8 + 3 * 8 + 3 + 8 + 8;  ///< of a point in front of its track
constexpr std::size_t track_bytes = 8;                     ///< a picture and a place in it
constexpr std::uint64_t longest_track = 1 << 20, largest_id = std::uint64_t(1) << 48;
constexpr double farthest_point = 1e9;

struct Point {
  std::uint64_t id = 0, track = 0;
  double xyz[3] = {}, error = 0;
  std::uint8_t rgb[3] = {};
};

template <class T>
T take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  at += sizeof value;
  return value;
}

Point point_at(const char* at) {
  Point point;
  point.id = take<std::uint64_t>(at);
  for (double& value : point.xyz) value = take<double>(at);
  for (std::uint8_t& value : point.rgb) value = take<std::uint8_t>(at);
  point.error = take<double>(at);
  point.track = take<std::uint64_t>(at);
  return point;
}

bool is_plausible(const Point& point) {
  for (const double value : point.xyz)
    if (!(std::abs(value) <= farthest_point)) return false;
  return point.id < largest_id && point.track <= longest_track && std::isfinite(point.error);
}

}  // namespace

bool is_colmap_points(std::string_view head) {
  if (head.size() < 8 + head_bytes) return false;
  const char* at = head.data();
  const auto count = take<std::uint64_t>(at);
  if (count == 0 || count > 0xFFFFFFFFull) return false;
  std::uint64_t seen = 0;
  for (std::uint64_t left = head.size() - 8; left >= head_bytes && seen < count; ++seen) {
    const Point point = point_at(at);
    if (!is_plausible(point)) return false;
    const std::uint64_t size = head_bytes + point.track * track_bytes;
    if (size >= left) return true;  // the rest is behind what we see
    at += size, left -= size;
  }
  return seen > 0;
}

ReadResult read_colmap_points(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  const std::string bytes = file.read_text(0, std::size_t(file.size()));
  if (bytes.size() < 8 + head_bytes)
    bad_input(path, "byte 0", "found no point; the file is cut short, fetch it again");
  const char* at = bytes.data();
  const auto count = take<std::uint64_t>(at);
  if (count > (bytes.size() - 8) / head_bytes)
    bad_input(path, "byte 0",
              "found " + std::to_string(count) + " points in a file of " + std::to_string(bytes.size()) +
                  " bytes; it is cut short, fetch it again");
  std::vector<Column> columns{{"x", StoredType::float64},     {"y", StoredType::float64},
                              {"z", StoredType::float64},     {"red", StoredType::uint8},
                              {"green", StoredType::uint8},   {"blue", StoredType::uint8},
                              {"error", StoredType::float32}, {"track_length", StoredType::uint16}};
  assign_roles(columns);
  Table table(std::move(columns), std::size_t(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 65'536 == 0) progress.check();
    const auto left = std::size_t(bytes.data() + bytes.size() - at);
    const Point point = left >= head_bytes ? point_at(at) : Point{};
    if (left < head_bytes || !is_plausible(point) || point.track * track_bytes > left - head_bytes)
      bad_input(path, "byte " + std::to_string(bytes.size() - left),
                "found no point " + std::to_string(i + 1) + " of " + std::to_string(count) +
                    " here; the file is cut short or damaged");
    for (std::size_t k = 0; k < 3; ++k) {
      table.column(k)[i] = point.xyz[k];
      table.column(3 + k)[i] = point.rgb[k];
    }
    table.column(6)[i] = point.error;
    table.column(7)[i] = double(point.track);
    at += head_bytes + point.track * track_bytes;
  }
  ReadResult result;
  table.build(false, progress, result);
  result.cloud.provenance = Provenance::photographs;
  result.cloud.up = UpAxis::neg_y;  // of the first camera, whose y looks down
  return result;
}

}  // namespace sfumato::io
