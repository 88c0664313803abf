// LAS 1.0 to 1.4 (point formats 0 to 10), LAZ and COPC: the rows of the table of formats.
//
// Kept: every dimension but wave packets. `scan_angle`, the flags, `scanner_channel`, `user_data` and
// `point_source_id` are scalars of the cloud only when some point has one. What a float or an 8-bit colour
// channel cannot hold goes into the scalars NAME_residual and rgb_low_bytes, which the writers add again: LAS
// -> LAS and LAS -> LAZ are exact, coordinates as long as an axis is at most 15 million steps long. Organised
// grids and scanner positions have no place in LAS. Normals and radii are written as the extra bytes nx, ny,
// nz, radius.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/chunk_cache.h"
#include "io/io.h"
#include "io/las_points.h"
#include "io/laz_chunk.h"

namespace sfumato::io {

/// Bytes that a cloud may take: three quarters of the machine's memory, or SFUMATO_MEMORY.
std::uint64_t memory_limit();

bool is_las(std::string_view head);
bool is_laz(std::string_view head);
bool is_copc(std::string_view head);

/// Reads any of the three, decoding on all cores (SFUMATO_THREADS sets the number of threads).
/// Throws Error(bad_input) with byte, found, expected, what to do.
ReadResult read_las(const std::filesystem::path& file, const ReadOptions& options, Progress& progress);

/// The part `options.part` of the records of a LAS file, or of the chunks or nodes of a compressed one.
/// Nothing where the file is too small, or cannot be cut without decoding it.
std::optional<ReadResult> read_part_of_las(const std::filesystem::path& file, const ReadOptions& options,
                                           Progress& progress);

/// Where the records of a file's chunks are looked for before they are decoded, and kept behind it.
struct KeptChunks {
  ChunkCache* cache = nullptr;  ///< null: nowhere
  std::uint64_t file = 0;       ///< the number of this file in it
};

/// Reads only these chunks of a compressed file, in their order. Those that are damaged are left out: see the
/// report. `whole`: where others read other chunks of the file, and clouds have to agree.
ReadResult read_las_chunks(const std::filesystem::path& file, const std::vector<las::LazChunk>& chunks,
                           Progress& progress, const KeptChunks& kept = {},
                           const las::WholeFile* whole = nullptr);

/// Writes LAS 1.4 in the cloud's own point format and scaling where it has one (`PointCloud::las`) and the
/// values fit, else the least format that holds them and steps of about a float's precision.
WriteReport write_las(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);
/// The same, compressed by LASzip.
WriteReport write_laz(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress);

}  // namespace sfumato::io
