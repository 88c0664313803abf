#include "io/tiles.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>

#include "io/byte_source.h"
#include "io/file.h"
#include "io/format.h"
#include "core/subsample.h"
#include "io/las.h"
#include "io/las_records.h"

namespace sfumato::io {
namespace {

StoredType layout_type(const TileField& field) {
  return field.is_scaled() ? StoredType::float64 : field.type;
}

/// Records as the builder takes them: scaled numbers as doubles, the others as they are.
class Expansion {
 public:
  explicit Expansion(const TileLayout& layout) : layout_(layout) {
    for (const TileField& field : layout.fields) {
      columns_.push_back({field.name, layout_type(field), layout_type(field), size_, 0});
      size_ += size_of(layout_type(field));
    }
    for (Column& column : columns_) column.stride = size_;
    assign_roles(columns_);
    use_usual_names(columns_);
  }
  const std::vector<Column>& columns() const { return columns_; }
  std::size_t record() const { return size_; }

  void expand(const std::byte* records, std::size_t count, std::vector<std::byte>& out) const {
    out.resize(count * size_);
    for (std::size_t i = 0; i < count; ++i) {
      const std::byte* from = records + i * layout_.record;
      std::byte* to = out.data() + i * size_;
      for (std::size_t k = 0; k < columns_.size(); ++k) {
        const TileField& field = layout_.fields[k];
        if (field.is_scaled()) {
          const double value = number_of(field.type, from + field.offset) * field.scale + field.shift;
          std::memcpy(to + columns_[k].offset, &value, sizeof value);
        } else {
          std::memcpy(to + columns_[k].offset, from + field.offset, size_of(field.type));
        }
      }
    }
  }

 private:
  const TileLayout& layout_;
  std::vector<Column> columns_;
  std::size_t size_ = 0;
};

/// A function of a library that is there wherever libcurl is, as that needs it too.
void* function_of(const std::filesystem::path& file, const char* library, const char* package,
                  const char* name) {
  void* const opened = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  void* const function = opened ? ::dlsym(opened, name) : nullptr;
  if (!function)
    throw Error(ErrorCode::io, file.string() + ": is unpacked by " + library +
                                   ", which is not installed (package " + package + ")");
  return function;
}

}  // namespace

std::filesystem::path beside(const std::filesystem::path& file, const std::string& name) {
  if (!is_remote(file)) return file.parent_path() / name;
  const std::string& url = file.native();
  const std::size_t end = std::min(url.find_first_of("?#"), url.size());
  const std::size_t query = std::min(url.find('#'), url.size());
  return url.substr(0, url.rfind('/', end) + 1) + name + url.substr(end, query - end);
}

bool is_tiled(std::string_view head) { return is_ept(head) || is_potree(head); }

TiledScan open_tiled(const std::filesystem::path& file, Progress& progress) {
  return is_ept(File(file).read_text(0, 4096)) ? open_ept(file, progress) : open_potree(file, progress);
}

namespace {

/// From the root down, whole levels until there are `max_points`.
std::vector<Tile> tiles_of(const TiledScan& scan, const std::optional<std::uint64_t>& max_points) {
  std::vector<Tile> tiles = scan.tiles;
  std::stable_sort(tiles.begin(), tiles.end(),
                   [](const Tile& a, const Tile& b) { return a.level < b.level; });
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const bool is_new_level = i > 0 && tiles[i].level != tiles[i - 1].level;
    if (max_points && is_new_level && points >= *max_points) {
      tiles.resize(i);
      break;
    }
    points += tiles[i].points;
  }
  return tiles;
}

std::uint64_t points_of(const std::vector<Tile>& tiles) {
  return std::accumulate(tiles.begin(), tiles.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Tile& tile) { return sum + tile.points; });
}

ReadResult read_these(const std::filesystem::path& file, const TiledScan& scan,
                      const std::vector<Tile>& tiles, Progress& progress, TileChoices* choices) {
  const std::uint64_t points = points_of(tiles);
  if (points > memory_limit() / (2 * scan.record + 32))
    throw Error(ErrorCode::out_of_memory, file.string() + ": " + std::to_string(points) +
                                              " points do not fit into memory; take fewer (--max-points N)");
  return scan.read(tiles, progress, choices);
}

}  // namespace

ReadResult read_tiled(const std::filesystem::path& file, const TiledScan& scan, const ReadOptions& options,
                      Progress& progress) {
  return read_these(file, scan, tiles_of(scan, options.max_points), progress, nullptr);
}

TileChoices choices_of(const std::filesystem::path& file, const TiledScan& scan, Progress& progress) {
  TileChoices choices{scan.bounds};
  read_these(file, scan, tiles_of(scan, sample_points), progress, &choices);
  return choices;
}

std::optional<ReadResult> read_part_of_tiles(const std::filesystem::path& file, const ReadOptions& options,
                                             Progress& progress) {
  const TiledScan scan = open_tiled(file, progress);
  std::vector<Tile> tiles = tiles_of(scan, options.max_points);
  const std::uint64_t total = points_of(tiles);
  if (total < least_cut_points) return std::nullopt;
  TileChoices choices = choices_of(file, scan, progress);
  const Part part = *options.part;
  std::uint64_t before = 0, first = total;
  std::erase_if(tiles, [&](const Tile& tile) {
    const bool is_own = part.holds(before, tile.points, total);
    if (is_own) first = std::min(first, before);
    before += tile.points;
    return !is_own;
  });
  ReadResult result = read_these(file, scan, tiles, progress, &choices);
  if (options.max_points && *options.max_points < total) {
    const Subsample kept(total, *options.max_points);
    std::vector<std::uint32_t> places;
    for (std::size_t i = 0; i < result.cloud.size(); ++i)
      if (kept.takes(first + i)) places.push_back(std::uint32_t(i));
    result.cloud = select(result.cloud, places);
  }
  return result;
}

std::vector<std::string> names_of(const TileLayout& layout) {
  std::vector<std::string> names;
  const Expansion expansion(layout);
  for (const Column& column : expansion.columns())
    if (column.role != Role::x && column.role != Role::y && column.role != Role::z)
      names.push_back(column.name);
  return names;
}

ReadResult read_tiles(const std::filesystem::path& file, const TileLayout& layout,
                      const std::vector<Tile>& tiles,
                      const std::function<std::vector<std::byte>(const Tile&)>& load, Progress& progress,
                      TileChoices* choices) {
  if (tiles.empty() && !choices) return {};
  const Expansion expansion(layout);
  for (const Role role : {Role::x, Role::y, Role::z})
    if (column_of(expansion.columns(), role) < 0)
      bad_input(file, "schema", "found no x, y and z; export it again");
  // All of them before room is made for points: sizes that files tell are not trusted.
  std::vector<std::vector<std::byte>> loaded(tiles.size());
  las::parallel_tasks(tiles.size(), progress, "reading tiles", [&](std::size_t i) {
    loaded[i] = load(tiles[i]);
    if (loaded[i].size() != tiles[i].points * layout.record)
      bad_input(file, "tile " + tiles[i].name,
                "found " + std::to_string(loaded[i].size()) + " bytes, expected " +
                    std::to_string(tiles[i].points) + " points of " + std::to_string(layout.record) +
                    "; the tile is cut short or damaged");
  });
  std::vector<std::size_t> first{0};
  for (const Tile& tile : tiles) first.push_back(first.back() + std::size_t(tile.points));
  CloudBuilder builder(expansion.columns(), first.back());
  std::vector<CloudBuilder::Cursor> cursors;
  for (std::size_t i = 0; i < tiles.size(); ++i) cursors.push_back(builder.cursor(first[i], first[i + 1]));
  las::parallel_tasks(tiles.size(), progress, "decoding points", [&](std::size_t i) {
    constexpr std::size_t step = 1 << 14;
    std::vector<std::byte> block;
    for (std::size_t at = 0; at < tiles[i].points; at += step) {
      const std::size_t count = std::min<std::size_t>(step, tiles[i].points - at);
      expansion.expand(loaded[i].data() + at * layout.record, count, block);
      builder.decode(cursors[i], block.data(), 0, count, first[i] + at);
    }
    loaded[i] = {};
  });
  ReadResult result;
  const bool are_chosen = choices && choices->of_records;
  builder.finish(cursors, result, are_chosen ? &*choices->of_records : nullptr);
  if (!choices || are_chosen) return result;
  choices->of_records = builder.choices();
  const ReadReport& report = result.report;
  const std::optional<Bounds>& said = choices->bounds;
  if (said && glm::all(glm::lessThanEqual(said->min, report.bounds_min)) &&
      glm::all(glm::lessThanEqual(report.bounds_max, said->max)))
    choices->of_records->origin = choose_origin(
        said->min, said->max,
        !is_wide(expansion.columns()[std::size_t(column_of(expansion.columns(), Role::x))].stored));
  return result;
}

ReadResult read_las_tiles(const std::vector<std::filesystem::path>& files, Progress& progress,
                          TileChoices* choices) {
  std::vector<std::unique_ptr<las::RecordFile>> opened(files.size());
  las::parallel_tasks(files.size(), progress, "opening tiles",
                      [&](std::size_t i) { opened[i] = std::make_unique<las::RecordFile>(files[i]); });
  const auto begin =
      std::find_if(opened.begin(), opened.end(), [](const auto& tile) { return tile->header().count > 0; });
  if (begin == opened.end()) return {};
  las::Header header = (*begin)->header();
  std::vector<std::size_t> first{0};
  for (std::size_t i = 0; i < opened.size(); ++i) {
    const las::Header& other = opened[i]->header();
    if (other.format != header.format || other.record_length != header.record_length ||
        other.scale != header.scale || other.offset != header.offset)
      bad_input(files[i], "header",
                "the tile's point format or scale is not that of the first; export it again");
    // More than any points compress.
    if (other.count * other.record_length > most_tile_bytes ||
        other.count * other.record_length > (1 << 20) + 1000 * File(files[i]).size())
      bad_input(files[i], "header",
                "found " + std::to_string(other.count) + " points, more than a tile holds; it is damaged");
    first.push_back(first.back() + std::size_t(other.count));
  }
  header.count = first.back();
  std::vector<std::uint8_t> record(header.record_length);
  (*begin)->read(0, [&](std::uint64_t at, const std::uint8_t* records, std::size_t) {
    if (at == 0) std::copy_n(records, record.size(), record.begin());
  });
  const bool are_chosen = choices && choices->of_las;
  auto points =
      are_chosen ? las::PointCollector(header, *choices->of_las) : las::PointCollector(header, record);
  points.resize(first.back());
  std::vector<las::PointCollector::Stats> stats(opened.size(), points.empty_stats());
  las::parallel_tasks(opened.size(), progress, "decoding points", [&](std::size_t i) {
    for (std::size_t part = 0; part < opened[i]->parts().size(); ++part)
      opened[i]->read(part, [&](std::uint64_t at, const std::uint8_t* records, std::size_t count) {
        progress.check();
        points.unpack(first[i] + at, records, count, stats[i]);
      });
  });
  ReadResult result = points.finish(stats, progress);
  if (choices && !are_chosen)
    choices->of_las = {record, las::origin_of(header, result, choices->bounds),
                       result.cloud.colors.empty() ? 16 : result.cloud.las->color_bits};
  return result;
}

std::vector<std::byte> unpack_zstd(const std::filesystem::path& file, std::span<const std::byte> packed,
                                   std::size_t size) {
  static const auto decompress =
      reinterpret_cast<std::size_t (*)(void*, std::size_t, const void*, std::size_t)>(
          function_of(file, "libzstd.so.1", "libzstd1", "ZSTD_decompress"));
  std::vector<std::byte> bytes(size);
  if (decompress(bytes.data(), size, packed.data(), packed.size()) != size)
    bad_input(file, "byte 0", "the zstandard stream is damaged or not of " + std::to_string(size) + " bytes");
  return bytes;
}

std::vector<std::byte> unpack_brotli(const std::filesystem::path& file, std::span<const std::byte> packed,
                                     std::size_t size) {
  static const auto decompress = reinterpret_cast<int (*)(std::size_t, const void*, std::size_t*, void*)>(
      function_of(file, "libbrotlidec.so.1", "libbrotli1", "BrotliDecoderDecompress"));
  std::vector<std::byte> bytes(size);
  std::size_t count = size;
  if (decompress(packed.size(), packed.data(), &count, bytes.data()) != 1 || count != size)
    bad_input(file, "byte 0", "the brotli stream is damaged or not of " + std::to_string(size) + " bytes");
  return bytes;
}

}  // namespace sfumato::io
