// Whether a file itself names the axis that is up.
#pragma once

#include <filesystem>

namespace sfumato::io {

/// True for a PLY file with a line "comment up +Z" in its header, as sfumato writes it. Other formats have a
/// custom.
bool says_up(const std::filesystem::path& file);

}  // namespace sfumato::io
