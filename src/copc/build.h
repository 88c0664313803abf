// COPC files of clouds that need not fit in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/point_cloud.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::copc {

struct BuildOptions {
  std::uint64_t memory = 4'000'000'000;     ///< bytes that the build may take; `least_memory` or more
  std::optional<std::uint64_t> max_points;  ///< an even subset of what is read, the same one every time
  std::optional<Bounds> box;                ///< world; only the points in it
  Attributes attributes;        ///< normal, uncertainty: computed of all points, stored as extra bytes
  bool average_colors = false;  ///< points of coarse levels get the mean colour of those they stand for
};

struct BuildReport {
  std::uint64_t points_read = 0, points = 0, bytes = 0;
  std::size_t nodes = 0;
  int levels = 0;
  double spacing = 0;              ///< of the root node, scene units; each level halves it
  std::vector<std::string> notes;  ///< what the user should know, one line each
};

inline constexpr std::uint64_t least_memory = 256'000'000;

/// Writes COPC 1.0 (LAZ 1.4, point format 6, 7 or 8) of all points of `files`, every attribute and the
/// coordinate system kept, in the scaling of the files where they agree. The same points give the same bytes.
/// `output` appears when it is complete; temporaries lie beside it, without names, and need about the size of
/// the points as LAS. Throws Error(bad_input) for damaged files and when no point is left,
/// Error(out_of_memory) for a file that can only be read whole and is too large, Error(io) when the disk is
/// full.
BuildReport build(const std::vector<std::filesystem::path>& files, const std::filesystem::path& output,
                  const BuildOptions& options = {}, Progress& progress = no_progress());

}  // namespace sfumato::copc
