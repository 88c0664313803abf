// Scans that lie as an octree of tiles beside a file that describes them: EPT, Potree 2.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/columns.h"
#include "io/las_points.h"

namespace sfumato::io {

/// A file beside `file`, on disk or at its server.
std::filesystem::path beside(const std::filesystem::path& file, const std::string& name);

struct TileField {
  std::string name;
  StoredType type = StoredType::float32;
  std::size_t offset = 0;  ///< bytes from the start of the record
  double scale = 1, shift = 0;
  bool is_scaled() const { return scale != 1 || shift != 0; }
};

struct TileLayout {
  std::vector<TileField> fields;
  std::size_t record = 0;  ///< bytes
};

struct Tile {
  int level = 0;
  std::uint64_t points = 0;
  std::string name;
  std::uint64_t byte = 0, size = 0;     ///< where several lie in one file
  std::array<std::uint32_t, 3> cell{};  ///< of the 2^level along each axis
};

/// What is chosen for all tiles by some of them.
struct TileChoices {
  std::optional<Bounds> bounds;  ///< what the description says of all points
  std::optional<CloudBuilder::Choices> of_records;
  std::optional<las::WholeFile> of_las;
};

/// A scan known from its description and hierarchy, before any point is read.
struct TiledScan {
  const char* format = "";
  std::vector<Tile> tiles;  ///< those with points
  dvec3 cube_min{0};
  double cube_size = 0, spacing = 0;  ///< between the points of the root; each level halves it
  Bounds bounds;                      ///< what the description says of the points, else the cube
  std::string crs;
  std::vector<std::string> attributes;
  std::size_t record = 0;  ///< bytes of a point
  /// Choices that are null: by these tiles; that are empty: by these, and left there; else those.
  std::function<ReadResult(const std::vector<Tile>&, Progress&, TileChoices*)> read;
};
bool is_tiled(std::string_view head);
/// Reads description and hierarchy. Throws Error(bad_input) when they are damaged.
TiledScan open_tiled(const std::filesystem::path& file, Progress& progress);
TiledScan open_ept(const std::filesystem::path& file, Progress& progress);
TiledScan open_potree(const std::filesystem::path& file, Progress& progress);
/// All of a scan, or its whole levels that `options.max_points` ask for.
ReadResult read_tiled(const std::filesystem::path& file, const TiledScan& scan, const ReadOptions& options,
                      Progress& progress);

/// By the coarse levels, which are a sample of all.
TileChoices choices_of(const std::filesystem::path& file, const TiledScan& scan, Progress& progress);

/// No more than a tile of any builder holds.
inline constexpr std::uint64_t most_tile_bytes = 1 << 28;

/// What the columns of such records are called, without coordinates.
std::vector<std::string> names_of(const TileLayout& layout);

/// `load` gives the records of a tile; from several threads.
ReadResult read_tiles(const std::filesystem::path& file, const TileLayout& layout,
                      const std::vector<Tile>& tiles,
                      const std::function<std::vector<std::byte>(const Tile&)>& load, Progress& progress,
                      TileChoices* choices);

/// Tiles that are LAS or LAZ files, of one layout.
ReadResult read_las_tiles(const std::vector<std::filesystem::path>& files, Progress& progress,
                          TileChoices* choices);

/// Throw Error(bad_input) where the bytes are damaged, are not `size` unpacked, or the library is absent.
std::vector<std::byte> unpack_zstd(const std::filesystem::path& file, std::span<const std::byte> packed,
                                   std::size_t size);
std::vector<std::byte> unpack_brotli(const std::filesystem::path& file, std::span<const std::byte> packed,
                                     std::size_t size);

}  // namespace sfumato::io
