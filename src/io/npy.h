// Arrays as NPY version 1.0, the format of numpy.save.
#pragma once

#include <filesystem>

#include "core/image.h"

namespace sfumato::io {

/// Little-endian, C order, shape (height, width) or (height, width, channels). The file appears under its
/// name only when it is complete; throws Error(io).
void write_npy(const std::filesystem::path& file, const Image<float>& image);
void write_npy(const std::filesystem::path& file, const Image<vec3>& image);
void write_npy(const std::filesystem::path& file, const Image<vec4>& image);
void write_npy(const std::filesystem::path& file, const Image<std::uint8_t>& image);

}  // namespace sfumato::io
