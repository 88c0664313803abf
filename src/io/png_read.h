// Reading PNG pictures as they are stored, for depth and colour of RGB-D frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace sfumato::io {

struct PngPicture {
  std::uint32_t width = 0, height = 0;
  int channels = 0, bits = 8;          ///< 1 to 4; 8 or 16
  std::vector<std::uint16_t> samples;  ///< row after row
};

/// Throws Error(bad_input) for what is no PNG, is damaged, or unpacks to more than its bytes can hold.
PngPicture read_png(const std::filesystem::path& file);

}  // namespace sfumato::io
