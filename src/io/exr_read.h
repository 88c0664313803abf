// One channel of an OpenEXR picture, for depth images.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sfumato::io {

struct ExrDepth {
  std::uint32_t width = 0, height = 0;
  std::vector<float> values;  ///< row after row
};

/// The channel Z, else depth, Y, or the only one there is, as floats. Throws Error(bad_input).
ExrDepth read_exr_depth(const std::filesystem::path& file);

}  // namespace sfumato::io
