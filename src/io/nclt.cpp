// Sweeps of the NCLT dataset (Carlevaris-Bianco, Ushani, Eustice, "University of Michigan North Campus
// long-term vision and lidar dataset", IJRR 2016, `velodyne_sync`): records of eight bytes without a header,
// three uint16 steps of 5 mm from -100 m on, the intensity, and which of 32 lasers. In the axes of the
// vehicle, whose z points down.
#include "io/nclt.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstring>

namespace sfumato::io {
namespace {

constexpr std::size_t nclt_record = 8, nclt_lasers = 32, nclt_step = 1 << 16;
constexpr double nclt_metres = 0.005, nclt_begin = -100;
/// Where the dataset's calibration puts the scanner: from there the elevations of a laser scatter by .03
/// degrees.
const dvec3 nclt_scanner(0.002, -0.004, -0.957);

struct NcltHit {
  float x, y, z, intensity, laser;
};

NcltHit nclt_hit(const std::byte* bytes) {
  std::array<std::uint16_t, 3> steps;
  std::memcpy(steps.data(), bytes, sizeof steps);
  const auto place = [&](int axis) { return float(steps[std::size_t(axis)] * nclt_metres + nclt_begin); };
  return {place(0), place(1), place(2), float(bytes[6]), float(bytes[7])};
}

}  // namespace

bool is_nclt_sweep(const File& file) {
  if (file.size() == 0 || file.size() % nclt_record != 0) return false;
  std::vector<std::byte> bytes(std::size_t(std::min<std::uint64_t>(file.size(), nclt_step * nclt_record)));
  file.read(0, bytes);
  std::bitset<nclt_lasers> seen;
  for (std::size_t at = nclt_record - 1; at < bytes.size(); at += nclt_record) {
    const auto laser = std::size_t(bytes[at]);
    if (laser >= nclt_lasers) return false;
    seen.set(laser);
  }
  // In floats that byte has the sign and the exponent.
  return seen.count() > nclt_lasers / 2;
}

ReadResult read_nclt_sweep(const File& file, Progress& progress) {
  const auto rows = std::size_t(file.size() / nclt_record);
  std::vector<Column> columns;
  for (const auto& [name, stored] :
       {std::pair("x", StoredType::float32), std::pair("y", StoredType::float32),
        std::pair("z", StoredType::float32), std::pair("intensity", StoredType::uint8),
        std::pair("ring", StoredType::uint8)})
    columns.push_back({name, stored, StoredType::float32, columns.size() * sizeof(float), sizeof(NcltHit)});
  assign_roles(columns);
  CloudBuilder builder(std::move(columns), rows);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, rows)};
  std::vector<std::byte> bytes;
  std::vector<NcltHit> hits;
  for (std::size_t first = 0; first < rows; first += nclt_step) {
    progress.check();
    const std::size_t count = std::min(nclt_step, rows - first);
    bytes.resize(count * nclt_record), hits.resize(count);
    file.read(std::uint64_t(first) * nclt_record, bytes);
    for (std::size_t i = 0; i < count; ++i) hits[i] = nclt_hit(bytes.data() + i * nclt_record);
    builder.decode(cursors[0], std::as_bytes(std::span(hits)).data(), 0, count, first);
    progress.update(double(first + count) / double(rows), "reading");
  }
  ReadResult result;
  builder.finish(cursors, result);
  result.cloud.up = UpAxis::neg_z, result.cloud.up_is_known = true;
  result.cloud.scanners.push_back(nclt_scanner);
  result.report.notes.emplace_back(
      "taken as a sweep of NCLT: steps of 5 mm, intensity, laser; z points down");
  return result;
}

}  // namespace sfumato::io
