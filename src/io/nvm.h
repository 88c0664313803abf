// Models of VisualSFM.
#pragma once

#include "io/io.h"

namespace sfumato::io {

bool is_nvm(std::string_view head);
/// The points of the first model: coordinates, colours, `track_length`.
ReadResult read_nvm(const std::filesystem::path& path, const ReadOptions& options, Progress& progress);

}  // namespace sfumato::io
