// Points as little-endian floats without a header. Easy3D's come in blocks behind their counts. Scans of
// vehicles have none: KITTI (x y z intensity), nuScenes (and a ring), dumps of Velodyne, Ouster and Livox
// drivers (ring, time and more). The file says nowhere how many floats a point has.
//
// With the right number of columns each holds one kind of value; with a wrong one all are mixed. Of the
// numbers of columns, the one with the shortest code is taken: numbers coded as normal deviates of their
// column take log(deviation) each, and a column costs its two parameters (Schwarz 1978, the Bayesian
// information criterion).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>

#include "core/counted.h"
#include "io/columns.h"
#include "io/file.h"
#include "io/flat_records.h"
#include "io/format.h"
#include "io/nclt.h"

namespace sfumato::io {
namespace {

constexpr std::size_t least_floats = 3, most_floats = 12;
constexpr std::size_t sampled_floats = 1 << 16;
/// Nothing that a vehicle sees is farther, metres.
constexpr double farthest_echo = 1e5;

struct Values {
  double mean = 0, deviation = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  bool is_whole = true, rises = true;
};

Values column_of(const std::vector<float>& floats, std::size_t column, std::size_t columns) {
  Values found;
  double sum = 0, squares = 0, last = -std::numeric_limits<double>::infinity();
  std::size_t count = 0;
  for (std::size_t i = column; i < floats.size(); i += columns) {
    const double value = floats[i];
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
    found.low = std::min(found.low, value), found.high = std::max(found.high, value);
    found.is_whole = found.is_whole && value == std::floor(value);
    found.rises = found.rises && value >= last;
    last = value;
  }
  found.mean = sum / double(std::max<std::size_t>(1, count));
  for (std::size_t i = column; i < floats.size(); i += columns)
    if (std::isfinite(floats[i])) squares += (floats[i] - found.mean) * (floats[i] - found.mean);
  found.deviation = std::sqrt(squares / double(std::max<std::size_t>(1, count)));
  return found;
}

/// Nats that the floats take in so many columns. Floats have steps: no column is finer than those of its
/// values.
double code_length(const std::vector<float>& floats, std::size_t columns) {
  const double all = double(floats.size()), rows = all / double(columns);
  double length = 0;
  for (std::size_t k = 0; k < columns; ++k) {
    const Values column = column_of(floats, k, columns);
    const double step = std::max(std::abs(column.low), std::abs(column.high)) * 0x1p-24;
    length += rows * std::log(std::max({column.deviation, step, 1e-6})) + std::log(rows);
  }
  return length;
}

/// Whether `columns` is a multiple of the right number: the columns of each turn hold the same kinds.
bool repeats(const std::vector<float>& floats, std::size_t columns, std::size_t turn) {
  for (std::size_t k = 0; k + turn < columns; ++k) {
    const Values a = column_of(floats, k, columns), b = column_of(floats, k + turn, columns);
    const double wide = std::max(a.deviation, b.deviation), narrow = std::min(a.deviation, b.deviation);
    if (std::abs(a.mean - b.mean) > wide || wide > 4 * narrow) return false;
  }
  return true;
}

std::vector<float> sample_of(const File& file, std::uint64_t floats, std::uint64_t columns) {
  // From the middle, whole points: scans begin and end where nothing is seen.
  const std::uint64_t points = floats / columns,
                      wanted = std::min<std::uint64_t>(points, sampled_floats / columns);
  std::vector<float> sample(std::size_t(wanted * columns));
  file.read((points - wanted) / 2 * columns * sizeof(float), std::as_writable_bytes(std::span(sample)));
  return sample;
}

[[noreturn]] void refuse(const File& file, const std::string& found) {
  bad_input(
      file.path(), "byte 0",
      found + ", expected points of 3 to " + std::to_string(most_floats) +
          " floats as of a vehicle's scanner; name the columns (--columns x,y,z,intensity,...) or the format "
          "by its extension");
}

std::size_t find_columns(const File& file, std::uint64_t floats) {
  // Of fewer points columns have no deviations worth the name: KITTI's four where they can be.
  constexpr std::uint64_t least_points = 16;
  if (floats < least_points * least_floats)
    for (const std::size_t columns : {4, 5, 6, 3})
      if (floats % columns == 0) return columns;
  double shortest = std::numeric_limits<double>::infinity(), mixed = 0;
  std::size_t best = 0;
  for (std::size_t columns = least_floats; columns <= most_floats; ++columns) {
    if (floats % columns != 0 || floats / columns < least_points) continue;
    const std::vector<float> sample = sample_of(file, floats, columns);
    const double per_float = code_length(sample, columns) / double(sample.size());
    if (per_float >= shortest) continue;
    shortest = per_float, best = columns;
    mixed = code_length(sample, 1) / double(sample.size());
  }
  if (best == 0 && floats < least_points * 4 && floats % 4 == 0) return 4;
  if (best == 0) refuse(file, "found " + counted(floats, "float") + ", which are no whole number of points");
  if (!std::isfinite(shortest)) refuse(file, "found numbers that are none");
  const std::vector<float> sample = sample_of(file, floats, best);
  for (std::size_t turn = least_floats; turn < best; ++turn)
    if (best % turn == 0 && repeats(sample, best, turn)) return turn;
  // A handful of points tells nothing; of many, columns that are one like the other are of anything.
  if (sample.size() >= 64 * best && shortest >= mixed) refuse(file, "found floats without columns");
  return best;
}

/// Names of what stands behind x y z, by what the values look like.
std::vector<std::string> names_of(const std::vector<float>& sample, std::size_t columns) {
  std::vector<std::string> names{"x", "y", "z"};
  bool intensity = false, ring = false, time = false;
  for (std::size_t k = least_floats; k < columns; ++k) {
    const Values column = column_of(sample, k, columns);
    if (column.deviation == 0 && k + 1 < columns) {
      names.push_back("_");  // padding
    } else if (!intensity) {
      names.emplace_back("intensity"), intensity = true;
    } else if (!ring && column.is_whole && column.low >= 0 && column.high < 256) {
      names.emplace_back("ring"), ring = true;
    } else if (!time && column.rises) {
      names.emplace_back("time"), time = true;
    } else {
      names.push_back("column_" + std::to_string(k + 1));
    }
  }
  return names;
}

/// Easy3D's: a count (int32) and so many times three floats, for places, colours and normals each; of the two
/// that may lack the count is 0, or they end the file.
struct CountedBlocks {
  std::size_t points = 0;
  std::uint64_t colors = 0, normals = 0;  ///< where their floats begin, bytes; 0 where there are none
};

std::optional<CountedBlocks> find_counted_blocks(const File& file) {
  constexpr std::uint64_t three_floats = 3 * sizeof(float);
  CountedBlocks found;
  std::uint64_t at = 0;
  for (int block = 0; block < 3 && at < file.size(); ++block) {
    std::int32_t count = 0;
    if (file.size() - at < sizeof count) return std::nullopt;
    file.read(at, std::as_writable_bytes(std::span(&count, 1)));
    at += sizeof count;
    if (block == 0) found.points = std::size_t(std::max(count, 0));
    if (found.points == 0 || (count != 0 && std::size_t(count) != found.points)) return std::nullopt;
    if (count == 0) continue;
    if (block == 1) found.colors = at;
    if (block == 2) found.normals = at;
    at += found.points * three_floats;
    if (at > file.size()) return std::nullopt;
  }
  return at == file.size() ? std::optional(found) : std::nullopt;
}

ReadResult read_counted_blocks(const File& file, const CountedBlocks& blocks, Progress& progress) {
  std::vector<Column> columns;
  const auto add = [&](std::uint64_t begin, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      columns.push_back({name, StoredType::float32, StoredType::float32, begin, 3 * sizeof(float)});
      begin += sizeof(float);
    }
  };
  add(sizeof(std::int32_t), {"x", "y", "z"});
  if (blocks.colors > 0) add(blocks.colors, {"red", "green", "blue"});
  if (blocks.normals > 0) add(blocks.normals, {"nx", "ny", "nz"});
  assign_roles(columns);
  constexpr std::size_t step = 1 << 16, three_floats = 3 * sizeof(float);
  std::vector<std::byte> bytes(columns.size() / 3 * step * three_floats);
  std::vector<std::uint64_t> begins;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (k % 3 == 0) begins.push_back(columns[k].offset);
    columns[k].offset = (k / 3 * step * 3 + k % 3) * sizeof(float);
  }
  CloudBuilder builder(std::move(columns), blocks.points);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, blocks.points)};
  for (std::size_t first = 0; first < blocks.points; first += step) {
    progress.check();
    const std::size_t count = std::min(step, blocks.points - first);
    for (std::size_t k = 0; k < begins.size(); ++k)
      file.read(begins[k] + first * three_floats,
                std::span(bytes).subspan(k * step * three_floats, count * three_floats));
    builder.decode(cursors[0], bytes.data(), 0, count, first);
    progress.update(double(first + count) / double(blocks.points), "reading");
  }
  ReadResult result;
  builder.finish(cursors, result);
  if (result.report.points_finite == 0) refuse(file, "found numbers that are none");
  result.cloud.provenance = Provenance::model;
  result.report.notes.emplace_back("taken as Easy3D's blocks: a count, then places, colours and normals");
  return result;
}

}  // namespace

ReadResult read_floats(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  if (options.columns.empty() && is_nclt_sweep(file)) return read_nclt_sweep(file, progress);
  const std::uint64_t floats = file.size() / sizeof(float);
  if (file.size() % sizeof(float) != 0 || floats < least_floats)
    bad_input(
        path, "byte " + std::to_string(file.size()),
        "the file ends inside a point, expected records of floats (KITTI, nuScenes); it is cut short or of "
        "another layout");
  std::vector<std::string> names = options.columns;
  if (names.empty()) {
    if (const std::optional<CountedBlocks> blocks = find_counted_blocks(file))
      return read_counted_blocks(file, *blocks, progress);
    const std::size_t columns = find_columns(file, floats);
    names = names_of(sample_of(file, floats, columns), columns);
  } else if (floats % names.size() != 0) {
    bad_input(path, "byte " + std::to_string(file.size()),
              "the file ends inside a point of the " + std::to_string(names.size()) +
                  " floats that --columns names");
  }
  const std::size_t record = names.size() * sizeof(float);
  std::vector<Column> columns;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] != "_")
      columns.push_back({names[k], StoredType::float32, StoredType::float32, k * sizeof(float), record});
  if (!assign_roles(columns))
    throw Error(ErrorCode::usage, path.string() + ": the columns lack x, y or z; name them");
  const auto rows = std::size_t(floats / names.size());
  ReadResult result = read_flat_records(file, std::move(columns), rows, record, progress);
  const double reach = std::max(glm::length(result.report.bounds_min), glm::length(result.report.bounds_max));
  if (result.report.points_finite == 0 || !(reach <= farthest_echo))
    refuse(file, "found coordinates up to " + short_text(reach));
  result.cloud.scanners.push_back(dvec3(0));
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : " ") + name;
  result.report.notes.push_back("taken as " + std::to_string(names.size()) + " floats a point: " + list +
                                ", the scanner at 0 0 0" +
                                (options.columns.empty() ? " (--columns names them otherwise)" : ""));
  return result;
}

}  // namespace sfumato::io
