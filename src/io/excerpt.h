// A few of the points of a large file, from everywhere in it, without reading all of it: what a window shows
// first.
#pragma once

#include <filesystem>
#include <optional>

#include "io/io.h"
#include "io/laz_chunk.h"

namespace sfumato::io {

// Each makes a small file of the same format in memory, or picks parts of a compressed one, and gives it to
// the reader of the format. `points`: about so many, in runs of neighbours. Nothing where the format or this
// file cannot be cut, and where the file is not at least four times as large. They throw what readers throw.
std::optional<ReadResult> excerpt_las(const std::filesystem::path& file, std::size_t points,
                                      const ReadOptions& options, Progress& progress);
/// The first points of these chunks, or of some where they are many: `points` or fewer.
ReadResult excerpt_chunks(const std::filesystem::path& file, const std::vector<las::LazChunk>& chunks,
                          std::size_t points, Progress& progress);
std::optional<ReadResult> excerpt_ply(const std::filesystem::path& file, std::size_t points,
                                      const ReadOptions& options, Progress& progress);
std::optional<ReadResult> excerpt_pcd(const std::filesystem::path& file, std::size_t points,
                                      const ReadOptions& options, Progress& progress);
std::optional<ReadResult> excerpt_obj(const std::filesystem::path& file, std::size_t points,
                                      const ReadOptions& options, Progress& progress);
std::optional<ReadResult> excerpt_text(const std::filesystem::path& file, std::size_t points,
                                       const ReadOptions& options, Progress& progress);

}  // namespace sfumato::io
