// Pictures as PNG.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"

namespace sfumato::io {

/// Key and value pairs kept in the picture, readable by any image viewer ("Software", "Command", ...).
using PngTexts = std::vector<std::pair<std::string, std::string>>;

/// 8-bit sRGB. With `alpha` the picture is RGBA with straight alpha, else RGB. The file appears under its
/// name only when it is complete; throws Error(io).
void write_png(const std::filesystem::path& file, const Image<Rgba8>& image, bool alpha,
               const PngTexts& texts = {});

/// 16-bit grey, linear numbers.
void write_png(const std::filesystem::path& file, const Image<std::uint16_t>& gray,
               const PngTexts& texts = {});

}  // namespace sfumato::io
