// Pictures by their extension, and the lossy ones.
#pragma once

#include <filesystem>
#include <string>

#include "core/image.h"
#include "io/image_png.h"

namespace sfumato::io {

/// JPEG and WebP, sRGB, `quality` 1 to 100; WebP at 100 keeps every pixel. WebP keeps straight alpha with
/// `alpha`, JPEG has none. The file appears under its name only when it is complete; throws Error(io),
/// Error(usage) when the format cannot hold a picture of this size. `dpi`: pixels an inch on paper, 0: none
/// is said.
void write_jpeg(const std::filesystem::path& file, const Image<Rgba8>& image, int quality, double dpi = 0);
/// What `write_jpeg` would write.
std::string jpeg_bytes(const Image<Rgba8>& image, int quality);
void write_webp(const std::filesystem::path& file, const Image<Rgba8>& image, bool alpha, int quality);

/// Depth as 16-bit grey: 0 where nothing is, else 1 at the nearest depth to 65535 at the farthest. Both ends
/// are the texts DepthNear and DepthFar, in scene units.
void write_depth_png(const std::filesystem::path& file, const Image<float>& depth, PngTexts texts = {});

/// The same with steps of `step` scene units, which the text DepthUnit says as `unit`: 0 where nothing is, 1
/// for all that is nearer than one and a half steps, 65535 for all beyond. Returns the pixels that are
/// beyond.
std::size_t write_depth_png(const std::filesystem::path& file, const Image<float>& depth, double step,
                            const std::string& unit, PngTexts texts = {});

}  // namespace sfumato::io
