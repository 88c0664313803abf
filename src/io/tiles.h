// Scans that lie as an octree of tiles beside a file that describes them: EPT, Potree 2.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/columns.h"

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
  std::uint64_t byte = 0, size = 0;  ///< where several lie in one file
};

/// No more than a tile of any builder holds.
inline constexpr std::uint64_t most_tile_bytes = 1 << 28;

/// The tiles of whole levels from the root down, until they have `options.max_points`; all without. Throws
/// Error(out_of_memory) where those do not fit at `bytes` a point.
std::vector<Tile> tiles_wanted(const std::filesystem::path& file, std::vector<Tile> tiles, std::size_t bytes,
                               const ReadOptions& options);

/// `load` gives the records of a tile; from several threads.
ReadResult read_tiles(const std::filesystem::path& file, const TileLayout& layout,
                      const std::vector<Tile>& tiles,
                      const std::function<std::vector<std::byte>(const Tile&)>& load, Progress& progress);

/// Tiles that are LAS or LAZ files, of one layout.
ReadResult read_las_tiles(const std::vector<std::filesystem::path>& files, Progress& progress);

/// Throw Error(bad_input) where the bytes are damaged, are not `size` unpacked, or the library is absent.
std::vector<std::byte> unpack_zstd(const std::filesystem::path& file, std::span<const std::byte> packed,
                                   std::size_t size);
std::vector<std::byte> unpack_brotli(const std::filesystem::path& file, std::span<const std::byte> packed,
                                     std::size_t size);

}  // namespace sfumato::io
